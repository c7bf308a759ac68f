# SPDX-License-Identifier: GPL-2.0-only
"""Assignment: islands whole, loads in balance, few moves, in this order; teams for what is too heavy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mdanim_lammps.parallel.plan.assign import assign
from mdanim_lammps.parallel.plan.teams import Team
from twin import islands as twin


def draw(seed, objects, executors, islands=None, spread=1.0):
    """Labels (some still), costs over a factor e^(4 spread) or so and owners."""
    rng = np.random.default_rng(seed)
    islands = islands or int(rng.integers(1, objects + 1))
    label = rng.permutation(np.concatenate([np.arange(islands), rng.integers(-1, islands, objects - islands)]))
    cost = 1 + (1000 * np.exp(spread * rng.normal(size=objects))).astype(np.int64)
    return label, cost, rng.integers(-1, executors, objects)


def loads(label, cost, owner, executors):
    """Load of every executor, without teams."""
    return [int(cost[(owner == e) & (label >= 0)].sum()) for e in range(executors)]


@settings(max_examples=200, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    objects=st.integers(1, 80),
    executors=st.integers(1, 9),
    spread=st.sampled_from([0.0, 1.0, 2.0]),
)
def test_islands_are_whole(seed, objects, executors, spread):
    """Put every island on one executor, leave what is still where it was, tell the loads, and do the same again for the same."""
    label, cost, owner = draw(seed, objects, executors, spread=spread)
    given_away = assign(label, cost, owner, executors)
    for island in range(label.max() + 1):
        assert len(set(given_away.owner[label == island])) == 1
    assert (given_away.owner[label < 0] == owner[label < 0]).all()
    assert ((given_away.owner[label >= 0] >= 0) & (given_away.owner[label >= 0] < executors)).all()
    assert given_away.load.tolist() == loads(label, cost, given_away.owner, executors)
    again = assign(label.copy(), cost.copy(), owner.copy(), executors)
    assert np.array_equal(again.owner, given_away.owner) and given_away.teams == ()


@settings(max_examples=200, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    objects=st.integers(1, 300),
    executors=st.integers(1, 9),
    spread=st.sampled_from([0.0, 1.0, 2.0]),
)
def test_loads_are_in_balance(seed, objects, executors, spread):
    """Keep the busiest within a tenth of the mean, or of the largest island, if islands are small; else in a packing's bound."""
    label, cost, owner = draw(seed, objects, executors, spread=spread)
    load = assign(label, cost, owner, executors).load
    weight = np.bincount(label[label >= 0], cost[label >= 0])
    mean = cost[label >= 0].sum() / executors
    if weight.max() <= 0.1 * mean:
        assert load.max() <= 1.1 * mean + 1
    assert load.max() <= max(1.1 * max(mean, weight.max()), mean + weight.max()) + 1


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), objects=st.integers(1, 8), executors=st.integers(2, 3))
def test_tiny_cases_against_all_placements(seed, objects, executors):
    """Keep the load within a fifth of the least possible, and what moves within two islands of the cheapest that is as even."""
    label, cost, owner = draw(seed, objects, executors, islands=min(objects, 6))
    found = assign(label, cost, owner, executors)
    every = list(twin.placements(label.tolist(), cost.tolist(), owner.tolist(), executors))
    assert found.load.max() <= 1.2 * min(load for load, _ in every) + 1
    moved = int(cost[(found.owner != owner)].sum())
    cheapest = min(cost_moved for load, cost_moved in every if load <= found.load.max())
    assert moved <= cheapest + 2 * np.bincount(label[label >= 0], cost[label >= 0]).max()


def test_moves_are_few_on_average():
    """Move no more than a fifth above the cheapest that is as even, over 300 tiny cases."""
    moved = cheapest = 0
    for seed in range(300):
        label, cost, owner = draw(seed, 7, 3, islands=5)
        found = assign(label, cost, owner, 3)
        every = twin.placements(label.tolist(), cost.tolist(), owner.tolist(), 3)
        moved += int(cost[found.owner != owner].sum())
        cheapest += min(cost_moved for load, cost_moved in every if load <= found.load.max())
    assert moved <= 1.2 * cheapest


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    objects=st.integers(1, 80),
    executors=st.integers(1, 9),
    spread=st.sampled_from([0.0, 1.0, 2.0]),
)
def test_nothing_moves_when_nothing_changes(seed, objects, executors, spread):
    """Find nothing to do where the last call has been, nor when all costs change by a few percent alike."""
    label, cost, owner = draw(seed, objects, executors, spread=spread)
    cost = 10 * executors * cost  # means and tenths are whole numbers then: a load may lie right between two roundings
    owner = assign(label, cost, owner, executors).owner
    assert np.array_equal(assign(label, cost, owner, executors).owner, owner)
    assert np.array_equal(assign(label, 3 * cost, owner, executors).owner, owner)


def test_one_call_goes_all_the_way():
    """Find nothing to do afterwards also where the first turn leaves something to gain."""
    cost, owner = np.array([36, 33, 9, 72, 32, 86, 47, 89, 14, 16]), np.array([1, 0, 1, 2, 2, 0, 0, 2, 2, 3])
    found = assign(np.arange(10), cost, owner, 4).owner
    assert np.array_equal(assign(np.arange(10), cost, found, 4).owner, found)


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), objects=st.integers(1, 40), executors=st.integers(2, 6))
def test_names_of_executors_do_not_matter_in_balance(seed, objects, executors):
    """Give the same, renamed, to renamed executors that are in balance."""
    label, cost, owner = draw(seed, objects, executors)
    owner = assign(label, cost, owner, executors).owner
    name = np.random.default_rng(seed).permutation(executors)
    renamed = np.where(owner < 0, -1, name[owner])
    found = assign(label, cost, renamed, executors)
    assert np.array_equal(found.owner, renamed)


@pytest.mark.parametrize(
    ("label", "cost", "owner", "executors", "expected"),
    [
        pytest.param([0, 0, 0], [10, 10, 15], [0, 0, 1], 2, [0, 0, 0], id="an island goes to whom has most of it"),
        pytest.param([0, 0], [10, 10], [1, 0], 2, [0, 0], id="of equals, the lowest"),
        pytest.param([0, 0], [30, 10], [-1, 1], 2, [1, 1], id="an executor that has some of it, though none has most"),
        pytest.param([0, 1, 2], [50, 50, 8], [0, 1, 1], 2, [0, 1, 1], id="a little above the mean: stay"),
        pytest.param([0, 1, 2], [50, 50, 20], [0, 1, 1], 2, [0, 1, 1], id="uneven, but no other way is better"),
        pytest.param([0, 1, 2, 3], [50, 30, 20, 5], [1, 1, 1, 0], 2, [1, 0, 0, 0], id="the largest stays"),
        pytest.param([0, 1, 2, 3, 4], [10, 10, 10, 10, 1], [0, 0, 0, 0, 1], 2, [0, 0, 1, 1, 1], id="not more goes than has to"),
        pytest.param([0, 1, 2], [99, 5, 5], [0, 0, 1], 3, [0, 0, 1], id="within a tenth of the largest island"),
        pytest.param([0, 1, 2, 3], [50, 50, 40, 40], [0, 0, 1, 1], 2, [0, 1, 0, 1], id="large ones are packed anew"),
        pytest.param([0, 1, 2, 3, 4], [30, 30, 20, 20, 20], [0, 1, 0, 1, 1], 2, [0, 1, 0, 1, 1], id="but not exchanged"),
        pytest.param([-1, 0, -1], [99, 5, 99], [2, 0, -1], 3, [2, 0, -1], id="what is still stays, and costs nothing"),
        pytest.param([0, 1, 2], [0, 0, 0], [-1, -1, -1], 3, [0, 1, 2], id="no owner, and no cost known yet"),
    ],
)
def test_by_hand(label, cost, owner, executors, expected):
    """Decide as one would by hand."""
    found = assign(np.array(label), np.array(cost), np.array(owner), executors)
    assert found.owner.tolist() == expected


def test_near_ones_are_dealt_out_together():
    """Give everyone a run of the order at first, so that neighbours seldom are of different executors."""
    rng = np.random.default_rng(2)
    order = rng.permutation(4000)
    owner = assign(np.arange(4000), rng.integers(50, 100, 4000), np.full(4000, -1), 4, order=order).owner
    assert np.count_nonzero(np.diff(owner[np.argsort(order)])) == 3


@pytest.mark.parametrize(("cost", "owner"), [([-1], [0]), ([1], [2]), ([1], [-2])])
def test_what_cannot_be(cost, owner):
    """Refuse costs and owners that cannot be."""
    with pytest.raises(ValueError, match="a cost is negative, or an owner is not one of the executors"):
        assign(np.array([0]), np.array(cost), np.array(owner), 2)


# --- teams --------------------------------------------------------------------------------------------------


def heavy(cost, owner, executors, teams=(), particles=None, **more):
    """Assign islands of one object each, 10 particles for every µs."""
    cost = np.array(cost)
    particles = 10 * cost if particles is None else np.array(particles)
    more = {"least": 4000} | more
    return assign(np.arange(len(cost)), cost, np.array(owner), executors, particles=particles, teams=teams, **more)


@pytest.mark.parametrize(
    ("cost", "owner", "executors", "sizes", "load"),
    [
        pytest.param([8000], [1], 2, [2], [5000, 5000], id="alone: all take part, at 1.6"),
        pytest.param([8000], [1], 4, [4], [2857] * 4, id="four at 2.8"),
        pytest.param([5000, 5000], [0, 0], 2, [], [5000, 5000], id="as many as executors: no team"),
        pytest.param([6000, 4400], [0, 1], 2, [], [6000, 4400], id="not worth it"),
        pytest.param([1590], [0], 4, [3], [0, 722, 722, 722], id="only as many as have enough particles"),
        pytest.param([790], [0], 2, [], [0, 790], id="too few particles for two"),
        pytest.param([6100, 4100], [3, 0], 4, [2, 2], [3812, 3812, 2562, 2562], id="no more members than there are executors"),
        pytest.param([9000, 9000, 100], [0, 0, 1], 4, [2, 2], [5625, 5625, 5625, 5625], id="two teams of two"),
    ],
)
def test_teams(cost, owner, executors, sizes, load):
    """Form teams of the right size; each has its members to itself and is led by the island's executor, if that is free."""
    found = heavy(cost, owner, executors)
    assert sorted(len(team.members) for team in found.teams) == sizes
    members = [e for team in found.teams for e in team.members]
    assert len(set(members)) == len(members)
    assert all(found.owner[team.island] == team.members[0] for team in found.teams)
    assert sorted(found.load.tolist()) == pytest.approx(sorted(load), abs=101)
    assert found.owner[0] == owner[0] or not found.teams


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), islands=st.integers(1, 25), executors=st.integers(2, 8), gain=st.sampled_from([40, 60, 80])
)
def test_teams_are_disjoint_spare_time_and_stay(seed, islands, executors, gain):
    """Form teams only where that spares a twentieth; the busiest is within a packing's bound; they stay when nothing changes."""
    rng = np.random.default_rng(seed)
    particles = (10 ** rng.uniform(2.0, 5.5, islands)).astype(np.int64)
    cost, owner = particles * rng.integers(1, 4, islands), rng.integers(-1, executors, islands)
    found = heavy(cost, owner, executors, particles=particles, gain=gain)
    without = assign(np.arange(islands), cost, owner, executors)
    for team in found.teams:
        assert len(team.members) >= 2 and particles[team.island] >= 4000 * len(team.members)
        assert found.owner[team.island] == team.members[0]
    members = [e for team in found.teams for e in team.members]
    assert len(set(members)) == len(members) and all(0 <= e < executors for e in members)
    assert found.load.max() <= (0.95 if found.teams else 1.0) * without.load.max()
    settled = heavy(cost, found.owner, executors, found.teams, particles, gain=gain)
    again = heavy(cost, settled.owner, executors, settled.teams, particles, gain=gain)
    assert np.array_equal(again.owner, settled.owner) and again.teams == settled.teams


def test_a_team_stays_while_its_island_is_about_the_mean():
    """Form a team above the mean by a tenth and more, dissolve it only where one executor would keep to the mean."""
    rest = [100] * 40
    owner = [0] + [1 + k % 3 for k in range(40)]
    sizes, teams = [], ()
    for cost in (1200, 1500, 1900, 1500, 1350):
        found = heavy([cost, *rest], owner, 4, teams)
        teams, owner = found.teams, found.owner
        sizes.append(len(teams[0].members) if teams else 1)
    assert sizes == [1, 1, 2, 2, 1]


def test_members_stay_in_their_team():
    """Take the members that were in the team, not those that have least to do now."""
    cost, owner = [6000, 3000, 2500, 2000], [2, 0, 1, 3]
    before = (Team(0, (2, 0)),)
    assert heavy(cost, owner, 4, before).teams[0].members == (2, 0)
    assert heavy(cost, owner, 4).teams[0].members == (2, 3)
