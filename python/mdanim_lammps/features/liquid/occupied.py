# SPDX-License-Identifier: GPL-2.0-only
"""The room that solids leave in the cells of a basin, by the samples of plugin/liquid/occupancy.cpp."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from ...model.grid import Grid
from ...model.model import Model
from ...scene.scene import Vector
from .record import LiquidModel

SHUT = 31 / 32
"""Solid part of a cell from which waves take it for shut (plugin/liquid/waves/span.h)."""
SAMPLES = (1 / 6, 1 / 2, 5 / 6)
"""Places of samples along each edge of a lattice cell [-]."""


def room(grid: Grid, models: Sequence[Model], liquid: LiquidModel, low: Vector, high: Vector, top: float | None = None) -> float:
    """Cells of liquid that find room beside solids at the start in the cells whose centres lie in a box [m], up to a height [m].

    Waves have all that is not solid of a cell that is not shut, the automaton all of a cell less than half of which is solid.
    """
    part = filled(grid, models, spread=liquid is LiquidModel.WAVES)
    free = np.where(part < SHUT, 1.0 - part, 0.0) if liquid is LiquidModel.WAVES else (part < 0.5).astype(float)
    for axis, n in enumerate(grid.shape):
        centre = grid.low[axis] + (np.arange(n) + 0.5) * grid.cell[axis]
        within = ((centre >= low[axis]) & (centre <= high[axis])).astype(float)
        if axis == 2 and top is not None:
            within *= np.clip((top - grid.low[2]) / grid.cell[2] - np.arange(n), 0.0, 1.0)
        free *= within.reshape([-1 if a == axis else 1 for a in (2, 1, 0)])
    return float(free.sum())


def filled(grid: Grid, models: Sequence[Model], spread: bool) -> np.ndarray:
    """Part of each cell of a basin that solids fill [-], all together, shape (nz, ny, nx).

    27 samples of each lattice cell, each with a 27th of its volume: at a point, or spread over the cells that the box around
    a third of the lattice cell along each edge overlaps.
    """
    part = np.zeros(grid.shape[::-1])
    for model in models:
        corner = (model.position[model.hexahedron] - grid.low) / grid.cell
        corner = corner[((corner.max(axis=1) > -1.0) & (corner.min(axis=1) < np.array(grid.shape) + 1.0)).all(axis=1)]
        edges = [_mean_edge(corner, pairs) for pairs in EDGES]
        volume = np.abs(np.einsum("ni,ni->n", np.cross(edges[0], edges[1]), edges[2]))
        reach = np.minimum(0.5, sum(np.abs(edge) for edge in edges) / 6.0) if spread else np.zeros_like(corner[:, 0])
        for at in product(SAMPLES, repeat=3):
            _put(part, _point(corner, *at), reach, volume / 27.0)
    return part


EDGES = (((0, 1), (3, 2), (4, 5), (7, 6)), ((0, 3), (1, 2), (4, 7), (5, 6)), ((0, 4), (1, 5), (2, 6), (3, 7)))
"""Corners of a lattice cell between which its edges lie, along each of its axes, in VTK order."""


def _mean_edge(corner: np.ndarray, pairs) -> np.ndarray:
    return sum(corner[:, b] - corner[:, a] for a, b in pairs) / 4.0


def _point(corner: np.ndarray, u: float, v: float, w: float) -> np.ndarray:
    """A point of each lattice cell, by parts of its edges, shape (C, 3)."""
    (p0, p1, p2, p3) = (corner[:, k] + w * (corner[:, k + 4] - corner[:, k]) for k in range(4))
    left, right = p0 + v * (p3 - p0), p1 + v * (p2 - p1)
    return left + u * (right - left)


def _put(part: np.ndarray, at: np.ndarray, reach: np.ndarray, volume: np.ndarray) -> None:
    """Add volumes at points, each spread over a box with these half edges, which is a cell at most; all in cells."""
    lower = np.floor(at - reach).astype(int)
    upper_share = np.clip((at + reach - (lower + 1)) / np.maximum(2.0 * reach, 1e-9), 0.0, 1.0)
    shape = np.array(part.shape[::-1])
    for upper in product((0, 1), repeat=3):
        cell = lower + upper
        weight = volume * np.where(upper, upper_share, 1.0 - upper_share).prod(axis=1)
        inside = ((cell >= 0) & (cell < shape)).all(axis=1) & (weight > 0.0)
        np.add.at(part, tuple(cell[inside].T[::-1]), weight[inside])
