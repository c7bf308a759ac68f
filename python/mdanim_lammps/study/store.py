# SPDX-License-Identifier: GPL-2.0-only
"""A study's folder: every point is safe as soon as it is measured, so that an interrupted study can be continued."""

from __future__ import annotations

import math
import shutil
from dataclasses import asdict, field, replace
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..records import dataclass
from ..results.files import disk_errors, read_json, write_json, write_whole
from ..results.stored import STUDY
from .measure import Sample
from .setting import Setting

FILE = "study.json"
RUNS = ("seconds", "wall", "drift", "penetration", "found")
"""Quantities of a point that each run has."""


@dataclass
class Point:
    """A setting with all its runs; lists have one entry per run."""

    setting: Setting
    timestep: float = math.nan
    """[s]"""
    steps: int = 0
    particles: int = 0
    seconds: list[float] = field(default_factory=list)
    """Wall time of simulation [s]."""
    wall: list[float] = field(default_factory=list)
    """Wall time of everything [s]."""
    drift: list[float] = field(default_factory=list)
    """Largest energy residual."""
    penetration: list[float] = field(default_factory=list)
    """Largest depth of any object in another object or behind a plane [m]."""
    found: list[tuple[float, ...]] = field(default_factory=list)
    """Results of the scene's ``expect`` lines."""
    tracks: list[np.ndarray] = field(default_factory=list)
    """Centres of mass [m], each of shape (F, M, 3)."""
    problem: str = ""
    """Why there is no run, e.g. that it diverged."""

    @property
    def work(self) -> float:
        """Particle-steps."""
        return float(self.particles) * self.steps

    def add(self, sample: Sample) -> None:
        """Add one more run."""
        self.timestep, self.steps, self.particles = sample.timestep, sample.steps, sample.particles
        for name in RUNS:
            getattr(self, name).append(getattr(sample, name))
        self.tracks.append(sample.center)


class Store:
    """All points of one scene in a folder.

    ``study.json`` holds numbers, ``tracks/`` the centres of mass of every run. Raises OutputError when the folder holds the
    study of another scene (unless ``force``, which deletes that study) or cannot be read.
    """

    def __init__(self, folder: Path, digest: str, *, force: bool = False):
        self.folder, self.digest = folder, digest
        self.points: dict[str, Point] = {}
        self.times: np.ndarray | None = None
        """Times of the frames [s], shape (F,); None before the first run."""
        self.report: dict = {}
        path = folder / FILE
        if force and path.exists():
            shutil.rmtree(folder)
        elif path.exists():
            try:
                self._read(read_json(path, STUDY))
            except (AttributeError, KeyError, TypeError, ValueError) as error:
                raise OutputError(f"{path} is damaged ({error}); begin the study anew with --force") from error
        elif folder.is_dir() and any(folder.iterdir()):
            raise OutputError(f"{folder} holds files but no study; name another folder with -o DIR")
        with disk_errors(folder):
            (folder / "tracks").mkdir(parents=True, exist_ok=True)
        self.write()

    def _read(self, data: dict) -> None:
        if data.get("hash") != self.digest:
            raise OutputError(
                f"{self.folder} is the study of another scene, or the scene has changed since; "
                "begin anew with --force, or name another folder with -o DIR"
            )
        for entry in data["points"]:
            values = entry["runs"]
            if len({len(runs) for runs in values.values()}) > 1:
                raise ValueError("a point has other numbers of one quantity than of another")
            point = Point(
                Setting(**entry["setting"]),
                entry["timestep"] or math.nan,
                entry["steps"],
                entry["particles"],
                problem=entry["problem"],
                **values | {"found": [tuple(math.nan if x is None else x for x in f) for f in values["found"]]},
            )
            point.tracks = [self._load(f"{point.setting.key}-{k}") for k in range(len(point.seconds))]
            self.points[point.setting.key] = point
        if any(point.tracks for point in self.points.values()):
            self.times = self._load("times")
            if any(track.ndim != 3 or len(track) != len(self.times) for p in self.points.values() for track in p.tracks):
                raise ValueError("a track has other frames than the study")

    def named(self, setting: Setting, timestep: float) -> Setting:
        """The measured setting that comes to the same but for its name: time step [s].
        As one more name for it would be one more run."""
        for point in self.points.values():
            same = replace(point.setting, fraction=setting.fraction) == setting
            if same and abs(point.timestep - timestep) <= 1e-9 * timestep:
                return point.setting
        return setting

    def _load(self, name: str) -> np.ndarray:
        path = self.folder / "tracks" / f"{name}.npy"
        try:
            return np.load(path, allow_pickle=False)
        except (OSError, ValueError, EOFError, MemoryError) as error:
            raise OutputError(f"{path} cannot be read ({error}); begin the study anew with --force") from error

    def add(self, sample: Sample) -> Point:
        """Store a run: its track first, so that study.json never names a missing file."""
        point = self.points.setdefault(sample.setting.key, Point(sample.setting))
        self._save(f"{sample.setting.key}-{len(point.seconds)}", sample.center)
        if self.times is None:
            self._save("times", sample.times)
            self.times = sample.times
        point.add(sample)
        self.write()
        return point

    def fail(self, setting: Setting, problem: str) -> None:
        """Store that a setting cannot be run, and why; runs that it has already stay."""
        self.points.setdefault(setting.key, Point(setting)).problem = problem
        self.write()

    def _save(self, name: str, array: np.ndarray) -> None:
        def write(part: Path) -> None:
            with part.open("wb") as file:
                np.save(file, array)

        write_whole(self.folder / "tracks" / f"{name}.npy", write)

    def write(self, report: dict | None = None) -> None:
        """Write study.json; ``report`` is what analysis adds to it: fields of its own, and ``"points"`` by key."""
        self.report = report if report is not None else self.report
        extra = self.report.get("points", {})
        points = [self._entry(p) | extra.get(key, {}) for key, p in self.points.items()]
        write_json(
            self.folder / FILE, {"hash": self.digest, **{k: v for k, v in self.report.items() if k != "points"}, "points": points}
        )

    @staticmethod
    def _entry(p: Point) -> dict:
        found = [[x if math.isfinite(x) else None for x in f] for f in p.found]
        return {
            "key": p.setting.key,
            "setting": asdict(p.setting),
            "timestep": p.timestep if p.steps else None,
            "steps": p.steps,
            "particles": p.particles,
            "problem": p.problem,
            "runs": {name: getattr(p, name) for name in RUNS} | {"found": found},
        }
