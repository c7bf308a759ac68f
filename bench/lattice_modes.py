# SPDX-License-Identifier: GPL-2.0-only
"""Vibrations of lattices that their masses set, and masses by a linear program: ``python bench/lattice_modes.py [TABLE ...]``.

Figures of docs/physics-solids.md, Masses. Masses are those of `model/masses.py`, or by shares (w = 1).

bars    first torsional frequency of a free square bar, five times as long as thick, over sqrt(G J / rho I)/2L
balls   lowest frequency of a free ball over that of an elastic ball, a torsion of its halves
twist   torsional stiffness of a layer of a long square bar, what makes it right, and what that costs
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


def layer(cells: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Springs of a long square bar in a layer and from it to the next: ends, the lower x first, shape (S, 2, 3), from its axis;
    stiffness, shape (S,); and the polar moment of the masses of the layer over that of a full square."""
    length = float(SLENDER * cells)
    body = model(Box((length, float(cells), float(cells))), 1.0, mass=length * cells**2)
    position = body.position - body.position.mean(axis=0)
    places = np.unique(position[:, 0].round(6))
    here = np.isclose(position[:, 0], places[len(places) // 2])
    ends = position[body.spring.astype(int)]
    ends = np.where((ends[:, 0, 0] > ends[:, 1, 0])[:, None, None], ends[:, ::-1], ends)
    inside = np.isclose(ends[:, 0, 0], places[len(places) // 2])
    polar = (body.mass[here] * (position[here, 1:] ** 2).sum(axis=1)).sum() / body.mass[here].sum() / (cells**2 / 6.0)
    return ends[inside], body.stiffness[inside], polar


def rigidities(ends: np.ndarray, stiffness: np.ndarray, cells: int) -> tuple[float, float, float, float]:
    """E, bending and torsional stiffness over those of a solid bar of this E, and Poisson's ratio of the outer faces.

    Each layer is moved as the one before and turned, pulled or bent on; the periodic motion on top, warping among it, is that
    of least energy: Saint-Venant's problem for springs.
    """
    way = ends[:, 1] - ends[:, 0]
    unit = way / np.linalg.norm(way, axis=1)[:, None]
    sites, index = np.unique(ends[..., 1:].round(6).reshape(-1, 2), axis=0, return_inverse=True)
    index, row = index.reshape(-1, 2), np.arange(len(ends))
    lengthen = np.zeros((len(ends), len(sites), 3))
    lengthen[row, index[:, 1]] += unit
    lengthen[row, index[:, 0]] -= unit
    lengthen = lengthen.reshape(len(ends), -1)
    pull = unit[:, 0] * way[:, 0]
    bend = pull * ends[..., 2].mean(axis=1)
    twist = way[:, 0] * (unit[:, 2] * ends[:, 1, 1] - unit[:, 1] * ends[:, 1, 2])
    energies, moved = [], []
    for load in (pull, bend, twist):
        u = -np.linalg.lstsq((lengthen.T * stiffness) @ lengthen, lengthen.T @ (stiffness * load), rcond=1e-10)[0]
        energies.append(float(stiffness @ (load + lengthen @ u) ** 2))
        moved.append(u.reshape(-1, 3))
    young = energies[0] / cells**2
    face = sites[:, 1] == sites[:, 1].max()
    narrower = -(np.ptp(sites[face, 0]) ** -1) * (moved[0][face, 1][-1] - moved[0][face, 1][0])
    return young, energies[1] / (young * cells**4 / 12.0), energies[2] / (young * SHEAR * TORSION * cells**4), narrower


def outer(ends: np.ndarray, cells: int, edges: float, diagonals: float) -> np.ndarray:
    """Shares of springs, shape (S,), where edges and diagonals in outer faces lose these parts to the next plane inside."""
    way = ends[:, 1] - ends[:, 0]
    lost = np.where((abs(way) > 0.5).sum(axis=1) == 2, diagonals, edges)
    share = np.ones(len(ends))
    for axis in (1, 2):
        deep = np.where(abs(way[:, axis]) < 0.5, 0.5 * cells - abs(ends[:, 0, axis]), np.nan)
        share *= np.where(np.isclose(deep, 0.0), 0.5 * (1.0 - lost), 1.0)
        share *= np.where(np.isclose(deep, 1.0), 1.0 + 0.5 * lost * (1 + (cells == 2)), 1.0)
    return share


def twist() -> tuple[list[str], list[list]]:
    """Torsion of the lattice as it is, and with parts of outer faces that make bending and torsion right together."""
    from scipy.optimize import fsolve

    rows = []
    for cells in (2, 3, 4, 6, 8):
        ends, stiffness, polar = layer(cells)
        _, bends, twists, _ = rigidities(ends, stiffness, cells)

        def off(parts: np.ndarray, ends: np.ndarray = ends, cells: int = cells) -> np.ndarray:
            return np.array(rigidities(ends, outer(ends, cells, *parts), cells)[1:3]) - 1.0

        parts = fsolve(off, (0.1, 0.25))
        _, _, _, poisson = rigidities(ends, outer(ends, cells, *parts), cells)
        rows.append([cells, *(f"{v:.3f}" for v in (bends, twists, polar, math.sqrt(twists / polar), *parts, poisson))])
    return [
        "cells thick",
        "bending",
        "torsion",
        "polar moment",
        "speed of twist",
        "edges",
        "diagonals",
        "nu of outer faces",
    ], rows


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


TABLES = {"bars": bars, "balls": balls, "twist": twist, "program": program}


if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
