# SPDX-License-Identifier: GPL-2.0-only
"""From what executors report to what they do next. The supervisor has one of these (central control), or every executor (peers)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..engine.part import Parts
from ..errors import DivergedError
from . import islands
from .messages import Job, Order, Report
from .planning import BALANCED, MARGIN, FramePlan, Settings, plan, pool_box
from .source import Broken

FORGET = 0.25
"""Weight of the latest measurement in the cost of an object."""
GUESS = 0.05
"""Microseconds of a particle-step, before anything is measured."""
DOUBLINGS = 60
"""Beyond them a box has no meaning any more: something is flying away."""


class Planner:
    """Boxes, costs and owners of all objects, and of the pool as one more; the same on everybody who plans."""

    def __init__(self, parts: Parts, executors: int, lengths: Sequence[int], settings: Settings, frame: int = 0):
        self.parts, self.executors, self.lengths, self.settings = parts, executors, lengths, settings
        self.frame = frame
        """The last one that is done."""
        self.done = 0
        """Steps on the way from it to the next."""
        self.steps = 0
        """Of the window that executors are at."""
        whole, system = parts.whole, parts.whole.system
        self.objects = len(system.names)
        self.pool = whole.grid is not None
        count = self.objects + self.pool
        self.particles = np.append(np.diff(system.first), [0] * self.pool).astype(np.int64)
        self.still = np.append(system.still, np.zeros(int(self.pool), bool))
        self.contact = any(e.name == "contact" for e in whole.effects)
        self.gap = float(parts.reach.max()) if self.contact else 0.0
        self.low, self.high, self.speed = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
        if self.pool:
            self.low[-1], self.high[-1] = pool_box(parts)
        steps = whole.certificate.steps_per_frame
        self.cost = np.maximum(1, (GUESS * steps * self.particles).astype(np.int64))
        self.measured = np.zeros(count, bool)
        self.doublings = np.zeros(count, np.int64)
        self.plan: FramePlan | None = None
        # Of what is still no report will come.
        self.low[:self.objects], self.high[:self.objects] = system.bounds(system.position)

    def decide(self, reports: Sequence[Report]) -> Order:
        """What to do after a window (or before the first), from the reports of all executors in their order.

        Raises Broken when an object is nowhere any more, DivergedError when executors have followed different plans.
        """
        for report in reports:
            here = np.isfinite(np.column_stack([report.low, report.high, report.speed])).all(axis=1)
            if not here.all():
                raise self._flown(int(report.objects[here.argmin()]))
        if len({r.fingerprint for r in reports}) > 1:
            raise DivergedError("executors have followed different plans: this must never be, please report it")
        escaped = sorted({m for r in reports for m in r.escaped})
        if escaped:
            self.doublings[escaped] += 1
            if self.doublings.max() > DOUBLINGS:
                raise self._flown(int(self.doublings.argmax()))
            return self._order(self.steps, commit=False)
        for report in reports:
            self._take(report)
        self.doublings[:] = 0
        self._advance()
        return self._choose()

    def _flown(self, m: int) -> Broken:
        """For an object that is out of range: the guard tells why."""
        step = sum(self.lengths[:self.frame]) + self.done + self.steps
        return Broken(step, DivergedError("Out of range: it leaves every box that is reserved for it"), m)

    def _advance(self) -> None:
        self.done += self.steps
        if self.frame < len(self.lengths) and self.done == self.lengths[self.frame]:
            self.frame, self.done = self.frame + 1, 0

    def _choose(self) -> Order:
        """The longest window that leaves the loads in balance: in a shorter one boxes are widened by less, and fewer islands merge.

        Windows end at a frame at the latest. Where none is in balance, the one with the smallest largest load.
        """
        length = self.lengths[min(self.frame, len(self.lengths) - 1)]
        left = max(1, length - self.done)  # after the last frame too: its plan is asked for, but not followed
        before, best = self.plan, None
        for halvings in range(self.settings.finest.bit_length()):
            steps = min(left, -(-length >> halvings))
            self.plan = before
            order = self._order(steps, commit=True)
            load, mean = int(order.plan.load.max(initial=0)), int(order.plan.load.sum()) // self.executors
            if best is None or load < best[0]:
                best = load, order
            shorter = mean * (steps // 2) // length
            if self.executors == 1 or steps == 1 or load <= BALANCED * mean and not order.plan.teams or shorter < self.settings.worth:
                break
        self.plan, self.steps = best[1].plan, best[1].steps
        return best[1]

    def _take(self, report: Report) -> None:
        who = report.objects
        self.low[who], self.high[who], self.speed[who] = report.low, report.high, report.speed
        if self.plan is None:
            return
        cost = [report.cost]
        if report.pool_cost is not None:
            who, cost = np.append(who, self.objects), [report.cost, [report.pool_cost]]
        new = np.concatenate(cost).astype(np.int64)
        # Whole numbers only, so that all planners round alike.
        smooth = np.where(self.measured[who], self.cost[who] + ((new - self.cost[who]) * int(256 * FORGET) >> 8), new)
        self.cost[who], self.measured[who] = np.maximum(1, smooth), True

    def reach(self, steps: int) -> np.ndarray:
        """What boxes are widened by in a window of so many steps, eq. (6.17) [m], shape (M,), the pool's last."""
        whole = self.parts.whole
        d = islands.reach(self.speed, steps * whole.certificate.timestep, float(np.linalg.norm(whole.scene.gravity)),
                          MARGIN * whole.spacing, self.settings.safety)
        d = d * 2.0**self.doublings
        d[self.still] = 0.0
        if self.pool:
            d[-1] = 0.0
        return d

    def _order(self, steps: int, commit: bool) -> Order:
        owner = self.plan.owner if self.plan else np.full(len(self.cost), -1, np.int64)
        d = self.reach(steps)
        self.plan = plan(self.low, self.high, d, self.cost, owner, self.executors, particles=self.particles, still=self.still,
                         gap=self.gap, feels=None if self.contact else np.arange(len(self.cost)) == self.objects, previous=self.plan,
                         least=self.settings.least)
        return Order(self.plan, *islands.boxes(self.low, self.high, d), steps, commit)


def planner_of(job: Job, parts: Parts, executors: int) -> Planner:
    """The planner with which a job begins, or goes on."""
    return Planner(parts, executors, job.lengths, job.settings, job.resume.frame if job.resume else 0)
