# SPDX-License-Identifier: GPL-2.0-only
"""The cheapest setting whose error meets a target, and the words of the language for it."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from ..effects.varied import varied
from ..errors import DivergedError, UsageError
from ..records import dataclass
from ..run.prepare import prepare
from ..scene.formatting import number, say
from ..scene.scene import Accuracy, SceneRecord
from .analysis import Analysis, analyse
from .bench import BUDGET, Bench
from .error import ROUND_OFF, distance, extent
from .measure import TooLong
from .setting import Ladder, Setting, finer, own_setting, same_frames, scene_hash, thinnest, values
from .store import Store

START = (2, 3, 4)
"""Cells across of the first runs: three is the smallest number that shows an order."""
TIME_SHARE = 0.25
"""Share of the target that the time step may use up; what is left is for the resolution, which costs far more."""
LARGEST_NEXT = 0.9
"""A coarser setting is only tried when it would be this much coarser: what is left untried costs two thirds at least, and half
with the longest step of all."""
MARGIN = 0.97
"""Aim a little below the target: the estimate of an error is as accurate as the limit to which it is relative."""
HOPE = 1.05
"""A coarser setting is tried when its predicted error is below this multiple of the target:
between two runs a prediction is as accurate as that."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A setting that was found for a target error."""

    error: float
    """The target, a fraction."""
    setting: Setting
    timestep: float | None
    """[s]; None where nothing vibrates."""
    words: str
    """Settings to write into the scene's ``control``, in place of its accuracy."""
    reached: float
    """Estimated error of this setting, a fraction."""
    doubt: float
    """How far the limit that the estimate is relative to may be off, a fraction."""
    closed: float | None
    """Largest error against the closed forms of the scene, a fraction; None without any."""
    seconds: float
    """Wall time of simulation [s]."""

    @property
    def cells(self) -> float:
        """Across the thinnest part."""
        return self.setting.cells

    @property
    def fraction(self) -> float:
        """Time step over the certified bound; 0 where nothing vibrates."""
        return self.setting.fraction

    @property
    def met(self) -> bool:
        """Whether the target is met."""
        return max(self.reached, self.closed or 0.0) <= self.error

    def __str__(self) -> str:
        doubt = f" ± {number(100 * self.doubt, 1)}" if self.doubt > 0.01 * self.reached else ""
        got = f"estimated {number(100 * self.reached, 2)}{doubt} %" + (
            "" if (self.closed or 0.0) < ROUND_OFF else f", off its expect by {number(100 * self.closed, 2)} %"
        )
        step = f", time step {say(self.timestep, 's')}" if self.timestep else ""
        more = "".join(v.told(value, number) for v, value in values(self.setting))
        return f"{self.cells:g} cells across{step}{more} ({got})"


def find_choice(
    scene: SceneRecord,
    error: float,
    *,
    budget: float = BUDGET,
    folder: Path | None = None,
    force: bool = False,
    on_progress: Callable[[str], None] = lambda line: None,
) -> Choice:
    """Measure until a setting meets a target error, or the budget is spent.

    The resolution is refined from 2 cells on, and with it what the scene does not say, as contact where objects touch
    (`setting.finer`); each next number of cells follows from the order seen so far. The time step is
    the largest one of the accuracy classes whose own error stays below a quarter of the target. A resolution or a time step that
    the scene says stays, and its accuracy does not count. The error is that of docs/accuracy.md, and where the scene states
    closed forms at least as sharp as the target, these must be met too.

    Args:
        scene: with a resolution or a time step to choose.
        error: the target, a fraction.
        budget: wall time [s].
        folder: of a study of this scene, whose points are used again; None measures in a temporary folder.
        force: throw away the study of another scene in this folder.
        on_progress: called with each line of progress.

    Raises UsageError for a scene with nothing to choose and an error that is not between 0 and 1, DivergedError when no setting
    could be found, and what measuring raises.
    """
    if not 0.0 < error < 1.0:
        raise UsageError(f"a target error is between 0 and 100 %, found {100 * error:g} %")
    if own := next((s.name for s in scene.solids if s.resolution is not None), None):
        raise UsageError(f"object {own} says a resolution of its own, and a target chooses one for all; leave it out")
    if None not in (scene.control.resolution, scene.control.timestep):
        raise UsageError("the scene says both resolution and timestep, so a target has nothing to choose; leave one of them out")
    scene = same_frames(scene)
    if folder is not None:
        return _Search(scene, error, Store(folder, scene_hash(scene), force=force), budget, on_progress).go()
    with tempfile.TemporaryDirectory(prefix="mdanim-") as temporary:
        return _Search(scene, error, Store(Path(temporary), scene_hash(scene)), budget, on_progress).go()


class _Search:
    """Goes down one ladder, of resolutions or, where the scene fixes those, of time steps, until the target is met."""

    def __init__(self, scene: SceneRecord, error: float, store: Store, budget: float, on_progress: Callable[[str], None]):
        scene = replace(scene, control=replace(scene.control, accuracy=Accuracy.BALANCED))
        self.scene, self.store, self.target = scene, store, error
        self.ready = prepare(scene)
        self.own = own_setting(scene, self.ready)
        self.bench = Bench(scene, self.ready, self.own, store, budget, on_progress)
        self.name = "resolution" if scene.control.resolution is None else "time step"
        self.along = [v for v in varied() if v.finer_is and not v.said(scene) and not v.why_not(self.ready.context)]
        self.step_error = 0.0  # of the time step at START[0] cells, relative to the extent

    def go(self) -> Choice:
        done = [s for s in self._first() if self._run(s)]
        while len(done) > 1 and (setting := self._next(self._analyse(done), done)) is not None and self._run(setting):
            done.append(setting)
        if len(done) < 2:
            problem = next((p.problem for p in self.store.points.values() if p.problem), "the budget was too small for two runs")
            raise DivergedError(f"no setting for an error of {100 * self.target:g} % could be found: {problem}")
        a = self._analyse(done)
        meeting = [s for s in done if self._error(a, s) <= self.target]
        # By particle-steps: the seconds of short runs differ by less than they vary.
        best = min(meeting, key=lambda s: a.rated[s.key].point.work) if meeting else min(done, key=lambda s: self._error(a, s))
        point = a.rated[best.key].point
        return Choice(
            self.target,
            best,
            point.timestep if best.fraction else None,
            self._words(best),
            self._estimated(a, best),
            a.doubt,
            a.rated[best.key].closed,
            a.rated[best.key].seconds.middle,
        )

    def _words(self, setting: Setting) -> str:
        """Words that the scene needs for a setting. A resolution is rounded down, to as many cells; a time step up, as the scene
        takes the longest one below it that fits its frames."""
        control, words = self.scene.control, []
        fraction = {a.fraction: a.value for a in Accuracy}.get(setting.fraction)
        if setting.fraction and control.timestep is None:
            step = self.store.points[setting.key].timestep
            words.append(f"accuracy {fraction}" if fraction else f"timestep {_rounded(step, 's', 5, up=True)}")
        if control.resolution is None:
            words.append(f"resolution {_rounded(thinnest(self.scene) / setting.cells, 'm', 4, up=False)}")
        words += [f"{v.word} {number(value, 6)}" for v, value in values(setting) if value != v.of(self.scene)]
        return "  ".join(words)

    def _first(self) -> list[Setting]:
        """The settings that are measured in any case."""
        if not self.own.fraction:
            return [self._with(self.own, n) for n in START]
        if self.name == "time step":
            return [replace(self.own, fraction=Accuracy.PREVIEW.fraction / x) for x in (1.0, 2.0**0.5, 2.0)]
        fraction = self._fraction() if self.scene.control.timestep is None else self.own.fraction
        return [self._with(replace(self.own, fraction=fraction), n) for n in START]

    def _with(self, setting: Setting, cells: float) -> Setting:
        """A setting with other cells across, and what goes with them."""
        return finer(setting, cells, self.along)

    def _fraction(self) -> float:
        """The largest time step of the accuracy classes whose error takes no more than its share of the target.

        Measured with few cells, by a run with half the step: at second order the error of the longer one is 4/3 of the
        difference. With more cells the step, and its error, are smaller.
        """
        longest = Accuracy.PREVIEW.fraction
        long, short = (replace(self._with(self.own, START[0]), fraction=f) for f in (longest, longest / 2.0))
        if not (self._run(long) and self._run(short)):
            return Accuracy.REFERENCE.fraction
        a, b = (self.store.points[s.key].tracks[0] for s in (long, short))
        off = 4.0 / 3.0 * distance(a, b) / extent(b) if extent(b) else 0.0
        fractions = [f for c in Accuracy if off * ((f := c.fraction) / longest) ** 2 <= TIME_SHARE * self.target]
        chosen = max(fractions, default=Accuracy.REFERENCE.fraction)
        self.step_error = off * (chosen / longest) ** 2
        return chosen

    def _from_step(self, setting: Setting) -> float:
        """Error that the time step adds: with the spacing, the step shrinks, and its error with the square."""
        return self.step_error * (START[0] / setting.cells) ** 2

    def _next(self, a: Analysis, done: list[Setting]) -> Setting | None:
        """The setting to measure next; None when the cheapest that meets the target is found, as near as makes sense."""
        known = sorted(done, key=self._value)
        failing = [s for s in known if self._error(a, s) > self.target]
        meeting = next((s for s in known if s not in failing), None)
        if meeting is None:
            # Never more than twice as fine in one step: finer settings are known only by extrapolation.
            finest, order = self._value(known[-1]), a.ladders[self.name].order or 2.0
            needed = finest * (self._error(a, known[-1]) / (MARGIN * self.target)) ** (1.0 / order)
            value = min(max(self._round(needed), self._round(1.01 * finest)), 2.0 * finest)
        else:
            coarser = [s for s in failing if self._value(s) < self._value(meeting)]
            if not coarser:
                return None
            value = self._between(a, coarser[-1], meeting)
            if value > LARGEST_NEXT * self._value(meeting):
                return None
        return self._with(known[-1], value) if self.name == "resolution" else replace(known[-1], fraction=1.0 / value)

    def _between(self, a: Analysis, failing: Setting, meeting: Setting) -> float:
        """The coarsest value between two settings whose predicted error meets the target, by the power law through both."""
        low, high = self._value(failing), self._value(meeting)
        bad, good = self._error(a, failing), self._error(a, meeting)
        slope = math.log(bad / good) / math.log(high / low) if good > 0.0 else math.inf
        needed = high * (good / (HOPE * self.target)) ** (1.0 / slope) if good > 0.0 else low
        return max(self._round(needed), self._round(1.01 * low))

    def _value(self, setting: Setting) -> float:
        """The quantity that grows as the setting gets finer: cells across, or steps per bound."""
        return setting.cells if self.name == "resolution" else 1.0 / setting.fraction

    def _round(self, value: float) -> float:
        """Up to whole cells."""
        return float(math.ceil(value)) if self.name == "resolution" else value

    def _error(self, a: Analysis, setting: Setting) -> float:
        """Error that counts against the target."""
        return max(self._estimated(a, setting), a.rated[setting.key].closed or 0.0)

    def _estimated(self, a: Analysis, setting: Setting) -> float:
        """Distance from the limit; where runs have no order, with how far the limit may be off, so that finer ones are made."""
        rated = a.rated[setting.key]
        error = rated.error.middle if a.ladders[self.name].order is not None else a.off(rated)
        return error + self._from_step(setting)

    def _analyse(self, done: list[Setting]) -> Analysis:
        settings = tuple(sorted(done, key=self._value))
        return analyse(
            {s.key: self.store.points[s.key] for s in done},
            [Ladder(self.name, settings)],
            settings[-1],
            self.store.times,
            self.scene.expects,
            self.ready.system.names,
            sharpness=self.target,
        )

    def _run(self, setting: Setting) -> bool:
        """Measure a setting that is not measured yet; whether the setting is measured now."""
        if self.bench.has(setting):
            return True
        expected = self.bench.predict(setting)
        if expected is not None and expected > self.bench.left:
            self.bench.on_progress(
                f"{setting} would take about {say(expected, 's', 2)}, more than the {max(0.0, self.bench.left):.0f} s left"
            )
            return False
        try:
            return bool(self.bench.measure(setting, limit=max(self.bench.left, 1.0)).tracks)
        except TooLong:
            return False


def _rounded(x: float, unit: str, digits: int, *, up: bool) -> str:
    """A positive quantity with ``digits`` digits, rounded up or down."""
    digit = 10.0 ** (math.floor(math.log10(x)) + 1 - digits)
    return say(digit * (math.ceil(x / digit - 1e-6) if up else math.floor(x / digit + 1e-6)), unit, digits)
