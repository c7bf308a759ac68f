# SPDX-License-Identifier: GPL-2.0-only
"""Pairs of boxes that overlap, all boxes above or below others, and the two that are nearest to each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

BLOCK = 1 << 20
"""Pairs that are compared at once."""
TOGETHER = 64
"""Boxes of which those above and below are looked up at once."""


def box_pairs(low: np.ndarray, high: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs of boxes that overlap, in blocks of two arrays of numbers; ``low`` and ``high`` [m] have the shape (M, 3).

    Sort and sweep along the axis on which the fewest overlap.
    """
    n = len(low)
    sorted_by = [np.argsort(low[:, axis], kind="stable") for axis in range(3)]
    stops = [np.searchsorted(low[o, a], high[o, a], side="right") for a, o in enumerate(sorted_by)]
    axis = min(range(3), key=lambda a: int(stops[a].sum()))
    order, stop = sorted_by[axis], stops[axis]
    count = np.maximum(stop - np.arange(n) - 1, 0)
    before = np.concatenate([[0], np.cumsum(count)])
    first = 0
    while first < n:
        last = max(first + 1, int(np.searchsorted(before, before[first] + BLOCK, side="right")) - 1)
        here = np.arange(first, last)
        a = np.repeat(here, count[here])
        b = a + 1 + np.arange(len(a)) - np.repeat(before[here] - before[first], count[here])
        i, j = order[a], order[b]
        meet = (low[i] <= high[j]).all(axis=1) & (low[j] <= high[i]).all(axis=1)
        if meet.any():
            yield i[meet], j[meet]
        first = last


def overlaps_in_plan(low: np.ndarray, high: np.ndarray, asked: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Each asked box, in no order, with the numbers of all that overlap it seen along z, ascending, itself included; corners [m]
    have the shape (M, 3), ``asked`` are numbers of boxes, shape (K,). Boxes that share no more than an edge do not overlap."""
    order = asked[np.argsort(low[asked, 0], kind="stable")]
    for start in range(0, len(order), TOGETHER):
        some = order[start : start + TOGETHER]
        least, most = low[some, :2].min(axis=0), high[some, :2].max(axis=0)
        near = np.flatnonzero(((low[:, :2] < most) & (high[:, :2] > least)).all(axis=1))
        meet = np.ones((len(some), len(near)), bool)
        for axis in (0, 1):
            meet &= low[near, axis] < high[some, axis, None]
            meet &= high[near, axis] > low[some, axis, None]
        for m, row in zip(some.tolist(), meet):
            yield m, near[row]


def nearest_boxes(
    low: np.ndarray, high: np.ndarray, counts: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> tuple[float, int, int] | None:
    """Squared distance of the nearest two boxes [m^2], and their numbers, the lowest ones of several; corners [m] have the shape
    (M, 3). None where no pair counts: ``counts`` is asked of arrays of numbers i and j, in both orders."""
    reach, extent = 0.0, float(np.linalg.norm(high.max(axis=0) - low.min(axis=0)))
    while True:
        best: tuple[float, int, int] | None = None
        for both in box_pairs(low - reach, high):
            i, j = np.concatenate(both), np.concatenate(both[::-1])
            right = counts(i, j)
            i, j = i[right], j[right]
            if len(i):
                apart = (np.maximum(np.maximum(low[j] - high[i], low[i] - high[j]), 0.0) ** 2).sum(axis=1)
                k = np.lexsort((j, i, apart))[0]
                found = float(apart[k]), int(i[k]), int(j[k])
                best = found if best is None else min(best, found)
        if reach >= extent or (best is not None and best[0] <= reach**2):
            return best
        reach = max(2.0 * reach, 0.1 * float((high - low).mean())) if best is None else np.sqrt(best[0]) * (1.0 + 1e-12)
