# SPDX-License-Identifier: GPL-2.0-only
"""From reports to orders: boxes, costs, windows, and the same in every process that plans."""

import numpy as np
import pytest
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.errors import DivergedError
from mdanim_lammps.parallel.plan import planner as module
from mdanim_lammps.parallel.plan.frame_plan import PlannerOptions
from mdanim_lammps.parallel.plan.orders import Report
from mdanim_lammps.parallel.plan.planner import Planner
from mdanim_lammps.run.frame_source import LammpsFailure
from planner_lab import ROW, report
from scene_texts import POND

LENGTHS = (40, 40, 7)


@pytest.fixture
def parts(prepared):
    """Eight cubes in a row, which will meet."""
    return SubPlans(prepared(ROW).plan)


EQUAL = [0, 0, 0, 0, 1, 1, 1, 1]


def begun(parts, **settings):
    """A planner that has given its first order."""
    planner = Planner(parts, 2, LENGTHS, PlannerOptions(**settings))
    return planner, planner.decide(report(parts, EQUAL))


def test_all_planners_order_the_same(parts):
    """Two planners that hear the same stay the same through windows, violations and costs; one that hears otherwise does not."""
    one, other = (Planner(parts, 2, LENGTHS, PlannerOptions(worth=0)) for _ in range(2))
    odd = Planner(parts, 2, LENGTHS, PlannerOptions(worth=0))
    rng = np.random.default_rng(3)
    owner, prints = EQUAL, ""
    for k in range(12):
        cost = rng.integers(500, 5000, 8)
        said = report(parts, owner, cost=cost, shift=0.001 * k, fingerprint=prints, escaped=(2,) if k % 4 == 2 else ())
        a, b, c = one.decide(said), other.decide(said), odd.decide(report(parts, owner, cost=cost[::-1], fingerprint=prints))
        assert a.plan.fingerprint() == b.plan.fingerprint() and (a.steps, a.commit) == (b.steps, b.commit)
        assert np.array_equal(a.low, b.low) and np.array_equal(a.high, b.high)
        owner, prints = a.plan.owner, a.plan.fingerprint()
    assert c.plan.fingerprint() != prints


def test_different_plans_are_found_out(parts):
    """Executors that have followed different plans end the run."""
    planner, _ = begun(parts)
    said = [*report(parts, EQUAL, fingerprint="a")[:1], *report(parts, EQUAL, fingerprint="b")[1:]]
    with pytest.raises(DivergedError, match="different plans"):
        planner.decide(said)


def test_costs_are_smoothed(parts):
    """The first measurement counts alone, the later ones by a quarter each; the guess before is not mixed in."""
    planner, order = begun(parts)
    guess = module.GUESSED_COST * parts.whole.certificate.steps_per_frame * planner.context.particles
    assert (planner.cost == np.maximum(1, guess.astype(int))).all()
    planner.decide(report(parts, order.plan.owner, cost=1000))
    assert (planner.cost == 1000).all()
    order = planner.decide(report(parts, order.plan.owner, cost=2000))
    assert (planner.cost == 1250).all()
    planner.decide(report(parts, order.plan.owner, cost=0))
    assert (planner.cost == 937).all() and planner.cost.dtype == np.int64


def test_boxes_double_until_no_object_escapes(parts):
    """Only those that have escaped are widened, twice as much each time; a window that is done forgets it."""
    planner, order = begun(parts)
    widths = [order.high - order.low]
    for k in (1, 2):
        order = planner.decide(report(parts, order.plan.owner, escaped=(3,)))
        assert not order.commit and planner.doublings.tolist() == [0, 0, 0, k, 0, 0, 0, 0] and order.steps == LENGTHS[0]
        widths.append(order.high - order.low)
    assert np.array_equal(np.delete(widths[2], 3, 0), np.delete(widths[0], 3, 0))
    box = parts.whole.system.position[parts.whole.system.object == 3]
    reach = [0.5 * (w[3] - np.ptp(box, axis=0)) for w in widths]
    np.testing.assert_allclose(reach[1], 2 * reach[0])
    np.testing.assert_allclose(reach[2], 4 * reach[0])
    order = planner.decide(report(parts, order.plan.owner))
    assert order.commit and not planner.doublings.any() and planner.frame == 1
    np.testing.assert_allclose(order.high - order.low, widths[0])


def test_an_object_that_escapes_for_ever_is_named(parts):
    """Not by a loop without end; and so is an object that is nowhere at all."""
    planner, order = begun(parts)
    with pytest.raises(LammpsFailure, match="leaves every box") as found:  # noqa: PT012 -- in which turn is not known
        for _ in range(module.DOUBLINGS + 1):
            order = planner.decide(report(parts, order.plan.owner, escaped=(5,)))
    assert found.value.solid == 5 and found.value.step == LENGTHS[0]
    planner, order = begun(parts)
    said = report(parts, EQUAL)
    said[1].low[1, 2] = np.nan
    with pytest.raises(LammpsFailure) as found:
        planner.decide(said)
    assert found.value.solid == 5


@pytest.mark.parametrize(
    ("settings", "joined", "steps"),
    [
        pytest.param({"worth": 0}, 1000, [40, 40, 7], id="whole frames while loads are in balance"),
        pytest.param({"worth": 0}, 40, [20, 20, 20, 20, 7], id="halves, but for a frame that is short anyway"),
        pytest.param({"worth": 0}, 10, [5] * 16 + [7], id="eighths"),
        pytest.param({"worth": 10**9}, 10, [40, 40, 7], id="not worth it"),
        pytest.param({"worth": 0, "finest": 2}, 10, [40, 40, 7], id="halves would not help"),
        pytest.param({"worth": 0}, 4, [40, 40, 2, 2, 3], id="eighths would not help, but of seven steps they do"),
    ],
)
def test_windows_that_end_at_frames(parts, settings, joined, steps):
    """Cubes so fast that all are one island in windows of ``joined`` steps, and apart in shorter ones: the longest window that
    leaves two executors in balance is chosen."""
    reserved = 0.4 - 0.1 * parts.whole.spacing - float(parts.gap.max())  # between two cubes, for both
    speed = 1.02 * reserved / (2 * 1.3 * joined * parts.whole.certificate.timestep)
    planner, found = Planner(parts, 2, LENGTHS, PlannerOptions(**settings)), []
    order = planner.decide(report(parts, EQUAL, speed=speed))
    while planner.frame < len(LENGTHS):
        found.append(order.steps)
        order = planner.decide(report(parts, order.plan.owner, cost=10**6, speed=speed))
    assert found == steps


def test_the_pool_is_one_more_object(prepared):
    """Its box is the basin up to where it matters, it never widens, and has a cost of its own."""
    parts = SubPlans(prepared(POND.replace("MODEL", "")).plan)
    planner = Planner(parts, 2, LENGTHS, PlannerOptions())
    grid, count = parts.whole.grid, planner.objects
    assert len(planner.cost) == count + 1 and not planner.context.still[-1] and planner.context.still.sum() == 1
    assert (planner.low[-1] < np.array(grid.low)).all() and planner.high[-1, 2] == parts.grid_top
    assert (planner.high[-1, :2] > np.array(grid.high)[:2]).all()
    system = parts.whole.system
    low, high = (f.reduceat(system.position, system.first[:-1]) for f in (np.minimum, np.maximum))
    moving = np.flatnonzero(~planner.context.still[:-1])
    said = Report(moving, low[moving], high[moving], np.ones(len(moving)), np.full(len(moving), 100), 700)
    empty = Report(moving[:0], low[:0], high[:0], np.zeros(0), moving[:0])
    order = planner.decide([said, empty])
    assert np.array_equal(order.high[-1], planner.high[-1])
    assert planner.cost[-1] != 700, "nothing was measured before the first window"
    planner.decide([said, empty])
    assert planner.cost[-1] == 700
    names = list(system.names)
    assert order.plan.label[names.index("raft")] == order.plan.label[-1] != order.plan.label[names.index("higher")]
