# SPDX-License-Identifier: GPL-2.0-only
"""A scene: load it, ask what it calls for, run it."""

from __future__ import annotations

import itertools
import math
import re
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from types import NoneType
from typing import overload

import numpy as np

from ..certificate import Certificate
from ..children import Workers
from ..deprecated import OnceMethod, warn
from ..engine.threads import THREADS, asked_threads
from ..errors import MdanimError, UsageError
from ..model.spacing import scaled
from ..picture.marks import Marks
from ..processes import cores
from ..results.html import THUMBNAIL, CellPicture, html_table
from ..run.folder import STUDY, default_folder, open_run, output_folder
from ..run.loop import Progress, simulate, write_start
from ..run.prepare import Prepared, prepare
from ..scene.formatting import say
from ..scene.keywords import Named
from ..scene.lammps_lines import check_alone
from ..scene.parse import load_scene, parse_scene
from ..scene.scene import Accuracy, Save, SceneRecord
from ..study.bench import BUDGET
from ..study.study import Study, run_study
from ..study.target import Choice, find_choice
from ..terminal import progress_bar
from .run import Run, quiet_unless


class Effects(Named, OnceMethod):
    """Verdicts by the names of effects."""


class Scene:
    """A scene that was read and found valid.

    Args:
        record: the scene as plain frozen records in SI units.
        read: reads the scene again with values of its ``let`` names; None where it is not from a text.
        values: those that it was read with.
    """

    def __init__(
        self, record: SceneRecord, read: Callable[..., SceneRecord] | None = None, values: Mapping[str, float | str] | None = None
    ):
        self.record, self._read, self.values = record, read, dict(values or {})

    @classmethod
    def load(cls, path: str | Path, *, strict: bool = False, trust: bool = False, **overrides: float | str) -> Scene:
        """Read a scene file; keyword arguments override its ``let`` names, as ``--set`` does. Names that are words of this method
        too are given to `where`. ``trust`` lets the commands for LAMMPS that the scene has be run, as ``--trust`` does.

        Raises SceneError with all problems in ``.problems``, UsageError for ``strict`` or ``trust`` that is not True or False.
        """
        check_flags(strict=strict, trust=trust)
        read = partial(load_scene, path, strict=strict, trust=trust)
        return cls(read(overrides=overrides), read, overrides)

    @classmethod
    def from_text(
        cls,
        text: str,
        name: str = "scene",
        *,
        folder: str | Path | None = None,
        strict: bool = False,
        trust: bool = False,
        **overrides: float | str,
    ) -> Scene:
        """Read a scene from a text.

        Args:
            text: as a scene file has it.
            name: of the scene and of its output folder.
            folder: where its includes and meshes are; None is the current folder.
            strict: refuse numbers that have a dimension but no unit.
            trust: let its commands for LAMMPS be run.
            overrides: values of its ``let`` names, such as ``h=0.5`` or ``h="50 cm"``. Names that are words of this method too
                are given to `where`.

        Raises SceneError with all problems in ``.problems``, UsageError for ``strict`` or ``trust`` that is not True or False.
        """
        check_flags(strict=strict, trust=trust)
        read = partial(parse_scene, text, name, strict=strict, folder=folder, trust=trust)
        return cls(read(overrides=overrides), read, overrides)

    def where(self, values: Mapping[str, float | str] | None = None, /, **named: float | str) -> Scene:
        """The same scene with other values of its ``let`` names, such as ``h=0.5``, or ``{"h": 0.5}``, which any name can have.

        Raises SceneError with all problems, UsageError for a scene that was not read from a text.
        """
        if self._read is None:
            raise UsageError("this Scene was made of records; only one that was read by Scene.load or Scene.from_text has names")
        together = self.values | together_of(values or {}, named)
        return Scene(self._read(overrides=together), self._read, together)

    @cached_property
    def prepared(self) -> Prepared:
        """Models, effects, certificate and LAMMPS plan. Raises SceneError, RefusedError."""
        return prepare(self.record)

    @property
    def effects(self) -> Effects:
        """Every effect with whether it is on, and why; a KeyError suggests a name. Raises SceneError, RefusedError."""
        return Effects("effect", self.prepared.verdicts)

    @property
    def certificate(self) -> Certificate:
        """The certified time step and what sets it. Raises SceneError, RefusedError."""
        return self.prepared.certificate

    def run(
        self,
        folder: str | Path | None = None,
        *,
        executors: int = 1,
        threads: int | None = None,
        control: str | None = None,
        force: bool = False,
        movie: bool = False,
        progress: bool | None = None,
        on_progress: Callable[[Progress], None] | None = None,
    ) -> Run:
        """Simulate into ``folder`` (default: ``NAME.out`` beside the scene); returns the `Run`.

        On several ``executors``, ``control`` is ``central`` (the default) or ``peers``: the frames are the same to the last bit.
        So they are for any number of ``threads``; unless told, a process has as many as pay of all cores divided by executors.
        A warning names the effects that threads which were asked for do not share.
        ``progress`` shows a bar, by default in a notebook only; ``on_progress`` is called with a Progress after every frame.
        Raises SceneError, RefusedError, DivergedError, OutputError, and UsageError for a flag that is not True or False.
        """
        check_flags(force=force, movie=movie, progress=progress)
        started = time.perf_counter()
        check_alone(self.record, executors, control)
        ready = self.prepared
        options = {"executors": executors, "threads": threads, "control": control, "started": started}
        with open_run(ready, folder, force=force, draws=movie) as made:
            return Run(made, self.values).go(ready, movie=movie, progress=progress, on_progress=on_progress, **options)

    def sweep(
        self,
        values: Mapping[str, Iterable[float | str]] | str | Path | None = None,
        /,
        folder: str | Path | None = None,
        *,
        processes: int | None = None,
        force: bool = False,
        movie: bool = False,
        progress: bool | None = None,
        **named: Iterable[float | str],
    ) -> Iterator[Run]:
        """Run the scene for all combinations of values of its ``let`` names, several at a time; gives their results in order.

        ::

            for run in scene.sweep({"h": [0.5, 1.0], "young": ["100 kPa", "1 MPa"]}):
                print(run.values, run.ledger.residual)

        Args:
            values: lists of values by name.
            folder: of all runs, each in a folder such as ``h=0.5,young=1 MPa`` inside; None is ``NAME.sweep`` beside the scene.
            processes: how many runs at a time; None is one for each core.
            force, movie: as `run` takes them.
            progress: shows a bar of runs, by default in a notebook only.

        Raises SceneError before the first run where any combination has problems, UsageError for no or equal combinations and
        for flags that are not True or False. A run that fails raises what `run` does when its turn has come; runs before it keep
        their results.
        """
        check_flags(force=force, movie=movie, progress=progress)
        if isinstance(values, (str, Path)):
            if folder is not None:
                raise UsageError(f"sweep has two folders, {values} and {folder}; its first argument is a table of values")
            values, folder = None, values
        if named:
            warn("sweep(NAME=[...])", "sweep({'NAME': [...]}, folder): a table can have any name of a scene")
        lists = together_of(values or {}, named)
        check_lists(lists)
        points = [dict(zip(lists, point)) for point in itertools.product(*lists.values())]
        names = [",".join(f"{name}={value}" for name, value in point.items()) for point in points]
        if not lists or not points or len(set(names)) < len(names):
            raise UsageError('sweep needs lists of different values of names of the scene, e.g. scene.sweep({"h": [0.5, 1.0]})')
        scenes = [self.where(point) for point in points]
        home = default_folder(self.record).with_suffix(".sweep") if folder is None else Path(folder)
        places = [home / re.sub(r"[^\w.+=,-]", "_", name) for name in names]
        return self._sweep(scenes, places, min(processes or cores(), len(scenes)), force, movie, progress)

    @staticmethod
    def _sweep(scenes, places, processes: int, force: bool, movie: bool, progress: bool | None) -> Iterator[Run]:
        threads = {THREADS: str(asked_threads() or max(1, cores() // processes))}
        with Workers(processes, more=threads) as workers, progress_bar("sweep", quiet=quiet_unless(progress)) as bar:
            runs = [workers.submit(_run_point, *point, force, movie) for point in zip(scenes, places)]
            for done, run in enumerate(runs, 1):
                yield run.result()
                bar(done, len(runs), f"run {done} of {len(runs)}")

    def study(
        self,
        folder: str | Path | None = None,
        *,
        budget: float = BUDGET,
        ladders: Sequence[str] = (),
        force: bool = False,
        on_progress: Callable[[str], None] = lambda line: None,
    ) -> Study:
        """Measure what accuracy costs in time (docs/accuracy.md), for ``budget`` seconds of wall time.

        Points are kept in ``folder``/study (default folder: ``NAME.out`` beside the scene) as soon as they are measured, and
        not measured again. ``ladders`` names some of "time step", "resolution", "sweeps", "contact"; ``force`` throws away
        the study of another scene; ``on_progress`` is called with a line of text for each piece of work. Raises SceneError,
        RefusedError, DivergedError, OutputError.
        """
        study = output_folder(self.record, folder) / STUDY
        return run_study(self.record, study, budget=budget, only=ladders, force=force, on_progress=on_progress)

    def setting_for(
        self,
        error: float,
        folder: str | Path | None = None,
        *,
        budget: float = BUDGET,
        force: bool = False,
        on_progress: Callable[[str], None] = lambda line: None,
    ) -> Choice:
        """Find the cheapest setting with an error below a target, such as 0.02; its ``words`` belong into ``control``.

        Points are kept with those of `study`, and arguments are as there. Raises UsageError for a scene that says both resolution
        and timestep, DivergedError where no setting could be found, SceneError, RefusedError, OutputError.
        """
        home = output_folder(self.record, folder) / STUDY
        return find_choice(self.record, error, budget=budget, folder=home, force=force, on_progress=on_progress)

    @overload
    def picture(self, path: str | Path, *, at: float = 0.0, size: tuple[int, int] | None = None) -> Path: ...

    @overload
    def picture(self, path: None = None, *, at: float = 0.0, size: tuple[int, int] | None = None) -> CellPicture: ...

    def picture(self, path=None, *, at=0.0, size=None):
        """Draw the scene before it is run, at its start or after ``at`` seconds of a quick, coarse run; see `draw_picture`.
        Without a file the picture is for a cell of a notebook, which shows it."""
        if path is not None:
            return draw_picture(self.record, Path(path), at=at, size=size)
        with TemporaryDirectory(prefix="mdanim-picture-") as name:
            return CellPicture(draw_picture(self.record, Path(name) / "scene.png", at=at, size=size).read_bytes())

    def __repr__(self) -> str:
        values = "".join(f", {name}={value}" for name, value in self.values.items())
        count = len(self.record.solids)
        return f"<Scene {self.record.name}: {count} object{'s' * (count != 1)}, {self.record.control.time:g} s{values}>"

    def _repr_html_(self) -> str:
        rows = [
            (s.name, say(s.mass, "kg") if s.mass else say(s.density, "kg/m^3") if s.density else "") for s in self.record.solids
        ]
        with TemporaryDirectory(prefix="mdanim-picture-") as name, suppress(MdanimError):
            picture = self.picture(Path(name) / "start.png", size=THUMBNAIL).read_bytes()
            return html_table(repr(self)[1:-1], ("object", "mass or density"), rows, picture)
        return html_table(repr(self)[1:-1], ("object", "mass or density"), rows)


def check_flags(**flags: object) -> None:
    """Raises UsageError for one that is not True, False or None: ``force=["1 N", "2 N"]`` means a name of the scene."""
    for name, value in flags.items():
        if not isinstance(value, (bool, np.bool_, NoneType)):
            raise UsageError(
                f"{name}={value!r}: {name} is True or False here; values of a name of the scene are given in a table, "
                f"where({{{name!r}: 1.0}}) or sweep({{{name!r}: [1.0, 2.0]}})"
            )


def together_of(values: Mapping, named: Mapping) -> dict:
    """Values of a table and of keywords. Raises UsageError for a name that is in both."""
    if both := values.keys() & named.keys():
        raise UsageError(f"{', '.join(sorted(both))}: given twice, in the table and as a keyword; leave one out")
    return {**values, **named}


def check_lists(lists: Mapping) -> None:
    """Raises UsageError for values of a sweep that are not a list: a text would be taken for a list of its letters."""
    for name, values in lists.items():
        if isinstance(values, str) or not isinstance(values, Iterable):
            raise UsageError(f"sweep needs a list of values for {name}, found {values!r}; write [{values!r}]")


def _run_point(scene: Scene, folder: Path, force: bool, movie: bool) -> Run:
    """One run of a sweep, in a process of its own."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "threads ")  # their number is the sweep's, nobody asked for it
        return scene.run(folder, force=force, movie=movie, progress=False)


def draw_picture(
    record: SceneRecord,
    path: Path,
    *,
    at: float = 0.0,
    size: tuple[int, int] | None = None,
    marks: Marks = Marks(),
    on_progress: Callable[[Progress], None] | None = None,
) -> Path:
    """Draw a scene before it is run: its start, or what a quick preview run comes to at the time ``at`` [s].

    The preview is coarse: ``accuracy preview``, whatever spacing and time step the scene asks for. The camera is that of the
    scene; without one it is chosen from what the preview run has seen. Raises SceneError, RefusedError, DivergedError,
    SetupError, OutputError, and UsageError for marks that the scene cannot have.
    """
    from ..picture.movie import render_still

    # Springs are drawn between all particles, whatever the scene stores.
    control = replace(record.control, save=Save.ALL)
    if at > 0.0:
        # The fewest frames that end at this time, at least those of the scene.
        frames = math.ceil(record.control.frames * at * (1.0 - 1e-9)) / at
        control = replace(control, time=at, frames=frames, accuracy=Accuracy.PREVIEW, resolution=None, timestep=None)
        record = scaled(record, None)
    with TemporaryDirectory(prefix="mdanim-picture-") as name:
        folder, ready = Path(name), prepare(replace(record, control=control, expects=()))
        if at > 0.0:
            simulate(ready, folder, on_progress=on_progress)
        else:
            write_start(ready, folder)
        return render_still(folder, -1, path, record.render, size=size, marks=marks)
