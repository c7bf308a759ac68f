# SPDX-License-Identifier: GPL-2.0-only
"""Which objects may touch in the coming frame: reserved boxes, pairs of them that meet, islands, and still objects that these
need.

Pure functions of arrays that every executor has: only + - * / and comparisons of IEEE numbers, integers, and stable sorts, so
that all of them find the same. Wcislo 1999, eq. (3.14), (3.15), (6.17).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

LARGE = 4.0
"""Edges above this many times the median are not sorted into the same grid."""
BLOCK = 1 << 20
"""Pairs looked at in one go."""
CELLS = 1 << 20
"""Most cells of a grid along an axis: three such numbers fit in 63 bits."""
ROUNDING = 1.0 + 2.0**-20
"""Cells are wider than the widest box by this, and numbers of cells below `CELLS`, so that no rounding hides a neighbour."""


def boxes(low: np.ndarray, high: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Reserved boxes, eq. (6.17): boxes of particles (M, 3) [m], widened by d (M,) [m] on every side."""
    return low - d[:, None], high + d[:, None]


# --- pairs --------------------------------------------------------------------------------------------------


def pairs(low: np.ndarray, high: np.ndarray, gap: float) -> np.ndarray:
    """All pairs a < b of boxes that meet, eq. (3.15), when each is grown by half of ``gap`` [m]; sorted, int64, shape (P, 2).

    Boxes are ``low``, ``high`` (M, 3) [m]. O(M log M + pairs that are near). Raises ValueError where a number is not finite, a
    box is turned inside out or the gap is negative.

    Boxes of similar size are sorted into a grid by their lower corners, cells as wide as the widest and the gap: what meets a
    box lies in the 27 cells around it. Larger ones come in rounds of their own, against themselves and all smaller ones; a round
    takes half of those that are left at least. Sorts need not be stable: what is found is sorted.
    """
    if not (np.isfinite(low).all() and np.isfinite(high).all() and np.isfinite(gap)):
        raise ValueError("a box is not finite")
    if (low > high).any() or gap < 0.0:
        raise ValueError("a box is turned inside out, or the gap is negative")
    count = len(low)
    low, high = np.ascontiguousarray(low.T), np.ascontiguousarray(high.T)
    edge = (high - low).max(axis=0)
    order = np.argsort(edge)
    edge = edge[order]
    found = [np.empty((2, 0), np.int64)]
    first = 0
    while first < count:
        last = int(np.searchsorted(edge, LARGE * edge[(first + count) // 2] + gap, side="right"))
        key, rows = _cells(low[:, order[:last]], (edge[last - 1] + gap) * ROUNDING)
        sort = first + np.argsort(key[first:])
        mine, mine_key = order[sort], key[sort]
        found += _look(low, high, gap, mine, mine, _rows_ahead(mine_key, rows))
        if first:
            sort = np.argsort(key[:first])
            found += _look(low, high, gap, mine, order[sort], _rows_around(mine_key, key[sort], rows))
        first = last
    a, b = np.concatenate(found, axis=1)
    code = np.minimum(a, b) * count + np.maximum(a, b)
    code.sort()
    return np.column_stack(np.divmod(code, count))


def _cells(corner: np.ndarray, cell: float) -> tuple[np.ndarray, tuple[int, int]]:
    """Number of the cell of every corner (3, N), shape (N,), and how far apart those of neighbours along x and y are;
    along z, one."""
    corner = corner - corner.min(axis=1)[:, None]
    cell = max(cell, float(corner.max()) / CELLS) or 1.0
    place = (corner / cell).astype(np.int64) + 1  # a margin of one cell: no row runs on into the next
    _, y, z = (place.max(axis=1) + 2).tolist()
    return (place[0] * y + place[1]) * z + place[2], (y * z, z)


def _rows_ahead(key: np.ndarray, rows: tuple[int, int]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Slots [first, last) for each of the sorted keys: those after it in its row of cells, and half of the rows around."""
    x, y = rows
    yield np.arange(1, len(key) + 1), np.searchsorted(key, key + 1, side="right")
    for row in (y, x - y, x, x + y):
        yield np.searchsorted(key, key + (row - 1)), np.searchsorted(key, key + (row + 1), side="right")


def _rows_around(key: np.ndarray, others: np.ndarray, rows: tuple[int, int]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Slots [first, last) among the sorted keys of others, for each key: all nine rows of cells around."""
    x, y = rows
    for row in (-x - y, -x, -x + y, -y, 0, y, x - y, x, x + y):
        yield np.searchsorted(others, key + (row - 1)), np.searchsorted(others, key + (row + 1), side="right")


def _look(low, high, gap, mine, others, rows) -> Iterator[np.ndarray]:
    """Boxes of ``others`` in the given slots that meet mine, in blocks of shape (2, P)."""
    low_a, high_a, low_b, high_b = (side[:, rows] for rows in (mine, others) for side in (low, high))
    first, last = map(np.concatenate, zip(*rows))
    size = last - first
    upto = np.cumsum(size)
    before = upto - size
    start = 0
    while start < len(first):
        stop = max(start + 1, int(np.searchsorted(upto, before[start] + BLOCK, side="right")))
        here = slice(start, stop)
        a = np.repeat(np.arange(start, stop) % len(mine), size[here])
        b = np.arange(len(a)) + np.repeat(first[here] - before[here] + before[start], size[here])
        a, b = _meeting((low_a, high_a), (low_b, high_b), a, b, gap)
        yield np.stack([mine[a], others[b]])
        start = stop


def _meeting(one, two, a, b, gap) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of box a of one set and box b of another, (low, high) each of shape (3, M), that meet."""
    for axis in range(3):
        (low_a, high_a), (low_b, high_b) = ((side[axis] for side in boxes) for boxes in (one, two))
        meet = (low_a[a] - high_b[b] <= gap) & (low_b[b] - high_a[a] <= gap)
        a, b = a[meet], b[meet]
    return a, b


# --- islands ------------------------------------------------------------------------------------------------


def components(count: int, pairs: np.ndarray, still: np.ndarray) -> np.ndarray:
    """Island of every object, int64, shape (M,): numbered from 0 in the order of their smallest objects; -1 for what is still.

    Objects that meet are in one island. ``still`` (M,) are held as a whole, never move and so connect no others. Every round
    joins each tree to the lowest one that it meets, until none meet: O(M + P) a round, a handful of rounds.
    """
    root = np.arange(count)
    a, b = pairs[~(still[pairs[:, 0]] | still[pairs[:, 1]])].T
    while len(a):
        np.minimum.at(root, np.maximum(a, b), np.minimum(a, b))
        while ((up := root[root]) != root).any():
            root = up
        a, b = root[a], root[b]
        apart = a != b
        a, b = a[apart], b[apart]
    number = np.cumsum((root == np.arange(count)) & ~still) - 1
    return np.where(still, -1, number[root])


def guests(pairs: np.ndarray, label: np.ndarray, still: np.ndarray) -> np.ndarray:
    """Copies of still objects that islands need: (island, object) once each, sorted, int64, shape (G, 2)."""
    if not len(pairs) or not still.any():
        return np.zeros((0, 2), np.int64)
    a, b = pairs.T
    code = np.concatenate([label[x[still[y] & ~still[x]]] * len(label) + y[still[y] & ~still[x]] for x, y in ((a, b), (b, a))])
    return np.column_stack(np.divmod(np.unique(code), len(label)))
