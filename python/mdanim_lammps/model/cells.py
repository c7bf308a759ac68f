# SPDX-License-Identifier: GPL-2.0-only
"""Which cells a shape fills: cuboids are divided exactly, other shapes become cubes that fit their volume."""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from math import ceil, inf

import numpy as np

from ..scene.scene import Box, Mesh, Shape
from . import mesh, shapes
from .lattice import Cells
from .springs import MAX_ASPECT

THINNER = 1.25
"""Spacing over the thickness of a cuboid from which its cells are plates."""


class TooThin(Exception):
    """No cells near this size form the shape; the message names the cause."""


def fill_cells(shape: Shape, spacing: float, loose: bool = False) -> Cells:
    """Cells of about this spacing [m] that a shape fills, body frame; an infinite one asks for one cell, the box around it. Those
    of a ``loose`` body, which has no springs, may have any aspect.

    Raises TooThin, mesh.MeshError.
    """
    if spacing == inf:
        return Cells(np.ones((1, 1, 1), bool), *shapes.extent(shape))
    if isinstance(shape, Box):
        return _box_cells(shape, _counts(shape.size, spacing, loose))
    whole, apart = _voxels(shape, spacing, mesh.load(shape) if isinstance(shape, Mesh) else None)
    if whole is None and (apart is None or not loose):
        raise TooThin("its cells are not in one piece")
    return apart if whole is None else whole


def end_share(filled: np.ndarray) -> float:
    """Part of the filled cells, bool, shape (nz, ny, nx), that is in the smallest of the six layers where the body ends [-]."""
    ends = [np.count_nonzero(filled.take(at, axis)) for axis in range(3) for at in (0, -1)]
    return min(ends) / np.count_nonzero(filled)


# --- cuboids ------------------------------------------------------------------------------------------------


def _counts(size, spacing: float, loose: bool) -> tuple[int, int, int]:
    if min(size) < spacing / THINNER:
        return plate_counts(size, spacing)
    try:
        return box_counts(size, spacing)
    except TooThin:
        if not loose:
            raise
        return plate_counts(size, spacing)


def box_counts(size, spacing: float) -> tuple[int, int, int]:
    """Cells along each edge so that they are nearly cubes with edges near the spacing [m].

    The narrowest range around the spacing that has an answer counts: first within 5 %, then further out; more
    than 25 % is needed only by cuboids one or two cells thick with awkward edges. Among the divisions in
    range with an aspect up to MAX_ASPECT the one nearest to cubes wins, then the nearest spacing. Raises
    TooThin.
    """
    size = np.asarray(size, float)
    for reach in (1.05, 1.12, 1.25, 1.4, 1.6, 1.8, 2.0):
        counts = _trial_counts(size, spacing, reach)
        edge = size / counts
        aspect = edge.max(axis=1) / edge.min(axis=1)
        off = abs(np.log(np.prod(edge, axis=1) ** (1 / 3) / spacing))
        fits = (aspect <= MAX_ASPECT * (1 + 1e-9)) & (off <= np.log(reach) + 1e-9)
        if fits.any():
            # Aspects that differ by rounding only are equally cubic.
            best = np.lexsort((off[fits], aspect[fits].round(6)))[0]
            return tuple(counts[fits][best].tolist())
    raise TooThin("its edges cannot be divided into nearly equal cells")


def plate_counts(size, spacing: float) -> tuple[int, int, int]:
    """The same of a cuboid that has no springs: cells of any aspect, at least one along each edge."""
    return tuple(max(1, round(length / spacing)) for length in size)


def _trial_counts(size: np.ndarray, spacing: float, reach: float) -> np.ndarray:
    """Divisions to compare, shape (n, 3): near the spacing, or fitting one side and in reach."""
    near = [
        length / n for length in size for n in range(max(1, ceil(length / (spacing * reach))), int(length * reach / spacing) + 1)
    ]
    cells = size / np.array([spacing, *near])[:, None]
    down, up = np.floor(cells + 1e-9), np.ceil(cells - 1e-9)
    trials = [np.where(choice, up, down) for choice in product((False, True), repeat=3)]
    return np.maximum(1, np.concatenate(trials)).astype(int)


def _box_cells(shape: Box, counts) -> Cells:
    half = np.array(shape.size) / 2
    return Cells(np.ones(counts[::-1], bool), -half, half)


# --- all other shapes ---------------------------------------------------------------------------------------

SEARCH = 4_000_000
"""Cells that are compared in one round of the search: small bodies get all trials, large bodies fit well with few."""

GOOD_VOLUME = 0.05
"""Error of the volume that ends the search; balls two or three cells thick need an edge further off."""


@lru_cache(maxsize=64)
def _voxels(shape: Shape, spacing: float, triangles: mesh.Triangles | None) -> tuple[Cells | None, Cells | None]:
    """Cubic cells whose centre is inside, with the edge and alignment whose volume and extent are nearest to the true ones: those
    in one piece, and those in several that are better; None where there are none.

    Scenes are often prepared again with the same shapes: cells of the last ones are kept, of a mesh as long as its file stays.

    The edge stays within 4 % of the spacing where that gives a good volume, else within 12 %, else 20 %.
    Along each axis either a corner or the centre of a cell falls on the middle of the shape.
    """
    volume, (low, high) = shapes.volume(shape), shapes.extent(shape)
    trials = SEARCH / max(1.0, float(np.prod((high - low) / spacing)))
    alignments = _alignments(high - low) if trials > 2 else [(0, 0, 0)]
    count = int(np.clip(trials / len(alignments), 1, 9))
    best, best_error, best_score = None, np.inf, np.inf
    apart, apart_score = None, np.inf
    for reach in (0.04, 0.12, 0.2):
        for edge, odd in product(spacing * _around_one(reach, count), alignments):
            cells = _filled(shape, low, high, edge, odd)
            if cells is None:
                continue
            error = abs(np.count_nonzero(cells.filled) * edge**3 / volume - 1)
            # Parts that stand out of the shape keep others at a distance, and missing parts let them in. A gain below a
            # thousandth is not worth an edge 5 % off the spacing.
            out = max(abs(cells.low - low).max(), abs(cells.high - high).max()) / edge
            score = error + 0.1 * out + 0.02 * abs(edge / spacing - 1)
            if score < best_score:
                if _in_one_piece(cells.filled):
                    best, best_error, best_score = cells, error, score
                elif score < apart_score:
                    apart, apart_score = cells, score
        if best_error <= GOOD_VOLUME:
            break
    for array in (part for cells in (best, apart) if cells is not None for part in (cells.filled, cells.low, cells.high)):
        array.setflags(write=False)
    return best, apart


def _around_one(reach: float, count: int) -> np.ndarray:
    """An odd number of factors, at most ``count``, evenly from 1 - reach to 1 + reach; 1 is among them."""
    return np.linspace(1 - reach, 1 + reach, count - 1 + count % 2) if count > 1 else np.ones(1)


def _alignments(size: np.ndarray) -> list[tuple[int, int, int]]:
    """Parities of the number of cells along x, y, z to try; axes of equal length get equal ones."""
    equal = [(i, j) for i, j in ((0, 1), (1, 2), (0, 2)) if abs(size[i] - size[j]) <= 1e-9 * size.max()]
    return [odd for odd in product((0, 1), repeat=3) if all(odd[i] == odd[j] for i, j in equal)]


def _filled(shape: Shape, low, high, edge: float, odd) -> Cells | None:
    """The cells of one edge [m] and alignment, cropped to those filled; None where there are none."""
    middle = (low + high) / 2
    counts = [2 * ceil((length / edge - parity) / 2) + parity for length, parity in zip(high - low, odd)]
    counts = np.maximum(counts, 1)
    corner = middle - counts * edge / 2
    x, y, z = (c + edge * (np.arange(n) + 0.5) for c, n in zip(corner, counts))
    filled = _without_nubs(shapes.fill(shape, x, y, z))
    if not filled.any():
        return None
    used = [np.flatnonzero(filled.any(axis=axes)) for axes in ((1, 2), (0, 2), (0, 1))]
    crop = tuple(slice(u[0], u[-1] + 1) for u in used)
    filled = np.ascontiguousarray(filled[crop])
    corner = corner + edge * np.array([u[0] for u in used[::-1]])
    return Cells(filled, corner, corner + edge * np.array(filled.shape[::-1]))


def _without_nubs(filled: np.ndarray) -> np.ndarray:
    """Remove single cells on a flat face: an impact would push such a cell through the face.

    Such a cell has one neighbour, which has four or all five others; the end of a needle is none.
    """
    neighbours = _neighbours(filled)
    nub = filled & (neighbours == 1)
    if not nub.any():
        return filled
    flat = filled & (neighbours >= 5)
    return filled & ~(nub & (_neighbours(flat) == 1))


def _neighbours(filled: np.ndarray) -> np.ndarray:
    """Filled cells across the six faces of every cell, uint8, same shape."""
    ones, total = filled.view(np.uint8), np.zeros(filled.shape, np.uint8)
    for axis in range(3):
        own, beside = np.moveaxis(total, axis, 0), np.moveaxis(ones, axis, 0)
        own[1:] += beside[:-1]
        own[:-1] += beside[1:]
    return total


def _in_one_piece(filled: np.ndarray) -> bool:
    """Whether all filled cells are joined through faces."""
    from scipy import ndimage

    return ndimage.label(filled)[1] == 1
