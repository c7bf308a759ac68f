# SPDX-License-Identifier: GPL-2.0-only
"""Gain by several executors, forecast before the run: which objects will be near each other, and hence which work can be shared
out.

The objects fly by themselves (gravity, ground, walls, the surface of a liquid; they pass through each other). At some moments the
plan that executors would follow is made, by the same pure functions. No MPI and no LAMMPS: the process that starts executors has
neither.
"""

from __future__ import annotations

import numpy as np

from ..engine.sub_plan import SubPlans
from ..parallel.plan.frame_plan import FrameAssignment, PlanContext, PlannerOptions
from ..records import dataclass
from ..run.prepare import Prepared

AHEAD = 1.0
"""Seconds of the film that are looked at: beyond, what has met decides."""
MOMENTS = 12
"""Moments within them."""
STEP = 0.025
"""Microseconds of a particle-step with all that is in it, of crowds (docs/beyond-one-host.md):
it decides how short windows may be."""


@dataclass(frozen=True, slots=True)
class SpeedupForecast:
    """Expected gain by some executors in the first second of a film, the mean of some moments."""

    executors: int
    seconds: float
    """How far was looked ahead [s]."""
    faster: float
    """All work over what the busiest executor has of it: the most by which they can be faster than one."""
    objects: int
    """Objects that can move."""
    largest: int
    """Objects of these in the heaviest island."""
    share: float
    """Part of the work that is in that island [-]."""
    team: float
    """Executors that run it together."""


def forecast_speedup(ready: Prepared, executors: int, settings: PlannerOptions | None = None) -> SpeedupForecast:
    """Look ahead with that many executors. Nothing is measured: a particle is as dear as any other,
    a liquid costs nothing beside them, and all executors are on one host."""
    moments = _Moments(ready, executors, settings or PlannerOptions(by_threads=True))
    seconds = min(AHEAD, ready.scene.control.time)
    times = np.arange(MOMENTS) * seconds / MOMENTS
    flight = ready.context.reach.flight()
    found = []
    for t in times:
        flight.to(float(t))
        found.append(moments.at(*flight.boxes()))
    busiest = sum(int(best.load.max()) for best in found)
    work = len(found) * int(moments.cost[~moments.still].sum())
    largest, share, team = np.mean([_heaviest(best, moments) for best in found], axis=0).tolist()
    return SpeedupForecast(
        executors,
        seconds,
        work / busiest if busiest else 1.0,
        int((~moments.still[: moments.objects]).sum()),
        round(largest),
        share,
        team,
    )


def _heaviest(found: FrameAssignment, moments: _Moments) -> tuple[int, float, int]:
    """Objects in the heaviest island, its part of the work, and the number of executors that run it together."""
    moving = found.label >= 0
    if not moving.any():
        return 0, 0.0, 1
    work = np.bincount(found.label[moving], moments.cost[moving])
    i = int(work.argmax())
    team = next((len(t.members) for t in found.teams if t.island == i), 1)
    return int((found.label[: moments.objects] == i).sum()), float(work[i] / work.sum()), team


class _Moments:
    """The plans of moments, as `planner.Planner` makes its first."""

    def __init__(self, ready: Prepared, executors: int, settings: PlannerOptions):
        self.context = PlanContext(SubPlans(ready.plan), executors, settings)
        self.objects, self.still = self.context.objects, self.context.still
        self.cost = self.context.guess(STEP)
        self.length = max(ready.plan.certificate.lengths)

    def at(self, low: np.ndarray, high: np.ndarray, speed: np.ndarray) -> FrameAssignment:
        """The plan for objects in these boxes (M, 3) [m] at these speeds (M,) [m/s],
        for the window that leaves loads in balance."""
        context = self.context
        if context.grid is not None:
            low, high, speed = np.vstack([low, context.grid[0]]), np.vstack([high, context.grid[1]]), np.append(speed, 0.0)

        def make(steps: int) -> tuple[FrameAssignment, np.ndarray]:
            d = context.reach(speed, steps)
            return context.plan(low, high, d, self.cost), d

        return context.longest_window(self.length, self.length, make)[1]
