# SPDX-License-Identifier: GPL-2.0-only
"""Naive twins of parallel/plan/islands.py and parallel/plan/assign.py: one pair, one object, one placement at a time."""

from itertools import product

import numpy as np


def pairs(low, high, gap):
    """All (a, b), a < b, of boxes that meet, eq. (3.15)."""

    def meet(a, b):
        return all(low[a][k] - high[b][k] <= gap and low[b][k] - high[a][k] <= gap for k in range(3))

    return [(a, b) for a in range(len(low)) for b in range(a + 1, len(low)) if meet(a, b)]


def all_pairs(low, high, gap):
    """The same of arrays (M, 3), all pairs at once; int64, shape (P, 2)."""
    a, b = np.triu_indices(len(low), 1)
    meet = ((low[a] - high[b] <= gap) & (low[b] - high[a] <= gap)).all(axis=1)
    return np.stack([a[meet], b[meet]], axis=1)


def components(count, pairs, still):
    """Island of every object, walking from each to whom it meets."""
    label, number = [-1] * count, 0
    for start in range(count):
        if still[start] or label[start] >= 0:
            continue
        label[start], walk = number, [start]
        while walk:
            here = walk.pop()
            for a, b in pairs:
                for x, y in ((a, b), (b, a)):
                    if x == here and not still[y] and label[y] < 0:
                        label[y] = number
                        walk.append(y)
        number += 1
    return label


def guests(pairs, label, still):
    """(island, still object) of all copies."""
    return sorted({(label[x], y) for a, b in pairs for x, y in ((a, b), (b, a)) if still[y] and not still[x]})


def placements(label, cost, owner, executors):
    """(load of the busiest, cost of what moves) of every way to put islands on executors."""
    islands = sorted(set(label) - {-1})
    for place in product(range(executors), repeat=len(islands)):
        load, moved = [0] * executors, 0
        for m, island in enumerate(label):
            if island >= 0:
                load[place[island]] += cost[m]
                moved += cost[m] * (place[island] != owner[m])
        yield max(load), moved
