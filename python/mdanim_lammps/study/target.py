# SPDX-License-Identifier: GPL-2.0-only
"""``accuracy error p %``: the cheapest setting that meets a target, found once and stored beside the scene."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from ..errors import DivergedError, OutputError, Problem
from ..results.files import read_json, write_json
from ..results.stored import CHOICE, STUDY
from ..run.prepare import prepare
from ..scene.formatting import number, say
from ..scene.scene import Accuracy, SceneRecord
from .analysis import Analysis, analyse
from .bench import BUDGET, Bench
from .error import ROUND_OFF, distance, extent
from .measure import TooLong
from .setting import TOUCHING, Ladder, Setting, finer, own_setting, scene_hash, thinnest
from .store import FILE, Store

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
    """A setting that was found for a target."""

    error: float
    """The target, a fraction."""
    cells: float
    fraction: float
    contact: float
    """``contact-stiffness``."""
    resolution: float
    """[m]"""
    timestep: float | None
    """[s]; None where nothing vibrates."""
    reached: float
    """Estimated error of this setting, a fraction."""
    doubt: float
    """How far the limit that the estimate is relative to may be off, a fraction."""
    closed: float | None
    """Largest error against the closed forms of the scene, a fraction; None without any."""
    seconds: float
    """Wall time of simulation [s]."""

    @property
    def met(self) -> bool:
        """Whether the target is met."""
        return max(self.reached, self.closed or 0.0) <= self.error

    def __str__(self) -> str:
        doubt = f" ± {number(100 * self.doubt, 1)}" if self.doubt > 0.01 * self.reached else ""
        got = f"estimated {number(100 * self.reached, 2)}{doubt} %" + (
            "" if (self.closed or 0.0) < ROUND_OFF else f", closed form {number(100 * self.closed, 2)} %"
        )
        step = f", time step {say(self.timestep, 's')}" if self.timestep else ""
        contact = f", contact-stiffness {number(self.contact)}" if self.contact != 1.0 else ""
        return f"{self.cells:g} cells across{step}{contact} ({got})"


def wanted(scene: SceneRecord) -> bool:
    """Whether a scene names a target and leaves a setting to choose."""
    control = scene.control
    return not isinstance(control.accuracy, Accuracy) and None in (control.resolution, control.timestep)


def choice_file(scene: SceneRecord) -> Path | None:
    """``SCENE.accuracy.json`` beside the scene; None for a scene without a file."""
    return scene.path and scene.path.with_name(f"{scene.name}.accuracy.json")


def stored_choice(scene: SceneRecord) -> Choice | None:
    """The choice beside the scene, when it is for this scene and this target. Raises OutputError for a broken file."""
    path = choice_file(scene)
    if path is None or not path.exists():
        return None
    try:
        data = read_json(path, CHOICE)
    except OutputError as error:
        raise OutputError(f"{path} is not a stored accuracy: delete it, and the next run makes a new one\n  {error}") from error
    choice = Choice(**data["choice"])
    return choice if data["scene"] == _digest(scene) and choice.error == scene.control.accuracy else None


def store_choice(scene: SceneRecord, choice: Choice) -> None:
    """Write the choice beside the scene. Raises OutputError."""
    if (path := choice_file(scene)) is not None:
        write_json(path, {"scene": _digest(scene), "choice": asdict(choice), "met": choice.met})


def with_choice(scene: SceneRecord, choice: Choice) -> SceneRecord:
    """The scene with the setting of a choice; what the scene itself says about resolution and time step stays."""
    c = scene.control
    return replace(
        scene,
        control=replace(
            c,
            resolution=c.resolution if c.resolution is not None else choice.resolution,
            timestep=c.timestep if c.timestep is not None else choice.timestep,
            contact_stiffness=choice.contact,
        ),
    )


def _digest(scene: SceneRecord) -> str:
    """The scene's hash without its accuracy line; a resolution or time step that it fixes and its contact stiffness count."""
    c = scene.control
    return f"{scene_hash(scene)} {c.resolution!r} {c.timestep!r} {c.contact_stiffness!r}"


def find_choice(
    scene: SceneRecord,
    *,
    budget: float = BUDGET,
    store: Store | None = None,
    on_progress: Callable[[str], None] = lambda line: None,
) -> Choice:
    """Measure until a setting meets the target of ``accuracy error p %``, or the budget is spent.

    The resolution is refined from 2 cells on, and contact gets stiffer with it where objects touch and the scene does not say how
    stiff it is (`setting.finer`); each next number of cells follows from the order seen so far. The time step is
    the largest one of the accuracy classes whose own error stays below a quarter of the target. The error is that of
    docs/accuracy.md, and where the scene states closed forms at least as sharp as the target, these must be met too.

    Args:
        scene: with a target.
        budget: wall time [s].
        store: a study of this scene whose points are used again; None measures in a temporary folder.
        on_progress: called with each line of progress.

    Raises DivergedError when no setting could be found, and what measuring raises.
    """
    if store is not None:
        return _Search(scene, store, budget, on_progress).go()
    with tempfile.TemporaryDirectory(prefix="mdanim-") as temporary:
        return _Search(scene, Store(Path(temporary), scene_hash(scene)), budget, on_progress).go()


@dataclass(frozen=True, slots=True)
class Settled:
    """A scene whose target, if it has one, has become a setting."""

    scene: SceneRecord
    line: str = ""
    """Where the setting comes from; empty for a scene without a target."""
    warning: Problem | None = None
    """That the target is not met, or has not been looked for yet."""


def settle(
    scene: SceneRecord,
    *,
    make: bool,
    budget: float = BUDGET,
    study: Path | None = None,
    on_progress: Callable[[str], None] = lambda line: None,
) -> Settled:
    """Turn ``accuracy error p %`` into a setting: the one stored beside the scene, or, with ``make``, one found now.

    Without either the scene stays as it is, and counts as ``balanced``. ``study`` is the folder of a study whose points are
    used where they are of this scene.
    """
    if not wanted(scene):
        return Settled(scene)
    what, path = f"error {100 * scene.control.accuracy:g} %", choice_file(scene)
    span = scene.control.spans.get("accuracy")
    choice, source = stored_choice(scene), f"from {path.name}" if path else "found now"
    if choice is None:
        if not make:
            told = f"accuracy {what}: no setting is known yet; 'run' looks for one first, for {budget:.0f} s at most"
            return Settled(
                scene,
                told,
                Problem(
                    span,
                    f"the setting for {what} is not known yet; 'balanced' is shown",
                    f"mdanim-lammps study {scene.path or scene.name}",
                    severity="warning",
                ),
            )
        known = study and (study / FILE).exists() and read_json(study / FILE, STUDY).get("hash") == scene_hash(scene)
        choice = find_choice(
            scene, budget=budget, store=Store(study, scene_hash(scene)) if known else None, on_progress=on_progress
        )
        store_choice(scene, choice)
        source = f"found now, kept in {path.name}" if path else "found now"
    warning = (
        None
        if choice.met
        else Problem(
            span,
            f"{what} is not reached: the best that was found in the time given is {choice}",
            "give it more time with 'mdanim-lammps study SCENE --budget \"10 min\"', or ask for less",
            severity="warning",
        )
    )
    return Settled(with_choice(scene, choice), f"accuracy {what}: {choice}, {source}", warning)


class _Search:
    """Goes down one ladder, of resolutions or, where the scene fixes those, of time steps, until the target is met."""

    def __init__(self, scene: SceneRecord, store: Store, budget: float, on_progress: Callable[[str], None]):
        self.scene, self.store, self.target = scene, store, scene.control.accuracy
        self.ready = prepare(scene)
        self.own = own_setting(scene, self.ready)
        self.bench = Bench(scene, self.ready, self.own, store, budget, on_progress)
        self.name = "resolution" if scene.control.resolution is None else "time step"
        said = self.own.contact != 1.0 or "contact-stiffness" in scene.control.spans
        self.stiffens = not said and any(self.ready.verdicts[name].on for name in TOUCHING)
        self.step_error = 0.0  # of the time step at START[0] cells, relative to the extent

    def go(self) -> Choice:
        done = [s for s in self._first() if self._run(s)]
        while len(done) > 1 and (setting := self._next(self._analyse(done), done)) is not None and self._run(setting):
            done.append(setting)
        if len(done) < 2:
            problem = next((p.problem for p in self.store.points.values() if p.problem), "the budget was too small for two runs")
            raise DivergedError(f"accuracy error {100 * self.target:g} %: no setting could be found: {problem}")
        a = self._analyse(done)
        meeting = [s for s in done if self._error(a, s) <= self.target]
        # By particle-steps: the seconds of short runs differ by less than they vary.
        best = min(meeting, key=lambda s: a.rated[s.key].point.work) if meeting else min(done, key=lambda s: self._error(a, s))
        point = a.rated[best.key].point
        return Choice(
            self.target,
            best.cells,
            best.fraction,
            best.contact,
            thinnest(self.scene) / best.cells,
            point.timestep if best.fraction else None,
            self._estimated(a, best),
            a.doubt,
            a.rated[best.key].closed,
            a.rated[best.key].seconds.middle,
        )

    def _first(self) -> list[Setting]:
        """The settings that are measured in any case."""
        if not self.own.fraction:
            return [self._with(self.own, n) for n in START]
        if self.name == "time step":
            return [replace(self.own, fraction=Accuracy.PREVIEW.fraction / x) for x in (1.0, 2.0**0.5, 2.0)]
        fraction = self._fraction() if self.scene.control.timestep is None else self.own.fraction
        return [self._with(replace(self.own, fraction=fraction), n) for n in START]

    def _with(self, setting: Setting, cells: float) -> Setting:
        """A setting with other cells across, and contact as stiff as goes with them."""
        return finer(setting, cells) if self.stiffens else replace(setting, cells=cells)

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
        point = self.store.points.get(setting.key)
        if point and point.tracks:
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
