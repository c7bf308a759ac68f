# SPDX-License-Identifier: GPL-2.0-only
"""A cube of eight particles and the triangles of its surface, for fixes that push at surfaces."""

import numpy as np
import plugin_lab as lab

FACES = [
    (0, 2, 1),
    (1, 2, 3),
    (4, 5, 6),
    (5, 7, 6),
    (0, 1, 4),
    (1, 5, 4),
    (2, 6, 3),
    (3, 6, 7),
    (0, 4, 2),
    (2, 4, 6),
    (1, 3, 5),
    (3, 7, 5),
]
"""Triangles of a cube whose corners are numbered x fastest, outward."""


def cube(speed: float = 1.0, seed: int = 3):
    """A cube of one cell that is deformed and moves in itself, and its random numbers."""
    random = np.random.default_rng(seed)
    body = lab.block((1, 1, 1))
    return lab.particles(
        body.x + 0.2 * random.standard_normal((8, 3)), molecule=np.ones(8, int), v=speed * random.standard_normal((8, 3)),
        mass=0.1 + random.random(8),
    )  # fmt: skip
