# SPDX-License-Identifier: GPL-2.0-only
"""Vibrations of lattices that their masses set, and masses by a linear program: ``python bench/lattice_modes.py [TABLE ...]``.

Figures of docs/physics-solids.md, Masses. Masses are those of `model/masses.py`, or by shares (w = 1).

bars    first torsional frequency of a free square bar, five times as long as thick, over sqrt(G J / rho I)/2L
balls   lowest frequency of a free ball over that of an elastic ball, a torsion of its halves
program the largest w where a linear program makes the least w as large as it can be
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from timing import print_tables

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "lab"))

from mdanim_lammps.model import shapes  # noqa: E402
from mdanim_lammps.scene.scene import Box, Sphere  # noqa: E402
from model_samples import model, shape_id  # noqa: E402
from twin import lattice as twin  # noqa: E402

SHEAR = 0.4
"""G/E of nu = 1/4."""
TORSION = 0.1406
"""J/a^4 of a square bar (Timoshenko, Goodier, 109)."""
BALL = 2.501
"""omega R/c_s of the lowest torsion of a free ball (Love, 194); the lowest of its other vibrations has 2.64."""
SLENDER = 5
RIGID = 6
"""Motions of a free body without a vibration."""


def masses(body) -> dict[str, np.ndarray]:
    """Masses of the particles of a model [kg], shape (N,)."""
    return {"fitted": body.mass, "w = 1": body.share / body.share.sum() * body.mass.sum()}


def modes(body, mass: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The lowest frequencies [rad/s], shape (count,), and motions, shape (N, 3, count), of a free body."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import eigsh

    root = np.sqrt(np.repeat(mass, 3))
    stiff = diags(1.0 / root) @ twin.stiffness_matrix(body.position, body.spring, body.stiffness) @ diags(1.0 / root)
    largest = abs(stiff).sum(axis=1).max()
    start = np.random.default_rng(1).standard_normal(len(root))
    w2, vector = eigsh(stiff.tocsc(), k=count, sigma=-1e-6 * largest, v0=start)
    order = np.argsort(w2)
    return np.sqrt(np.maximum(w2[order], 0.0)), (vector[:, order] / root[:, None]).reshape(len(mass), 3, count)


def bars() -> tuple[list[str], list[list]]:
    """First torsional frequency of a free bar over theory."""
    rows = []
    for cells in (2, 3, 4, 6, 8):
        side, length = float(cells), float(SLENDER * cells)
        body = model(Box((length, side, side)), 1.0, mass=length * side**2)
        x, y, z = (body.position - body.position.mean(axis=0)).T
        twist = np.stack([0.0 * x, -z, y], axis=1) * np.sin(math.pi * x / length)[:, None]
        theory = math.pi / length * math.sqrt(SHEAR * TORSION * side**4 / (side**4 / 6.0))
        row = [cells]
        for mass in masses(body).values():
            w, motion = modes(body, mass, RIGID + 8)
            weighed = mass[:, None, None] * motion
            part = abs((twist[:, :, None] * weighed).sum((0, 1))) / np.sqrt((motion * weighed).sum((0, 1)))
            row.append(f"{w[RIGID + part[RIGID:].argmax()] / theory:.3f}")
        rows.append(row)
    return ["cells thick", "fitted", "w = 1"], rows


def balls() -> tuple[list[str], list[list]]:
    """Lowest frequency of a free ball over theory."""
    rows = []
    for cells in (3, 4, 6, 8):
        radius = cells / 2.0
        body = model(Sphere(radius), 1.0, mass=4.0 / 3.0 * math.pi * radius**3)
        theory = BALL / radius * math.sqrt(SHEAR)
        rows.append([cells, *(f"{modes(body, mass, RIGID + 1)[0][RIGID] / theory:.3f}" for mass in masses(body).values())])
    return ["cells across", "fitted", "w = 1"], rows


def program() -> tuple[list[str], list[list]]:
    """Largest and least w by a linear program, and by the fit."""
    from scipy.optimize import linprog

    rows = []
    for shape in (Box((4.0, 4.0, 4.0)), Sphere(2.0), Sphere(3.0)):
        body = model(shape, 1.0)
        share = body.share / body.share.sum()
        x, y, z = (body.position - share @ body.position).T
        basis = np.array([np.ones_like(x), x, y, z, x * x, y * y, z * z, y * z, x * z, x * y]) * share
        true = shapes.second_moments(shape)
        asked = [1.0, 0.0, 0.0, 0.0, *true[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]]
        # The unknowns are all w and the least of them.
        least = np.hstack([-np.eye(len(x)), np.ones((len(x), 1))])
        found = linprog(
            np.append(np.zeros(len(x)), -1.0), least, np.zeros(len(x)), np.hstack([basis, np.zeros((10, 1))]), asked, (0.0, None)
        )
        by_program, fitted = found.x[:-1], body.mass / body.mass.sum() / share
        others = np.sort(by_program)[-2]
        rows.append([f"{shape_id(shape)}, {round(shapes.thickness(shape))} cells", *(f"{v:.2f}" for v in (
            by_program.min(), by_program.max(), others, fitted.min(), fitted.max()))])  # fmt: skip
    return ["shape", "least w", "largest w", "second largest", "fit: least", "largest"], rows


TABLES = {"bars": bars, "balls": balls, "program": program}


if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
