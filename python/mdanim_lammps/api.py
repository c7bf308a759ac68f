# SPDX-License-Identifier: GPL-2.0-only
"""The Python interface: load a scene, ask what it calls for, run it."""

from __future__ import annotations

import itertools
import math
import os
import re
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from types import NoneType

import numpy as np

from .certificate import Certificate
from .children import Workers
from .effects import Verdict
from .engine.threads import THREADS, asked_threads, with_threads
from .errors import MdanimError, OutputError, UsageError
from .parallel.limits import check_executors
from .picture.marks import Marks
from .processes import cores
from .report import progress_line
from .results.checkpoint import Checkpoint
from .results.files import MARK, open_folder, write_json
from .results.html import THUMBNAIL, html_table
from .results.stored import read_manifest
from .results.untrusted import check_folder, check_plain
from .run.loop import Progress, simulate, write_inputs, write_start
from .run.manifest import manifest
from .run.prepare import Prepared, prepare
from .run.result import Result
from .scene.formatting import say
from .scene.keywords import Named
from .scene.meshes import mesh_files
from .scene.parse import load_scene, name_of, parse_scene
from .scene.scene import Accuracy, Save, SceneRecord
from .study.bench import BUDGET
from .study.study import Study, run_study
from .study.target import settle
from .terminal import in_notebook, progress_bar

STUDY = "study"
"""Folder of a study inside the output folder."""


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
    def load(cls, path: str | Path, *, strict: bool = False, **overrides: float | str) -> Scene:
        """Read a scene file; keyword arguments override its ``let`` names, as ``--set`` does. Names that are words of this method
        too are given to `where`.

        Raises SceneError with all problems in ``.problems``, UsageError for a ``strict`` that is not True or False.
        """
        check_flags(strict=strict)
        read = partial(load_scene, path, strict=strict)
        return cls(read(overrides=overrides), read, overrides)

    @classmethod
    def from_text(
        cls, text: str, name: str = "scene", *, folder: str | Path | None = None, strict: bool = False, **overrides: float | str
    ) -> Scene:
        """Read a scene from a text.

        Args:
            text: as a scene file has it.
            name: of the scene and of its output folder.
            folder: where its includes and meshes are; None is the current folder.
            strict: refuse numbers that have a dimension but no unit.
            overrides: values of its ``let`` names, such as ``h=0.5`` or ``h="50 cm"``. Names that are words of this method too
                are given to `where`.

        Raises SceneError with all problems in ``.problems``, UsageError for a ``strict`` that is not True or False.
        """
        check_flags(strict=strict)
        read = partial(parse_scene, text, name, strict=strict, folder=folder)
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
        """Models, effects, certificate and LAMMPS plan. Raises SceneError, RefusedError.

        ``accuracy error p %`` has the setting that is stored beside the scene;
        as long as there is none it counts as ``balanced``.
        """
        return prepare(settle(self.record, make=False).scene)

    def effects(self) -> dict[str, Verdict]:
        """Every effect with whether it is on, and why; a KeyError suggests a name. Raises SceneError, RefusedError."""
        return Named("effect", self.prepared.verdicts)

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
    ) -> Result:
        """Simulate into ``folder`` (default: ``NAME.out`` beside the scene); returns ledger, outcomes and cost.

        On several ``executors``, ``control`` is ``central`` (the default) or ``peers``: the frames are the same to the last bit.
        So they are for any number of ``threads``; unless told, a process has as many as pay of all cores divided by executors.
        ``progress`` shows a bar, by default in a notebook only; ``on_progress`` is called with a Progress after every frame.
        A scene with ``accuracy error p %`` and no setting stored beside it is studied first, for two minutes at most.
        Raises SceneError, RefusedError, DivergedError, OutputError, and UsageError for a flag that is not True or False.
        """
        check_flags(force=force, movie=movie, progress=progress)
        started = time.perf_counter()
        settled = settle(self.record, make=True, study=output_folder(self.record, folder) / STUDY)
        ready = self.prepared if settled.scene is self.record else prepare(settled.scene)
        quiet = not (in_notebook() if progress is None else progress)
        with open_run(ready, folder, force=force, draws=movie) as folder, progress_bar("run", quiet=quiet) as bar:

            def tell(now: Progress) -> None:
                bar(now.frame, now.frames, progress_line(now))
                if on_progress:
                    on_progress(now)

            result = run_frames(
                ready, folder, executors=executors, threads=threads, control=control, on_progress=tell, started=started
            )
            if movie:
                from .picture.movie import render_movie

                render_movie(folder, self.record.render, movie_file(folder, self.record))
        result.values = self.values
        return result

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
    ) -> Iterator[Result]:
        """Run the scene for all combinations of values of its ``let`` names, several at a time; gives their results in order.

        ::

            for run in scene.sweep({"h": [0.5, 1.0], "young": ["100 kPa", "1 MPa"]}):
                print(run.values, run.ledger.residual)

        Args:
            values: lists of values by name. Names that are no words of this method may be keywords: ``sweep(h=[0.5, 1.0])``.
                A path here is the folder.
            folder: of all runs, each in a folder such as ``h=0.5,young=1 MPa`` inside; None is ``NAME.sweep`` beside the scene.
            processes: how many runs at a time; None is one for each core.
            force, movie: as `run` takes them.
            progress: shows a bar of runs, by default in a notebook only.

        Raises SceneError before the first run where any combination has problems, UsageError for no or equal combinations and
        for flags that are not True or False. A run that fails raises what `run` does when its turn has come; runs before it keep
        their results.
        """
        check_flags(force=force, movie=movie, progress=progress)
        table: Mapping = values if isinstance(values, Mapping) else {}
        if isinstance(values, (str, Path)):
            if folder is not None:
                raise UsageError(f"sweep has two folders, {values} and {folder}; its first argument may be a table of values")
            folder = values
        lists = together_of(table, named)
        check_lists(lists)
        points = [dict(zip(lists, point)) for point in itertools.product(*lists.values())]
        names = [",".join(f"{name}={value}" for name, value in point.items()) for point in points]
        if not lists or not points or len(set(names)) < len(names):
            raise UsageError("sweep needs lists of different values of names of the scene, e.g. scene.sweep(h=[0.5, 1.0])")
        scenes = [self.where(**point) for point in points]
        home = default_folder(self.record).with_suffix(".sweep") if folder is None else Path(folder)
        places = [home / re.sub(r"[^\w.+=,-]", "_", name) for name in names]
        return self._sweep(scenes, places, min(processes or cores(), len(scenes)), force, movie, progress)

    @staticmethod
    def _sweep(scenes, places, processes: int, force: bool, movie: bool, progress: bool | None) -> Iterator[Result]:
        quiet = not (in_notebook() if progress is None else progress)
        threads = {THREADS: str(asked_threads() or max(1, cores() // processes))}
        with Workers(processes, more=threads) as workers, progress_bar("sweep", quiet=quiet) as bar:
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

    def picture(self, path: str | Path, *, at: float = 0.0, size: tuple[int, int] | None = None) -> Path:
        """Draw the scene before it is run, at its start or after ``at`` seconds of a quick, coarse run; see `draw_picture`."""
        return draw_picture(self.record, Path(path), at=at, size=size)

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
    """Raises UsageError for values of a sweep that are no list: a text would be taken for a list of its letters."""
    for name, values in lists.items():
        if isinstance(values, str) or not isinstance(values, Iterable):
            raise UsageError(f"sweep needs a list of values for {name}, found {values!r}; write [{values!r}]")


def _run_point(scene: Scene, folder: Path, force: bool, movie: bool) -> Result:
    """One run of a sweep, in a process of its own."""
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
    from .picture.movie import render_still

    # Springs are drawn between all particles, whatever the scene stores.
    control = replace(record.control, save=Save.ALL)
    if at > 0.0:
        # The fewest frames that end at this time, at least those of the scene.
        frames = math.ceil(record.control.frames * at * (1.0 - 1e-9)) / at
        control = replace(control, time=at, frames=frames, accuracy=Accuracy.PREVIEW, resolution=None, timestep=None)
    with TemporaryDirectory(prefix="mdanim-picture-") as name:
        folder, ready = Path(name), prepare(replace(record, control=control, expects=()))
        if at > 0.0:
            simulate(ready, folder, on_progress=on_progress)
        else:
            write_start(ready, folder)
        return render_still(folder, -1, path, record.render, size=size, marks=marks)


def output_folder(record: SceneRecord, out: str | Path | None = None) -> Path:
    """The output folder of a run (None: the default one), refused where ``--force`` would delete what is no result.

    Raises OutputError for the current folder, for one that holds it, and for one that holds the scene.
    """
    if out is None:
        path = default_folder(record)
        check_plain(path)
    else:
        path, folder, here = Path(out), Path(out).resolve(), Path.cwd().resolve()
        if here.is_relative_to(folder):
            what = "is the current folder" if here == folder else "holds the current folder"
            raise OutputError(
                f"-o {out}: the output folder {what}, and --force would delete it; name one inside, e.g. -o {record.name}.out"
            )
        if record.path and record.path.resolve().is_relative_to(folder):
            raise OutputError(f"-o {out}: the output folder holds the scene, and --force would delete it; name another folder")
        path = folder if ".." in path.parts else path
    # Of a folder without a manifest nothing is read or deleted, but for a study.
    check_plain(path / STUDY)
    check_folder(path if os.path.lexists(path / MARK) else path / STUDY)
    return path


def default_folder(record: SceneRecord) -> Path:
    """``SCENE.out`` beside the scene file."""
    return (record.path.parent if record.path else Path.cwd()) / f"{record.name}.out"


@contextmanager
def open_run(ready: Prepared, folder: str | Path | None, *, force: bool, draws: bool | None = True) -> Iterator[Path]:
    """Make the output folder (None: the default one) with all that is known before the run, and keep other runs out of it.
    Raises OutputError."""
    folder = output_folder(ready.scene, folder)
    movie_file(folder, ready.scene)
    if force and (own := [p.name for p in mesh_files(ready.scene) if p.resolve().is_relative_to(folder.resolve())]):
        raise OutputError(f"{folder} holds the mesh {own[0]} of this scene and cannot be emptied; write elsewhere with -o DIR")
    with open_folder(folder, force=force, keep=(STUDY,)):
        write_json(folder / MARK, manifest(ready.scene, ready.lock, sys.argv, draws=draws))
        write_inputs(ready, folder)
        yield folder


def movie_file(folder: Path, record: SceneRecord) -> Path:
    """Where the movie goes: ``render { movie "NAME" }``, taken from the output folder, or movie.mp4.

    Raises OutputError for a file outside of the output folder, also where a link leads outside, and for one that is no .mp4.
    """
    name = record.render.movie or "movie.mp4"
    path = folder / name
    if Path(name).is_absolute() or ".." in Path(name).parts or not path.resolve().is_relative_to(folder.resolve()):
        raise OutputError(
            f'render {{ movie "{name}" }}: lies outside of the output folder {folder}; write a name such as movie.mp4'
        )
    if path.suffix.lower() != ".mp4":
        raise OutputError(f'render {{ movie "{name}" }}: a movie is written as .mp4; write a name such as movie.mp4')
    return path


def stored_scene(folder: Path) -> SceneRecord:
    """The scene of an output folder, under its own name. Raises OutputError, also for a folder with links, and SceneError."""
    check_folder(folder)
    if not (folder / MARK).is_file():
        what = (
            "has no run in it"
            if folder.is_dir()
            else "is a file, not the output folder of a run"
            if folder.exists()
            else "does not exist"
        )
        raise OutputError(f"{folder} {what}; name the folder that a run has written, NAME.out beside NAME.txt or what -o said")
    name = read_manifest(folder).get("scene")
    scene = load_scene(folder / "scene.lock.txt")
    return replace(scene, name=name_of(name if isinstance(name, str) and name else str(folder.resolve())))


def run_frames(
    ready: Prepared,
    folder: Path,
    *,
    executors: int = 1,
    threads: int | None = None,
    control: str | None = None,
    resume: Checkpoint | None = None,
    **options,
) -> Result:
    """Simulate in this process, or on executors of their own when there is more than one or a ``control`` is named, each with so
    many threads; None: as many as pay, of all cores divided by executors.

    ``options`` are those of `run.loop.simulate`. Raises what that does, and UsageError for less than one executor or thread or
    more than this machine can hold.
    """
    check_executors(executors, ready.system.particles)
    with with_threads(threads):
        if executors == 1 and control is None:
            return simulate(ready, folder, resume=resume, **options)
        from .parallel.runtime.launch import simulate_on

        return simulate_on(executors, control or "central", ready, folder, resume=resume, **options)
