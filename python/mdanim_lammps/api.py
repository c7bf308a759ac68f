# SPDX-License-Identifier: GPL-2.0-only
"""The Python interface: load a scene, ask what it calls for, run it."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path

from .certificate import Certificate
from .effects import Verdict
from .errors import UsageError
from .parallel.runtime.launch import simulate_on
from .results.checkpoint import Checkpoint
from .results.files import MARK, open_folder, write_json
from .run.loop import Result, simulate, write_inputs
from .run.manifest import manifest
from .run.prepare import Prepared, prepare
from .scene.parse import load_scene
from .scene.scene import Scene as SceneRecord
from .study.bench import BUDGET
from .study.study import Study, run_study
from .study.target import settle

STUDY = "study"
"""Folder of a study inside the output folder."""


class Scene:
    """A scene that was read and found valid."""

    def __init__(self, record: SceneRecord):
        self.record = record
        """The scene as plain frozen records in SI units."""

    @classmethod
    def load(cls, path: str | Path, *, strict: bool = False, **overrides: float | str) -> Scene:
        """Read a scene file; keyword arguments override its ``let`` names, as ``--set`` does.

        Raises SceneError with all problems in ``.problems``.
        """
        return cls(load_scene(path, overrides=overrides, strict=strict))

    @cached_property
    def prepared(self) -> Prepared:
        """Models, effects, certificate and LAMMPS plan. Raises SceneError, RefusedError.

        ``accuracy error p %`` has the setting that is stored beside the scene;
        as long as there is none it counts as ``balanced``.
        """
        return prepare(settle(self.record, make=False).scene)

    def effects(self) -> dict[str, Verdict]:
        """Every effect with whether it is on, and why. Raises SceneError, RefusedError."""
        return dict(self.prepared.verdicts)

    def certificate(self) -> Certificate:
        """The certified time step and what sets it. Raises SceneError, RefusedError."""
        return self.prepared.certificate

    def run(
        self,
        folder: str | Path | None = None,
        *,
        executors: int = 1,
        control: str | None = None,
        force: bool = False,
        movie: bool = False,
        watch=None,
    ) -> Result:
        """Simulate into ``folder`` (default: ``NAME.out`` beside the scene); returns ledger, outcomes and cost.

        On several ``executors``, ``control`` is ``central`` (the default) or ``peers``: the frames are the same to the last bit.
        ``watch`` is called with a Progress after every frame. A scene with ``accuracy error p %`` and no setting stored beside
        it is studied first, for two minutes at most. Raises SceneError, RefusedError, DivergedError, OutputError.
        """
        started = time.perf_counter()
        settled = settle(self.record, make=True, study=(Path(folder) if folder else default_folder(self.record)) / STUDY)
        ready = self.prepared if settled.scene is self.record else prepare(settled.scene)
        folder = open_run(ready, folder, force=force)
        result = run_frames(ready, folder, executors=executors, control=control, watch=watch, started=started)
        if movie:
            from .picture.movie import render_movie

            render_movie(folder, self.record.render, movie_file(folder, self.record))
        return result

    def study(
        self,
        folder: str | Path | None = None,
        *,
        budget: float = BUDGET,
        ladders: Sequence[str] = (),
        force: bool = False,
        watch=lambda line: None,
    ) -> Study:
        """Measure what accuracy costs in time (docs/accuracy.md), for ``budget`` seconds of wall time.

        Points are kept in ``folder``/study (default folder: ``NAME.out`` beside the scene) as soon as they are measured, and
        not measured again. ``ladders`` names some of "time step", "resolution", "sweeps"; ``force`` throws away the study of
        another scene; ``watch`` is told what goes on, line by line. Raises SceneError, RefusedError, DivergedError, OutputError.
        """
        folder = Path(folder) if folder is not None else default_folder(self.record)
        return run_study(self.record, folder / STUDY, budget=budget, only=ladders, force=force, watch=watch)


def default_folder(record: SceneRecord) -> Path:
    """``SCENE.out`` beside the scene file."""
    return (record.path.parent if record.path else Path.cwd()) / f"{record.name}.out"


def open_run(ready: Prepared, folder: str | Path | None, *, force: bool) -> Path:
    """Make the output folder (None: the default one) with all that is known before the run. Raises OutputError."""
    folder = Path(folder) if folder is not None else default_folder(ready.scene)
    with _study_aside(folder):
        open_folder(folder, force=force)
    write_json(folder / MARK, manifest(ready.scene, ready.lock, sys.argv))
    write_inputs(ready, folder)
    return folder


@contextmanager
def _study_aside(folder: Path) -> Iterator[None]:
    """Keep a study out of the way while a run's folder is made: it is no part of the run, and dear to make again."""
    study, aside = folder / STUDY, folder.with_name(f".{folder.name}.{STUDY}")
    if study.is_dir():
        os.replace(study, aside)
    try:
        yield
    finally:
        if aside.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            os.replace(aside, study)


def movie_file(folder: Path, record: SceneRecord) -> Path:
    """Where the movie goes: ``render { movie "NAME" }``, taken from the output folder, or movie.mp4."""
    return folder / (record.render.movie or "movie.mp4")


def run_frames(
    ready: Prepared, folder: Path, *, executors: int = 1, control: str | None = None, resume: Checkpoint | None = None, **options
) -> Result:
    """Simulate in this process, or on executors of their own when there is more than one or a ``control`` is named.

    ``options`` are those of `run.loop.simulate`. Raises what that does, and UsageError for less than one executor.
    """
    if executors < 1:
        raise UsageError(f"{executors} executors: at least one is needed")
    if executors == 1 and control is None:
        return simulate(ready, folder, resume=resume, **options)
    return simulate_on(executors, control or "central", ready, folder, resume=resume, **options)
