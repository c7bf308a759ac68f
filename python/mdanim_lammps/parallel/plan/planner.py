# SPDX-License-Identifier: GPL-2.0-only
"""From what executors report to what they do next. The supervisor has one of these (central control), or
every executor (peers).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...engine.sub_plan import SubPlans
from ...errors import DivergedError
from ...run.frame_source import LammpsFailure
from . import islands
from .frame_plan import FrameAssignment, PlanContext, PlannerOptions
from .orders import Order, Report

WEIGHT_OF_LATEST = 0.25
"""Weight of the latest measurement in the cost of an object."""
GUESSED_COST = 0.05
"""Microseconds of a particle-step, before anything is measured."""
DOUBLINGS = 60
"""Beyond them a box has no meaning any more: something is flying away."""


class Planner:
    """Boxes, costs and owners of all objects, and of the pool as one more; the same in every process that plans."""

    def __init__(self, parts: SubPlans, executors: int, lengths: Sequence[int], settings: PlannerOptions, frame: int = 0):
        self.lengths, self.frame = lengths, frame
        """The last one that is done."""
        self.done = 0
        """Steps on the way from it to the next."""
        self.steps = 0
        """Steps of the present window of executors."""
        self.context = PlanContext(parts, executors, settings)
        self.objects = self.context.objects
        count = self.context.count
        self.low, self.high, self.speed = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
        if self.context.grid is not None:
            self.low[-1], self.high[-1] = self.context.grid
        self.cost = self.context.guess(GUESSED_COST)
        self.measured = np.zeros(count, bool)
        self.doublings = np.zeros(count, np.int64)
        self.plan: FrameAssignment | None = None
        # No report will come about objects that never move.
        self.low[: self.objects], self.high[: self.objects] = parts.whole.system.bounds(parts.whole.system.position)

    def decide(self, reports: Sequence[Report]) -> Order:
        """The order after a window (or before the first), from the reports of all executors in their order.

        Raises LammpsFailure when an object is nowhere any more, DivergedError when executors have followed different plans.
        """
        for report in reports:
            here = np.isfinite(np.column_stack([report.low, report.high, report.speed])).all(axis=1)
            if not here.all():
                raise self._flown(int(report.objects[here.argmin()]))
        if len({r.fingerprint for r in reports}) > 1:
            raise DivergedError("internal error: executors followed different plans; please report it")
        escaped = sorted({m for r in reports for m in r.escaped})
        if escaped:
            self.doublings[escaped] += 1
            if self.doublings.max() > DOUBLINGS:
                raise self._flown(int(self.doublings.argmax()))
            return self._order(self.steps, *self._make(self.steps), commit=False)
        for report in reports:
            self._take(report)
        self.doublings[:] = 0
        self._advance()
        return self._choose()

    def _flown(self, m: int) -> LammpsFailure:
        """For an object that is out of range: the guard tells why."""
        step = sum(self.lengths[: self.frame]) + self.done + self.steps
        return LammpsFailure(step, DivergedError("Out of range: it leaves every box that is reserved for it"), m)

    def _advance(self) -> None:
        self.done += self.steps
        if self.frame < len(self.lengths) and self.done == self.lengths[self.frame]:
            self.frame, self.done = self.frame + 1, 0

    def _choose(self) -> Order:
        """The next window."""
        length = self.lengths[min(self.frame, len(self.lengths) - 1)]
        left = max(1, length - self.done)  # after the last frame too: its plan is asked for, but not followed
        return self._order(*self.context.longest_window(length, left, self._make), commit=True)

    def _take(self, report: Report) -> None:
        ids = report.objects
        self.low[ids], self.high[ids], self.speed[ids] = report.low, report.high, report.speed
        if self.plan is None:
            return
        cost = report.cost
        if report.grid_cost is not None:
            ids, cost = np.append(ids, self.objects), np.append(cost, report.grid_cost)
        new = cost.astype(np.int64)
        # Whole numbers only, so that all planners round alike.
        smooth = np.where(self.measured[ids], self.cost[ids] + ((new - self.cost[ids]) * int(256 * WEIGHT_OF_LATEST) >> 8), new)
        self.cost[ids], self.measured[ids] = np.maximum(1, smooth), True

    def reach(self, steps: int) -> np.ndarray:
        """The margin by which boxes are widened in a window of ``steps`` steps, eq. (6.17) [m], shape (M,), the pool's last."""
        return self.context.reach(self.speed, steps, self.doublings)

    def _make(self, steps: int) -> tuple[FrameAssignment, np.ndarray]:
        d = self.reach(steps)
        return self.context.plan(self.low, self.high, d, self.cost, self.plan), d

    def _order(self, steps: int, plan: FrameAssignment, d: np.ndarray, commit: bool) -> Order:
        self.plan, self.steps = plan, steps
        return Order(plan, *islands.boxes(self.low, self.high, d), steps, commit)
