# SPDX-License-Identifier: GPL-2.0-only
"""Large arrays looked at in blocks of rows: memory is bounded, and Ctrl-C is answered between blocks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

BLOCK = 1 << 15
"""Rows that are looked at in one call, 0.1 to 1 s of work."""


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
