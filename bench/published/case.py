# SPDX-License-Identifier: GPL-2.0-only
"""A case of the validation: scenes of scenes/validation, what others measured or derived, and what is found here."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from mdanim_lammps import Run, Scene
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import Accuracy, SceneRecord

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes" / "validation"
DATA = Path(__file__).resolve().parent / "data"
"""Published series as tables; the first lines of each say where it is from."""


@dataclass(frozen=True)
class Row:
    """A figure beside the published one."""

    figure: str
    published: float
    found: float
    within: float
    """How far off it may be, relative."""
    unit: str = ""
    scale: float = 0.0
    """By what the error is divided; 0: the published figure."""

    @property
    def off(self) -> float:
        """The error, relative."""
        return (self.found - self.published) / (self.scale or abs(self.published))

    @property
    def close(self) -> bool:
        """Whether it is off by no more than it may be."""
        return abs(self.off) <= self.within


@dataclass(frozen=True)
class Curve:
    """A figure for the page: what is found as lines, what is published as points."""

    x: str
    y: str
    lines: dict[str, tuple[Sequence[float], Sequence[float]]]
    points: dict[str, tuple[Sequence[float], Sequence[float]]]


@dataclass(frozen=True)
class Found:
    """Findings of a case at one accuracy."""

    rows: Sequence[Row]
    curve: Curve | None = None


Change = Callable[[SceneRecord], SceneRecord]


def unchanged(scene: SceneRecord) -> SceneRecord:
    """The scene as its file has it."""
    return scene


@dataclass
class Runs(ExitStack):
    """Runs scenes of a case at an accuracy, in folders that go at the end."""

    accuracy: str = "balanced"
    seconds: float = field(default=0.0, init=False)
    """Processor time of all runs, modelling included [s]."""

    def __post_init__(self) -> None:
        super().__init__()

    def run(self, name: str, change: Change = unchanged, /, **lets: float | str) -> Run:
        """Simulate scenes/validation/NAME.txt with these values of its ``let`` names, as it is after a `change`.

        A scene that says its own resolution has a ``let fine = 1``, the number of its cells across something over that of
        `balanced`: preview has half of it, reference twice, as where the resolution is found automatically.
        """
        start = time.process_time()
        path = SCENES / f"{name}.txt"
        if "\nlet fine = 1" in path.read_text(encoding="utf-8"):
            lets = {"fine": Accuracy(self.accuracy).cells / Accuracy.BALANCED.cells, **lets}
        record = change(load_scene(path, overrides=lets))
        record = replace(record, control=replace(record.control, accuracy=Accuracy(self.accuracy)))
        run = Scene(record).run(self.folder() / "out")
        self.seconds += time.process_time() - start
        return run

    def folder(self) -> Path:
        """An empty folder that goes at the end."""
        return Path(self.enter_context(tempfile.TemporaryDirectory()))


@dataclass(frozen=True)
class Case:
    """Something published that scenes are held against."""

    name: str
    """As its scene in scenes/validation is called, or as the names of its scenes begin."""
    title: str
    by: str
    """Its source in a few words."""
    source: str
    """Who measured or derived it, and where that is published."""
    tolerance: str
    """Why rows may be off by as much as they may."""
    limit: str
    """Where the model ends."""
    measure: Callable[[Runs], Found]
    quick: bool = False
    """Whether it takes a few seconds."""
    peers: bool = False
    """Whether MuJoCo can run its scenes, too (mujoco_runs.py): `measure` then reads centres, velocities and spins only."""
    sph: bool = False
    """Whether LAMMPS's package SPH can (sph_runs.py): `measure` then reads heights of a liquid only."""


def places(run: Run, name: str) -> np.ndarray:
    """Where the particles of an object are [m], shape (frames, particles, 3)."""
    track = run.trajectory.objects[name]
    return np.stack([track.position(frame) for frame in range(len(run.trajectory))])


def series(name: str) -> np.ndarray:
    """A table of `DATA`, shape (columns, rows)."""
    return np.loadtxt(DATA / f"{name}.csv", delimiter=",", comments="#", ndmin=2).T
