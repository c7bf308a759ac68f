# SPDX-License-Identifier: GPL-2.0-only
"""The plan of a frame: the same in every process that makes it, and bundles that last."""

import os
import subprocess
import sys
from dataclasses import fields, replace

import numpy as np
import pytest
from frame_plan_lab import BUNDLE_PARTICLES, bundles, plan, scene
from hypothesis import given, settings
from hypothesis import strategies as st
from mdanim_lammps.parallel.plan import islands
from mdanim_lammps.parallel.plan.frame_plan import FrameAssignment, z_order
from mdanim_lammps.parallel.plan.teams import Team
from paths import LAB

KEPT = np.zeros((0, 2), np.int64)


def before(label, owner, bundle, teams=()):
    """A plan to follow."""
    return FrameAssignment(np.array(owner), np.array(label), np.array(bundle), KEPT, tuple(teams), np.zeros(4, np.int64))


def moved(at, rng, by=0.1):
    """The same objects a frame later, with the state of where they are now."""
    step = rng.normal(0.0, by, at["low"].shape) * ~at["still"][:, None]
    return {**at, "low": at["low"] + step, "high": at["high"] + step}


@pytest.mark.parametrize("executors", [1, 2, 5])
def test_plans_of_a_flight(executors):
    """Follow 300 objects for 20 frames: whole islands and bundles, guests, bundles that only lose, loads in balance."""
    rng = np.random.default_rng(executors)
    at, last = scene(300, heavy=0.0), None
    for _ in range(20):
        made = plan(**at, executors=executors, previous=last)
        moving = ~at["still"]
        assert np.array_equal(made.label < 0, at["still"]) and np.array_equal(made.bundle < 0, at["still"])
        met = islands.pairs(*islands.boxes(at["low"], at["high"], at["d"]), at["gap"])
        assert np.array_equal(made.label, islands.components(300, met, at["still"]))
        assert np.array_equal(made.guests, islands.guests(met, made.label, at["still"])) and len(made.guests)
        whole(made, at["particles"])
        assert made.load.max() <= 1.1 * max(made.load.mean() + 1, np.bincount(made.label[moving], at["cost"][moving]).max())
        if last is not None:
            same = moving & (made.bundle <= last.bundle.max())
            assert np.array_equal(made.bundle[same], last.bundle[same])
            assert np.array_equal(made.owner[same], last.owner[same])
        last, at = made, {**moved(at, rng), "owner": made.owner}


def whole(made, particles, room=BUNDLE_PARTICLES):
    """Every island is in one bundle of one executor, and no bundle but of one island exceeds the room."""
    for b in set(made.bundle.tolist()) - {-1}:
        here = made.bundle == b
        assert len(set(made.owner[here])) == 1
        assert not set(made.label[here]) & set(made.label[~here])
        assert particles[here].sum() <= room or len(set(made.label[here])) == 1


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 120), executors=st.integers(1, 6))
def test_nothing_changes_when_nothing_changes(seed, count, executors):
    """Settle at once but for teams, which may need a second look: the same owners, bundles and teams from then on."""
    at = scene(count, seed)
    made = plan(**at, executors=executors)
    whole(made, at["particles"])
    for _ in range(2):
        settled, made = made, plan(**{**at, "owner": made.owner}, executors=executors, previous=made)
    assert made.fingerprint() == settled.fingerprint()


def test_all_processes_plan_the_same():
    """Get the same fingerprint from copies in other memory layouts, and in a process of its own."""
    at = scene(250, 3)
    made = plan(**at, executors=4).fingerprint()
    other = {k: np.asfortranarray(v) if isinstance(v, np.ndarray) else v for k, v in at.items()}
    other["cost"] = np.repeat(other["cost"], 2)[::2]
    assert plan(**other, executors=4).fingerprint() == made
    program = "from frame_plan_lab import plan, scene; print(plan(**scene(250, 3), executors=4).fingerprint())"
    told = subprocess.run(
        [sys.executable, "-c", program],
        cwd=LAB,
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONHASHSEED": "7"},
    )
    assert told.stdout.strip() == made


@pytest.mark.parametrize("field", [f.name for f in fields(FrameAssignment)])
def test_the_fingerprint_sees_everything(field):
    """Change with every field of a plan, and with nothing but those."""
    made = plan(**scene(30, 3, heavy=0.1), executors=4, least=4000)
    assert made.teams and len(made.guests)
    assert replace(made, owner=made.owner.astype(np.int32)).fingerprint() == made.fingerprint()
    value = getattr(made, field)
    if field == "teams":
        other = (replace(value[0], members=value[0].members[::-1]), *value[1:])
    else:
        other = value.copy()
        other.flat[-1] += 1
    assert replace(made, **{field: other}).fingerprint() != made.fingerprint()


def test_larger_boxes_after_a_violation():
    """Join islands whose boxes are doubled, and leave the bundles of the others as they are."""
    low = np.array([(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (9.0, 0.0, 0.0)])
    at = dict(low=low, high=low + 1.0, cost=np.full(3, 10), particles=np.full(3, 3000), still=np.zeros(3, bool), gap=0.1)
    first = plan(**at, d=np.full(3, 0.4), owner=np.full(3, -1), executors=1)
    assert first.label.tolist() == [0, 1, 2] and first.bundle.tolist() == [0, 1, 2]
    second = plan(**at, d=np.array([0.8, 0.4, 0.4]), owner=first.owner, executors=1, previous=first)
    assert second.label.tolist() == [0, 0, 1] and second.bundle.tolist() == [3, 3, 2]


def test_the_pool_connects():
    """Objects near the pool are in its island."""
    low = np.array([(0.0, 0.0, 1.0), (5.0, 0.0, 1.0), (0.0, 0.0, 9.0), (-1.0, -1.0, 0.0)])
    high = np.array([(1.0, 1.0, 2.0), (6.0, 1.0, 2.0), (1.0, 1.0, 10.0), (7.0, 2.0, 1.0)])
    rest = dict(particles=np.full(4, 100), still=np.zeros(4, bool), gap=0.1)
    made = plan(low, high, np.full(4, 0.05), np.array([40, 20, 30, 10]), np.array([0, 1, 1, 1]), 2, **rest)
    assert made.label.tolist() == [0, 0, 1, 0] and made.owner.tolist() == [0, 0, 1, 0]


def test_what_is_joined_is_one_island():
    """However far apart it is; what is still and joined is a guest, which connects nothing else."""
    low = np.arange(0.0, 60.0, 10.0)[:, None] * (1.0, 0.0, 0.0)
    at = dict(low=low, high=low + 1.0, d=np.full(6, 0.1), cost=np.full(6, 10), owner=np.arange(6) % 3, executors=3)
    at |= dict(particles=np.full(6, 100), still=np.arange(6) == 5, gap=0.0, feels=np.zeros(6, bool))
    assert plan(**at).label.tolist() == [0, 1, 2, 3, 4, -1]
    made = plan(**at, joined=np.array([(0, 3), (3, 4), (1, 5), (2, 5)]))
    assert made.label.tolist() == [0, 1, 2, 0, 0, -1] and made.guests.tolist() == [[1, 5], [2, 5]]
    assert len(set(made.owner[[0, 3, 4]])) == 1


def test_teams_are_handed_on():
    """Keep a team for an island that would get none anew."""
    count = 41
    low = np.arange(3.0 * count).reshape(count, 3)
    at = dict(low=low, high=low + 1.0, d=np.zeros(count), particles=np.full(count, 20_000), still=np.zeros(count, bool), gap=0.1)
    first = plan(**at, cost=np.array([1900] + [100] * 40), owner=np.array([0] + [1 + k % 3 for k in range(40)]), executors=4)
    assert len(first.teams) == 1
    later = dict(**at, cost=np.array([1500] + [100] * 40), owner=first.owner, executors=4)
    assert plan(**later, previous=first).teams == first.teams
    assert plan(**later).teams == ()


# --- bundles ------------------------------------------------------------------------------------------------

SIZE = np.full(6, 1000)
LAST = [0, 1, 2, 3, 4, 5], [0] * 6, [7, 7, 3, 3, 9, 9]


@pytest.mark.parametrize(
    ("label", "owner", "last", "expected"),
    [
        pytest.param([0, 1, 2, 3, 4, 5], [0, 0, 0, 1, 1, 1], None, [0, 0, 0, 1, 1, 1], id="one for each executor"),
        pytest.param([0, 1, 2, 3, 4, 5], [0] * 6, None, [0, 0, 0, 0, 1, 1], id="up to 4000 particles"),
        pytest.param([0, 0, 0, 1, 2, 3], [0] * 6, None, [1, 1, 1, 0, 0, 0], id="above half of that alone"),
        pytest.param([0, 1, 2, 3, 4, -1], [0] * 6, None, [0, 0, 0, 0, 1, -1], id="still"),
        pytest.param([0, 1, 2, 3, 4, 5], [0] * 6, LAST, LAST[2], id="as before"),
        pytest.param([0, 0, 1, 2, 3, 4], [0] * 6, LAST, LAST[2], id="join within a bundle"),
        pytest.param([0, 1, 2, 3, 4, 5], [0] * 6, ([0, 0, 1, 2, 3, 4], *LAST[1:]), LAST[2], id="part within a bundle"),
        pytest.param([0, 1, 1, 2, 3, 4], [0] * 6, LAST, [7, 10, 10, 3, 9, 9], id="join from two bundles: the others stay"),
        pytest.param([0, 1, 2, 3, 4, 5], [0, 1, 0, 0, 0, 0], LAST, [7, 10, 3, 3, 9, 9], id="one goes to another executor"),
        pytest.param(
            [0, 1, 2, 3, 4, 5],
            [1, 1, 0, 0, 0, 0],
            LAST,
            [10, 10, 3, 3, 9, 9],
            id="all of a bundle go to another executor: it is built there",
        ),
    ],
)
def test_bundles_by_hand(label, owner, last, expected):
    """Put together, and keep together, as one would by hand; numbers as of the plan before, or above them."""
    found = bundles(np.array(label), np.array(owner), SIZE, previous=before(*last) if last else None)
    assert found.tolist() == expected


@pytest.mark.parametrize(
    ("label", "teams", "last", "old", "expected"),
    [
        pytest.param([0, 1, 2, 2, 2, 2], [(1, (0, 1))], None, (), [0, 1, 2, 2, 2, 2], id="a team's island is alone"),
        pytest.param(
            [0, 1, 2, 2, 2, 2], [(1, (0, 1))], [4, 5, 6, 6, 6, 6], [(1, (0, 1))], [4, 5, 6, 6, 6, 6], id="the same team"
        ),
        pytest.param(
            [0, 1, 2, 2, 2, 2], [(1, (0, 2))], [4, 5, 6, 6, 6, 6], [(1, (0, 1))], [4, 7, 6, 6, 6, 6], id="other members"
        ),
        pytest.param([0, 1, 2, 2, 2, 2], [], [4, 5, 6, 6, 6, 6], [(1, (0, 1))], [4, 7, 6, 6, 6, 6], id="a team no more"),
        pytest.param(
            [0, 1, 2, 2, 2, 2], [(1, (0, 1))], [4, 4, 6, 6, 6, 6], [], [4, 7, 6, 6, 6, 6], id="a team now: it leaves its bundle"
        ),
        pytest.param(
            [0, 1, 2, 3, 3, 3], [(3, (0, 1))], [4, 5, 6, 6, 6, 6], [(2, (0, 1))], [4, 5, 7, 8, 8, 8], id="a team's island parts"
        ),
    ],
)
def test_bundles_of_teams(label, teams, last, old, expected):
    """Keep the bundle of a team while it is the same island and the same team."""
    was = before([0, 1, 2, 2, 2, 2], [0] * 6, last, [Team(*t) for t in old]) if last else None
    found = bundles(np.array(label), np.zeros(6, np.int64), SIZE, [Team(*t) for t in teams], previous=was)
    assert found.tolist() == expected


def test_thin_bundles_are_put_together():
    """Leave up to twice as many bundles as would do, and 2; put the thin ones of more together, and no others."""
    label, owner = np.arange(40), np.zeros(40, np.int64)
    size = np.array([3500] + [50] * 39)
    few = before(label, owner, [0, 1, 2, 3, 4] + [5] * 35)
    assert np.array_equal(bundles(label, owner, size, previous=few), few.bundle)
    found = bundles(label, owner, size, previous=before(label, owner, label))
    assert found[0] == 0 and (found[1:] == 40).all()


def test_room_is_kept():
    """Never put more than fits into a bundle of several islands, for all sizes of islands and rooms."""
    rng = np.random.default_rng(4)
    for room in (1, 2, 100, 4000):
        label, size = np.arange(500), rng.integers(1, 1000, 500)
        owner = np.sort(rng.integers(0, 3, 500))
        found = bundles(label, owner, size, room=room)
        filled, islands_in = np.bincount(found, size), np.bincount(found)
        assert filled[islands_in > 1].max(initial=0) <= room
        assert len(filled) <= 4 * size.sum() / room + 500 * (2 * size > room).mean() + 3


def test_most_bundles_survive_in_a_crowd():
    """Build few bundles anew while 1000 objects fly about, and move few objects more than islands call for."""
    rng = np.random.default_rng(6)
    at, last, anew, went, called = scene(1000, 6, still=0.0, heavy=0.0, volume=30.0), None, [], 0, 0
    for _ in range(15):
        made = plan(**at, executors=4, previous=last)
        if last is not None:
            number = np.unique(made.bundle)
            anew.append(np.mean(number > last.bundle.max()))
            went += np.count_nonzero(made.owner != last.owner)
            table = np.zeros((made.label.max() + 1, 4), int)
            np.add.at(table, (made.label, last.owner), 1)
            called += 1000 - table.max(axis=1).sum()
        last, at = made, {**moved(at, rng), "owner": made.owner}
    assert np.mean(anew) < 0.15
    assert 0 < called <= went <= 1.3 * called + 20


def test_order_follows_space():
    """Give near numbers to boxes that are near, eight by eight along a curve, wherever the scene is."""
    corner = np.array([(x, y, z) for x in range(4) for y in range(4) for z in range(4)], float)
    rank = np.argsort(np.argsort(z_order(corner, corner)))
    assert all(np.ptp(corner[rank // 8 == k], axis=0).tolist() == [1.0] * 3 for k in range(8))
    assert np.array_equal(np.argsort(z_order(1e6 + 8 * corner, 1e6 + 8 * corner)), np.argsort(rank))
    assert z_order(corner[:1], corner[:1]).tolist() == [0]
    fine = np.random.default_rng(8).integers(0, 2**20, (50, 3))
    fine[0], fine[1] = 0, 2**20
    expected = [
        sum((int(x) >> bit & 1) << 3 * bit + axis for axis, x in enumerate(place) for bit in range(20))
        for place in np.minimum(fine, 2**20 - 1)
    ]
    assert z_order(fine.astype(float), fine.astype(float)).tolist() == expected


def test_no_loop_over_objects():
    """Run as many lines of Python for eight times the objects, with and without a plan before."""

    def lines(count):
        ran = 0

        def trace(frame, event, _):
            nonlocal ran
            ran += event == "line"
            return trace if os.path.join("parallel", "plan") in frame.f_code.co_filename else None

        at = scene(count, heavy=0.0)
        old = sys.gettrace()
        sys.settrace(trace)
        try:
            first = plan(**at, executors=4)
            plan(**{**at, "owner": np.where(first.owner == 0, 1, first.owner)}, executors=4, previous=first)
        finally:
            sys.settrace(old)
        return ran

    few, many = lines(1000), lines(8000)
    assert few > 200 and many < 1.3 * few + 100
