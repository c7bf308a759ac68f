# SPDX-License-Identifier: GPL-2.0-only
"""Boxes that overlap, seen from above, and the two that are nearest: against all pairs."""

import numpy as np
import pytest
from mdanim_lammps.model.boxes import TOGETHER, nearest_boxes, overlaps_in_plan


def boxes(seed, number, spread):
    """Boxes of different sizes, one of them large; in cells of 1/8, so that some touch in an edge."""
    rng = np.random.default_rng(seed)
    low = np.round(8.0 * rng.uniform(0.0, spread, (number, 3))) / 8.0
    size = np.round(8.0 * rng.uniform(0.2, 1.0, (number, 3))) / 8.0
    size[number // 2] = spread / 2.0
    return low, low + size


@pytest.mark.parametrize("number", [1, 2, 40, 3 * TOGETHER + 1])
def test_overlaps_seen_from_above(number):
    """Each asked box has all others that overlap it, and itself."""
    low, high = boxes(number, number, 2.0 * number**0.5)
    asked = np.arange(0, number, 2)
    found = dict(overlaps_in_plan(low, high, asked))
    assert sorted(found) == asked.tolist()
    for m in asked.tolist():
        wanted = ((low[:, :2] < high[m, :2]) & (high[:, :2] > low[m, :2])).all(axis=1)
        assert found[m].tolist() == np.flatnonzero(wanted).tolist()
    assert not dict(overlaps_in_plan(low, high, asked[:0]))


@pytest.mark.parametrize("spread", [1.0, 10.0, 1000.0])
@pytest.mark.parametrize("allows", ["all", "some", "one", "none"])
def test_the_nearest_two(spread, allows):
    """The nearest of the pairs that count, by the lowest numbers of several that are as near."""
    low, high = boxes(int(spread), 30, spread)
    may = np.zeros((30, 30), bool)
    if allows == "some":
        may[:10, 10:] = True
    elif allows == "one":
        may[17, 3] = True
    else:
        may[:] = allows == "all"
    apart = (np.maximum(np.maximum(low[None] - high[:, None], low[:, None] - high[None]), 0.0) ** 2).sum(axis=2)
    apart = np.where(may & ~np.eye(30, dtype=bool), apart, np.inf)
    wanted = None if allows == "none" else (apart.min(), *divmod(int(apart.argmin()), 30))
    assert nearest_boxes(low, high, lambda i, j: may[i, j]) == wanted
