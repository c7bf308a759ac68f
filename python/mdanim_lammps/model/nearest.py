# SPDX-License-Identifier: GPL-2.0-only
"""Large arrays looked at in blocks of rows: memory is bounded, and Ctrl-C is answered between blocks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

BLOCK = 1 << 15
"""Rows that are looked at in one call, 0.1 to 1 s of work."""
PARTS = 4
"""Parts of the longest side of a box of places, each with a tree of its own. Inside a cuboid they take 0.27 of the time of one
tree, 8 parts 0.55."""


def blocks(rows: int) -> Iterator[slice]:
    """All of this many rows, in their order."""
    return (slice(start, min(start + BLOCK, rows)) for start in range(0, rows, BLOCK))


class Nearest:
    """The nearest of P places, shape (P, D)."""

    def __init__(self, places: np.ndarray):
        from scipy.spatial import cKDTree  # takes half a second

        self._tree = cKDTree(places)

    def __call__(self, points: np.ndarray, count: int = 1, *, within: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Distances to the nearest ``count`` places and their numbers, each of shape (N,) or (N, count), for points (N, D).

        Beyond ``within`` there is none: an infinite distance and the number P.
        """
        shape = (len(points),) if count == 1 else (len(points), count)
        away, number = np.empty(shape), np.empty(shape, np.int64)
        for rows in blocks(len(points)):
            away[rows], number[rows] = self._tree.query(points[rows], count, distance_upper_bound=within)
        return away, number


def nearest_distances(places: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Distance of points [m], shape (N, 3), to the nearest of places on a surface, shape (P, 3); shape (N,), as `Nearest` has it.

    From a point deep inside, a tree of all places looks at each cell whose projection is near: cells reach from the surface to
    the middle. Parts have tight boxes, and those that are further away than what is found are left out.
    """
    from scipy.spatial import cKDTree

    low, size = places.min(axis=0), np.ptp(places, axis=0).max() / PARTS
    part = np.unique(((places - low) / size).astype(np.int64) @ [1, PARTS + 1, (PARTS + 1) ** 2], return_inverse=True)[1]
    groups = [places[part == k] for k in range(part.max() + 1)]
    trees, away = [cKDTree(group) for group in groups], np.full(len(points), np.inf)
    for rows in blocks(len(points)):
        point, found = points[rows], away[rows]
        box = np.array([_squares_to_box(point, group.min(axis=0), group.max(axis=0)) for group in groups])
        first = box.argmin(axis=0)
        for again in (False, True):
            for k, tree in enumerate(trees):
                here = first == k
                some = np.flatnonzero(~here & ((1.0 - 1e-9) * box[k] < found * found) if again else here)
                if len(some):
                    found[some] = np.minimum(found[some], tree.query(point[some])[0])
    return away


def _squares_to_box(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Square of the distance of points to a box, shape (N,)."""
    out = zip(points.T, low, high)
    return sum(np.maximum(np.maximum(a - x, x - b), 0.0) ** 2 for x, a, b in out)
