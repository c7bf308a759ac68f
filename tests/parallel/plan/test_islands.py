# SPDX-License-Identifier: GPL-2.0-only
"""Islands: the fast way finds the same pairs and the same islands as naive loops, exactly."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mdanim_lammps.parallel.plan import islands
from mdanim_lammps.reach.window import window
from twin import islands as twin


def crowd(rng, count, spread=1.0, lattice=False):
    """Boxes of unlike sizes, over a factor e^(4 spread) or so; on a lattice many just touch."""
    low = rng.uniform(-2.0, 2.0, (count, 3)) * count ** (1.0 / 3.0)
    size = np.exp(spread * rng.normal(size=(count, 1))) * rng.uniform(0.5, 1.0, (count, 3))
    if lattice:
        low, size = np.round(low), np.round(size)
    return low, low + size


def test_reach_by_hand():
    """Add 1.3 of what the speed covers, free fall from rest, and the margin."""
    d = window(np.array([0.0, 2.0]), 0.5, 10.0, 0.25)
    assert d == pytest.approx([1.25 + 0.25, 1.3 + 1.25 + 0.25], rel=1e-15)


def test_boxes_by_hand():
    """Widen each box by its own d, on every side."""
    low, high = islands.boxes(np.zeros((2, 3)), np.ones((2, 3)), np.array([0.5, 2.0]))
    assert low.tolist() == [[-0.5] * 3, [-2.0] * 3] and high.tolist() == [[1.5] * 3, [3.0] * 3]


@pytest.mark.parametrize(
    ("shift", "gap", "meet"),
    [
        pytest.param((1.0, 0.0, 0.0), 0.0, True, id="touch"),
        pytest.param((np.nextafter(1.0, 2.0), 0.0, 0.0), 0.0, False, id="apart by a rounding"),
        pytest.param((0.0, 1.5, 0.0), 0.5, True, id="apart by the gap"),
        pytest.param((0.0, 0.0, -1.75), 0.5, False, id="apart by more, on the other side"),
        pytest.param((1.25, -1.25, 1.25), 0.25, True, id="corner to corner"),
        pytest.param((0.0, 0.0, 0.0), 0.0, True, id="the same box"),
    ],
)
@pytest.mark.parametrize("way", [islands.pairs, twin.all_pairs])
def test_two_boxes(way, shift, gap, meet):
    """Tell unit cubes that meet from those that do not."""
    low = np.array([(0.0, 0.0, 0.0), shift])
    assert way(low, low + 1.0, gap).tolist() == ([[0, 1]] if meet else [])


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(0, 60),
    spread=st.sampled_from([0.0, 0.5, 2.0]),
    lattice=st.booleans(),
    gap=st.sampled_from([0.0, 0.1, 1.0, 5.0]),
    far=st.sampled_from([0.0, 1e3, 1e12]),
)
def test_grid_finds_what_the_twin_finds(seed, count, spread, lattice, gap, far):
    """Find the same pairs three ways, wherever the boxes are, some of them far from the others."""
    rng = np.random.default_rng(seed)
    low, high = crowd(rng, count, spread, lattice)
    away = (rng.random((count, 1)) < 0.1) * far
    low, high = low + away, high + away
    expected = [list(pair) for pair in twin.pairs(low.tolist(), high.tolist(), gap)]
    assert twin.all_pairs(low, high, gap).tolist() == expected
    assert islands.pairs(low, high, gap).tolist() == expected


@pytest.mark.parametrize("count", [200, 201, 1500])
def test_many_boxes(count):
    """Find all pairs of many boxes, with a pool that holds half of them."""
    low, high = crowd(np.random.default_rng(count), count, 0.7)
    low[7], high[7] = low.min(axis=0), (*high.max(axis=0)[:2], low[:, 2].mean())
    found = islands.pairs(low, high, 0.1)
    assert found.dtype == np.int64
    assert np.array_equal(found, twin.all_pairs(low, high, 0.1))
    assert len(found) > count / 3


def test_blocks_change_nothing(monkeypatch):
    """Find the same in small blocks."""
    low, high = crowd(np.random.default_rng(3), 300, 1.0)
    expected = islands.pairs(low, high, 0.1)
    monkeypatch.setattr(islands, "BLOCK", 50)
    assert np.array_equal(islands.pairs(low, high, 0.1), expected)


@pytest.mark.parametrize(("share", "edge"), [(0.4, 10.0), (0.002, 100.0)])
def test_most_boxes_are_never_looked_at(monkeypatch, share, edge):
    """Try pairs that are near, not as many as there are, also with many larger boxes or a few huge ones."""
    tried = []
    meeting = islands._meeting
    monkeypatch.setattr(islands, "_meeting", lambda one, two, a, b, gap: (tried.append(len(a)), meeting(one, two, a, b, gap))[1])
    rng = np.random.default_rng(5)
    low = rng.uniform(0.0, 200.0, (4000, 3))
    high = low + np.where(rng.random((4000, 1)) < share, edge, 1.0)
    found = islands.pairs(low, high, 0.1)
    assert sum(tried) < 20 * len(found) < 4000 * 3999 / 20


@pytest.mark.parametrize(
    "broken",
    [
        pytest.param(lambda low, high: (low * np.nan, high, 0.0), id="not a number"),
        pytest.param(lambda low, high: (low, high + np.inf, 0.0), id="infinite"),
        pytest.param(lambda low, high: (high, low, 0.0), id="inside out"),
        pytest.param(lambda low, high: (low, high, -1.0), id="negative gap"),
    ],
)
def test_no_boxes(broken):
    """Refuse what is not a box: a plan made of it would let objects pass through each other."""
    with pytest.raises(ValueError, match=r"a box is (not finite|turned inside out)"):
        islands.pairs(*broken(np.zeros((3, 3)), np.ones((3, 3))))


@settings(max_examples=150, deadline=None)
@given(data=st.data(), count=st.integers(1, 30))
def test_components_and_guests_are_those_of_the_twin(data, count):
    """Find the islands and the guests that walking from object to object finds."""
    number = st.integers(0, count - 1)
    drawn = data.draw(st.sets(st.tuples(number, number), max_size=2 * count))
    pairs = sorted({(min(a, b), max(a, b)) for a, b in drawn if a != b})
    still = np.array(data.draw(st.lists(st.booleans(), min_size=count, max_size=count)))
    array = np.array(pairs, np.int64).reshape(-1, 2)
    label = islands.components(count, array, still)
    assert label.tolist() == twin.components(count, pairs, still)
    assert [tuple(g) for g in islands.guests(array, label, still).tolist()] == twin.guests(pairs, label.tolist(), still)


@pytest.mark.parametrize("shuffled", [False, True])
def test_a_long_chain_is_one_island(shuffled):
    """Join 20 000 objects, each to the next one, in a few rounds."""
    count = 20_000
    names = np.random.default_rng(1).permutation(count) if shuffled else np.arange(count)
    pairs = np.sort(np.column_stack([names[:-1], names[1:]]), axis=1)
    assert (islands.components(count, pairs, np.zeros(count, bool)) == 0).all()


def test_a_floor_connects_nothing():
    """Keep apart what lies on the same floor, and give each island its copy."""
    pairs = np.array([(0, 1), (0, 2), (0, 3), (2, 3), (0, 4)])
    still = np.array([True, False, False, False, True])
    label = islands.components(5, pairs, still)
    assert label.tolist() == [-1, 0, 1, 1, -1]
    assert islands.guests(pairs, label, still).tolist() == [[0, 0], [1, 0]]
