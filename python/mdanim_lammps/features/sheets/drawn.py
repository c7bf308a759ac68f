# SPDX-License-Identifier: GPL-2.0-only
"""Both sides of a sheet as they are drawn: smooth through its particles."""

from __future__ import annotations

import numpy as np

from ...model.model import Surface

SMOOTHED = 6000
"""Particles up to which there is a vertex in the middle of each edge, besides those at particles."""
WING = 1.0 / 16.0
"""Weight of the corners around an edge in its middle (Dyn, Levin and Gregory 1990)."""


def both_sides(triangle: np.ndarray, particles: int, creases: np.ndarray | None = None) -> Surface:
    """The surface of a layer of triangles between particles, shape (T, 3): each side has vertices of its own. Edges of
    ``creases``, shape (K, 2), stay sharp."""
    sharp = set() if creases is None else set(map(tuple, np.sort(creases, axis=1).tolist()))
    side, index, weight = _smooth(triangle, particles, sharp) if particles <= SMOOTHED else _plain(triangle, particles)
    count = len(index)
    both = np.concatenate([side, side[:, ::-1] + count]).astype(np.int32)
    return Surface(both, np.tile(index, (2, 1)).astype(np.int32), np.tile(weight, (2, 1)))


def _plain(triangle: np.ndarray, particles: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return triangle, np.arange(particles)[:, None], np.ones((particles, 1))


def _smooth(triangle: np.ndarray, particles: int, sharp: set[tuple[int, int]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each triangle cut into four. The middle of an edge (a, b) between the corners c and d is (a + b)/2 + (c + d)/8, less a
    sixteenth of each of the four corners beyond the triangles' other edges; where there is none beyond, it is that of a
    parallelogram, or a crease between. On a border it is 9 (a + b)/16 less a sixteenth of both neighbours along it."""
    half = triangle[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    opposite = triangle[:, [2, 0, 1]].reshape(-1)
    low, high = half.min(axis=1), half.max(axis=1)
    key, edge = np.unique(low * particles + high, return_inverse=True)
    a, b = np.divmod(key, particles)
    across = np.full((len(key), 2), -1, np.int64)  # corners on both sides of each edge
    forward = half[:, 0] == low
    across[edge[forward], 0], across[edge[~forward], 1] = opposite[forward], opposite[~forward]
    weight = [{int(p): 0.5, int(q): 0.5} for p, q in zip(a, b)]

    def add(row: dict[int, float], corner: int, w: float) -> None:
        row[corner] = row.get(corner, 0.0) + w

    number = dict(zip(key.tolist(), range(len(key))))
    beside: dict[int, list[int]] = {}
    for p, q in zip(*(end[(across < 0).any(axis=1)].tolist() for end in (a, b))):
        beside.setdefault(p, []).append(q)
        beside.setdefault(q, []).append(p)
    for e, row in enumerate(weight):
        p, q = int(a[e]), int(b[e])
        corners = [int(c) for c in across[e] if c >= 0]
        if len(corners) == 2 and (p, q) in sharp:
            continue
        if len(corners) == 1:
            for one, other in ((p, q), (q, p)):
                beyond = [n for n in beside[one] if n != other]
                add(row, one, WING)
                if len(beyond) == 1 and number.get(min(beyond[0], other) * particles + max(beyond[0], other)) is None:
                    add(row, beyond[0], -WING)
                else:  # a corner of the sheet: straight on
                    add(row, one, -2.0 * WING)
                    add(row, other, WING)
            continue
        for c in corners:
            add(row, c, 2.0 * WING)
            for end, other in ((p, q), (q, p)):
                there = across[number[min(end, c) * particles + max(end, c)]]
                beyond = [] if (min(end, c), max(end, c)) in sharp else [int(n) for n in there if n >= 0 and n != other]
                for corner, w in ((beyond[0], 1.0),) if beyond else ((end, 1.0), (c, 1.0), (other, -1.0)):
                    add(row, corner, -WING * w)
    most = max(map(len, weight))
    index, weights = np.zeros((particles + len(key), most), np.int64), np.zeros((particles + len(key), most))
    index[:particles, 0], weights[:particles, 0] = np.arange(particles), 1.0
    for e, row in enumerate(weight):
        index[particles + e, : len(row)], weights[particles + e, : len(row)] = list(row), list(row.values())
    i, j, k = triangle.T
    ij, jk, ki = (edge.reshape(-1, 3) + particles).T
    four = [(i, ij, ki), (ij, j, jk), (ki, jk, k), (ij, jk, ki)]
    return np.concatenate([np.stack(t, axis=1) for t in four]), index, weights
