# SPDX-License-Identifier: GPL-2.0-only
"""Measures settings of one scene under a budget: the cost of a run, the next run, the settings that were left out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

from ..errors import DivergedError, RefusedError, SceneError
from ..run.loop import Interrupted
from ..run.prepare import Prepared
from ..scene.formatting import say
from ..scene.scene import SceneRecord
from .measure import Sample, TooLong, measure
from .setting import Setting, values
from .store import Point, Store

BUDGET = 120.0
"""Wall time of a study [s]."""
REPEATS = 3
"""Runs of a point, if the budget allows: the smallest number with a median."""
FOR_REPEATS = 0.2
"""Share of the budget that new points leave for repeats: without a spread there is no ranking."""


class Bench:
    """Measures settings of one scene, cheapest first, until a budget is spent."""

    def __init__(
        self, scene: SceneRecord, ready: Prepared, own: Setting, store: Store, budget: float, on_progress: Callable[[str], None]
    ):
        self.scene, self.ready, self.own, self.store, self.on_progress = scene, ready, own, store, on_progress
        self.budget, self.start = budget, time.perf_counter()

    @property
    def left(self) -> float:
        """Seconds of the budget that are left."""
        return self.budget - (time.perf_counter() - self.start)

    def predict(self, setting: Setting) -> float | None:
        """Wall seconds that a run of this setting will take, from the measured point nearest in work; None before any.

        Only the simulation grows with the work; what comes before and after it takes about as long for every setting.
        """
        known = [p for p in self.store.points.values() if p.wall]
        if not known:
            return None
        work = self._work(setting)
        near = min(known, key=lambda p: abs(math.log(self._work(p.setting) / work)))
        whole = min(near.wall)
        simulation = min(whole, *near.seconds)
        return whole - simulation + simulation * work / self._work(near.setting)

    def _work(self, setting: Setting) -> float:
        """Particle-steps over those of the scene's own setting: particles go with cells^3, steps with cells over the fraction.

        Stiffer contact shortens the step where it is part of the bound.
        """
        steps = (self.own.fraction or 1.0) / (setting.fraction or 1.0) * (setting.cells / self.own.cells)
        for (v, value), (_, own) in zip(values(setting), values(self.own)):
            steps *= math.sqrt(v.stiffness(value) / v.stiffness(own))
        return steps * (setting.cells / self.own.cells) ** 3

    def measure_all(self, wanted: Sequence[Setting], first: Sequence[Setting] = ()) -> dict[Setting, str]:
        """Measure what is not measured yet, then repeat; returns what was left out and why.

        ``first`` are settings of which the limit is made that all others are compared with: these are measured before others.
        """
        left = {}
        for setting in sorted(wanted, key=lambda s: (s not in first, self._work(s))):
            if self.has(setting):
                continue
            # All others are compared with the scene's own setting: time is reserved for that setting, and for repeats.
            waiting = setting != self.own and not self.has(self.own)
            room = FOR_REPEATS * self.budget + ((self.predict(self.own) or 0.0) if waiting else 0.0)
            share = self.left if setting == self.own else self.left - room
            expected = self.predict(setting)
            if expected is not None and expected > share:
                left[setting] = f"would take about {say(expected, 's', 2)}, more than is left of the budget"
                continue
            try:
                self.measure(setting, limit=max(share, 1.0))
            except TooLong as stopped:
                left[setting] = f"{stopped}, more than is left of the budget"
        self._repeat(wanted)
        return left | {s: p.problem for s in wanted if (p := self.store.points.get(s.key)) and p.problem}

    def has(self, setting: Setting) -> bool:
        """Whether a setting has been measured."""
        point = self.store.points.get(setting.key)
        return bool(point and point.tracks)

    def _repeat(self, wanted: Sequence[Setting]) -> None:
        """Run points again, cheapest first, round after round, as long as they fit."""
        points = [p for s in wanted if (p := self.store.points.get(s.key)) and p.tracks]
        for runs in range(1, REPEATS):
            for point in sorted(points, key=lambda p: min(p.wall)):
                if len(point.seconds) <= runs and max(point.wall) <= self.left:
                    try:
                        self.measure(point.setting, limit=max(2.0 * self.left, 1.0))
                    except TooLong:
                        continue

    def measure(self, setting: Setting, *, limit: float = math.inf) -> Point:
        """Run one setting once more and store it. Raises TooLong, and Interrupted with the way to go on."""
        point = self.store.points.get(setting.key)
        repeat = len(point.seconds) if point else 0
        expected = self.predict(setting)
        guess = f"about {say(expected, 's', 2)}" if expected is not None else "the first"
        self.on_progress(
            f"{setting}{f', run {repeat + 1}' if repeat else ''}: {guess}; {max(0.0, self.left):.0f} s of the budget left"
        )
        try:
            sample: Sample = measure(self.scene, setting, self.store.folder, limit=limit, repeat=repeat)
        except (SceneError, RefusedError, DivergedError) as error:
            problem = error.problems[0].message if isinstance(error, SceneError) else str(error).splitlines()[0]
            self.store.fail(setting, problem)
            return self.store.points[setting.key]
        except (Interrupted, KeyboardInterrupt) as error:
            raise Interrupted(
                f"interrupted; {len(self.store.points)} points are kept in {self.store.folder}, the same command continues"
            ) from error
        return self.store.add(sample)
