# SPDX-License-Identifier: GPL-2.0-only
"""Pairs of boxes that overlap."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

BLOCK = 1 << 20
"""Pairs that are compared at once."""


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
