# SPDX-License-Identifier: GPL-2.0-only
"""Time of the plan of a frame, and number of its moves: ``python bench/planning.py [times|crowd|gains]``.

times: for random boxes as in a loose pile; milliseconds, the least of some rounds. The parts are measured alone.
crowd: objects that fly about in a box and bounce off its sides, for 100 frames; means over the frames but the first.
gains: the same for 40 frames with one mechanism of the plan left out, and how much faster executors are forecast to be without
short windows and without teams. Nothing is timed, so other programs on the machine change nothing.
"""

import sys
import time
from contextlib import nullcontext
from unittest import mock

import numpy as np
import scaling
from mdanim_lammps.cost.speedup_forecast import forecast_speedup
from mdanim_lammps.parallel.plan import assign as assigning
from mdanim_lammps.parallel.plan import frame_plan as planning
from mdanim_lammps.parallel.plan import islands
from mdanim_lammps.parallel.plan.assign import assign
from mdanim_lammps.parallel.plan.frame_plan import PlannerOptions
from mdanim_lammps.reach.window import window

EXECUTORS = 8


def least(work, seconds: float = 1.0) -> float:
    """Time of a call [ms], the least of at least 3 and of as many as fit."""
    spent = []
    while len(spent) < 3 or (sum(spent) < seconds and len(spent) < 100):
        start = time.perf_counter()
        work()
        spent.append(time.perf_counter() - start)
    return 1e3 * min(spent)


def pile(count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Boxes with edges of 0.5 to 1, one in a volume of 4."""
    low = rng.uniform(0.0, (4.0 * count) ** (1.0 / 3.0), (count, 3))
    return low, low + rng.uniform(0.5, 1.0, (count, 3))


def times() -> None:
    """One row for every number of boxes."""
    print(
        f"{'boxes':>7} {'pairs':>7} {'islands':>7} | {'pairs':>7} {'islands':>8} {'assign':>7} {'bundles':>8} "
        f"{'order':>6} | {'first plan':>10} {'next':>7} {'balanced':>9}  [ms]"
    )
    for count in (10, 64, 1_000, 10_000, 100_000):
        rng = np.random.default_rng(count)
        low, high = pile(count, rng)
        d = np.full(count, 0.05)
        still = rng.random(count) < 0.05
        particles = rng.integers(100, 1000, count)
        known = dict(particles=particles, still=still, gap=0.1)
        unowned = np.full(count, -1)
        where = low, high, d
        first = planning.plan(*where, 2 * particles, unowned, EXECUTORS, **known)
        reserved = *islands.boxes(low, high, d), 0.1
        met = islands.pairs(*reserved)
        order = planning.z_order(low, high)
        uneven = np.where(first.owner == 0, 3 * particles, 2 * particles)
        print(
            f"{count:7} {len(met):7} {first.label.max() + 1:7} | {least(lambda: islands.pairs(*reserved)):7.2f} "
            f"{least(lambda: islands.components(count, met, still)):8.2f} "
            f"{least(lambda: assign(first.label, 2 * particles, unowned, EXECUTORS, particles=particles, order=order)):7.2f} "
            f"{least(lambda: planning.bundles(first.label, first.owner, particles, first.teams, order=order)):8.2f} "
            f"{least(lambda: planning.z_order(low, high)):6.2f} | "
            f"{least(lambda: planning.plan(*where, 2 * particles, unowned, EXECUTORS, **known)):10.2f} "
            f"{least(lambda: planning.plan(*where, 2 * particles, first.owner, EXECUTORS, previous=first, **known)):7.2f} "
            f"{least(lambda: planning.plan(*where, uneven, first.owner, EXECUTORS, previous=first, **known)):9.2f}"
        )


def crowd() -> None:
    """One row for every crowd."""
    print(
        "per frame: islands; objects moved, and those that islands that join call for at least [%]; load of the busiest over\n"
        "the mean, the worst of all frames; bundles, built anew [%], particles in those [%]"
    )
    for count, executors, volume in (
        (24, 4, 30.0),
        (100, 4, 30.0),
        (1_000, 2, 30.0),
        (1_000, 4, 30.0),
        (1_000, 8, 30.0),
        (1_000, 8, 10.0),
        (10_000, 8, 30.0),
    ):
        print(f"{count:6} objects, one in {volume:.0f}, {executors} executors: " + _fly(count, executors, volume))


LEFT_OUT = {
    "nothing": None,
    "islands stay at home": (assigning, "_fitting", lambda weight, home, room: np.zeros(len(weight), bool)),
    "islands are dealt out along a curve": (planning, "z_order", lambda low, high: np.arange(len(low))),
    "large islands are packed anew": (assigning, "_pack", lambda weight, home, *rest: assigning._unload(weight, home, *rest)),
    "thin bundles are put together": (planning, "_thin_out", lambda *arguments: None),
}


def gains() -> None:
    """One row for every mechanism that is left out."""
    for count, executors, volume in ((24, 4, 30.0), (1_000, 2, 30.0), (1_000, 8, 10.0)):
        print(f"{count} objects, one in {volume:.0f}, {executors} executors (columns as of crowd), without:")
        for name, patch in LEFT_OUT.items():
            with mock.patch.object(*patch) if patch else nullcontext():
                print(f"  {name:36} {_fly(count, executors, volume, 40)}")
    print("times as fast as one executor, forecast: all; windows of a frame only; no teams")
    for scene, executors in (("crowd", 2), ("crowd", 8), ("hail", 2), ("hail", 4), ("hail", 8), ("one", 2), ("one", 4)):
        ready = scaling.load(scene, 50)
        found = (
            forecast_speedup(ready, executors, options).faster
            for options in (PlannerOptions(), PlannerOptions(finest=1), PlannerOptions(least=10**9))
        )
        print(f"  {scene}, {executors} executors: " + "; ".join(f"{x:.2f}" for x in found))


def _fly(count: int, executors: int, volume: float, frames: int = 100) -> str:
    rng = np.random.default_rng(count)
    side = (volume * count) ** (1.0 / 3.0)
    place, velocity = rng.uniform(0.0, side, (count, 3)), rng.normal(0.0, 0.1, (count, 3))
    edge = rng.uniform(0.5, 1.0, (count, 3))
    particles = (1000 * edge.prod(axis=1)).astype(np.int64)
    still = np.zeros(count, bool)
    owner, before, rows = np.full(count, -1), None, []
    for _ in range(frames):
        place += velocity
        velocity = np.where((place < 0.0) & (velocity < 0.0) | (place > side) & (velocity > 0.0), -velocity, velocity)
        speed = np.abs(velocity).max(axis=1)
        cost = (2 * particles * rng.uniform(0.95, 1.05, count)).astype(np.int64)  # as measured clocks are
        d = window(speed, 1.0, 0.0, 0.02)
        plan = planning.plan(
            place, place + edge, d, cost, owner, executors, particles=particles, still=still, gap=0.1, previous=before
        )
        if before is not None:
            isle, at = np.unique(plan.label * executors + owner, return_counts=True)
            most = np.zeros(plan.label.max() + 1, np.int64)
            np.maximum.at(most, isle // executors, at)
            new = np.unique(plan.bundle[plan.bundle > before.bundle.max()])
            number = len(np.unique(plan.bundle))
            rows.append(
                (
                    plan.label.max() + 1,
                    100 * (plan.owner != owner).mean(),
                    100 * (1 - most.sum() / count),
                    plan.load.max() / plan.load.mean(),
                    number,
                    100 * len(new) / number,
                    100 * particles[plan.bundle > before.bundle.max()].sum() / particles.sum(),
                )
            )
        owner, before = plan.owner, plan
    mean, worst = np.mean(rows, axis=0), np.max(rows, axis=0)
    return (
        f"{mean[0]:.0f}; {mean[1]:.2f}, {mean[2]:.2f}; {mean[3]:.3f}, {worst[3]:.3f}; {mean[4]:.0f}, {mean[5]:.1f}, {mean[6]:.1f}"
    )


if __name__ == "__main__":
    for part in sys.argv[1:] or ("times", "crowd"):
        {"times": times, "crowd": crowd, "gains": gains}[part]()
