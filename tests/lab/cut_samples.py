# SPDX-License-Identifier: GPL-2.0-only
"""Particles and springs that are cut into blocks: for engine_lab.py."""

import numpy as np
import plugin_lab as lab


def lattice(cells, damped=False):
    """Springs and K, r0, c of a block of cells, numbered row by row."""
    body = lab.block(cells)
    c = np.full(len(body.k), 0.1) if damped else 0.0 * body.k
    return len(body.x), body.bond, np.stack([0.5 * body.k, body.r0, c], 1)


def several(*bodies):
    """Bodies one after the other, each an object of its own."""
    springs, krc, objects, start = [], [], [], 0
    for n, (particles, bond, coeffs) in enumerate(bodies, 1):
        springs.append(np.asarray(bond) + start)
        krc.append(coeffs)
        objects += [n] * particles
        start += particles
    return start, np.concatenate(springs), np.concatenate(krc), np.array(objects)


CASES = {
    "a cube": several(lattice((11, 11, 11))),
    "a damped cube": several(lattice((11, 11, 11), damped=True)),
    "blocks of which some are damped": several(lattice((9, 9, 9)), lattice((8, 8, 9), damped=True), lattice((9, 9, 9))),
    "many small ones": several(*[lattice((4, 4, 4))] * 20),
}
