# SPDX-License-Identifier: GPL-2.0-only
"""Writes the trajectory file, frame by frame; what was flushed survives a crash, a full disk and a loss of power."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import MappingProxyType

import numpy as np

from ..effects.fields import Field, Fields
from ..effects.kept import kinds, records_of
from ..errors import OutputError
from ..model.grid import Grid
from ..model.model import Model
from ..model.system import centers
from ..scene.scene import SceneRecord
from .files import disk_errors, rename
from .frame_rows import FrameRows, RowWriter
from .trajectory import Trajectory
from .trajectory_file import (
    CHECKSUM,
    FORMAT,
    NOT_WRITTEN,
    STEP,
    TIME,
    checksum,
    create_trajectory,
    frame_tables,
    open_trajectory,
    part_of,
    row_checksum,
)
from .trajectory_metadata import metadata_of, stored_particles, stored_springs


class TrajectoryWriter:
    """Writes frames to ``PATH.part``; ``close`` gives the file its name.

    A frame counts once ``flush`` has returned: it then survives the death of the process and a loss of power. The step of
    a frame is written after the frame's data are on the disk, and a frame without a step does not count.

    Args:
        path: the finished file, usually ``FOLDER/trajectory.h5``.
        scene: for names, colours, ``control save``, and what its features keep.
        models: one per solid; frames have the particles of all models one after the other.
        frames: number of frames of the whole run, the first included.
        dt: time step [s].
        steps_per_frame: time steps between frames.
        scene_text: the expanded scene, so that pictures need no other file.
        grid: cells that effects of the scene use; None without any.
        fields: what effects tell of a frame; those of things that objects have are stored, besides those of features.

    Raises:
        OutputError: the file cannot be written, e.g. because the disk is full.
    """

    def __init__(
        self,
        path: str | Path,
        scene: SceneRecord,
        models: Sequence[Model],
        *,
        frames: int,
        dt: float,
        steps_per_frame: int,
        scene_text: str = "",
        grid: Grid | None = None,
        fields: Sequence[Field] = (),
    ):
        part = part_of(path)
        create_trajectory(part, metadata_of(scene, models, scene_text, grid, fields), frames, dt, steps_per_frame)
        self._open(Path(path), models, count=0)

    @classmethod
    def append(
        cls, path: str | Path, scene: SceneRecord, models: Sequence[Model], after_step: int, grid: Grid | None = None
    ) -> TrajectoryWriter:
        """Go on with the trajectory of a run that ended early; frames after ``after_step`` are dropped.

        The file is continued where it is: frames up to ``after_step`` are read and checked, and not written again.

        Args:
            path: as for a new trajectory; ``PATH`` or, of a killed run, ``PATH.part`` must exist.
            scene, models, grid: the same as in the first run.
            after_step: last step to keep; the file must have a frame of it.

        Raises:
            OutputError: no trajectory there, one that is damaged, too short or of other objects, or it cannot be written.
        """
        path = Path(path)
        with Trajectory(path) as old:
            if old.format < FORMAT:
                raise OutputError(f"{old.path}: format {old.format} cannot be continued; start afresh with --force")
            if old.names != tuple(m.name for m in models) or old.metadata.total != sum(len(m.position) for m in models):
                raise OutputError(
                    f"{old.path}: holds {len(old.names)} objects with {old.metadata.total} particles, "
                    f"not this scene's; start afresh with --force or another -o folder"
                )
            now = records_of(scene, grid)
            for name, kind in kinds().items():
                if why := kind.parted(old.metadata.kept.get(name), now.get(name)):
                    raise OutputError(f"{old.path}: {why}; start afresh with --force or another -o folder")
            keep = int(np.searchsorted(old.steps, after_step, side="right"))
            last = int(old.steps[keep - 1]) if keep else NOT_WRITTEN
            if last != after_step:
                raise OutputError(
                    f"{old.path}: has no frame of step {after_step}, from which the run is to go on, so it is not the file that "
                    "was written with the checkpoint; copy it again from its source, or start afresh with --force"
                )
            for frame in range(keep):
                old.check(frame)
        if old.path == path:
            with disk_errors(path):
                rename(path, part_of(path))
        self = cls.__new__(cls)
        self._open(path, models, count=keep, last_step=last)
        self._drop(keep)
        return self

    def _open(self, path: Path, models: Sequence[Model], *, count: int, last_step: int = NOT_WRITTEN) -> None:
        self.path, self._partial = path, part_of(path)
        with Trajectory(self._partial) as made:
            self.metadata = made.metadata
        with open_trajectory(self._partial) as file:
            self._tables = frame_tables(file)
        self._frames = self._tables[STEP].frames
        self._count = count
        self._last_step = last_step
        self._pending: list[int] = []
        stored = self.metadata.id
        self.rows = FrameRows(
            self._partial,
            self._partial.stat().st_ino,
            self._tables["position"],
            self._tables["velocity"],
            None if len(stored) == self.metadata.total else stored - 1,
        )
        """For processes that write rows of particles themselves (`add`)."""
        # Masses of all particles, stored or not: the centre of mass is that of the whole object.
        self._mass = np.concatenate([np.zeros(0), *(model.mass for model in models)])  # none of a liquid alone
        self._starts = np.cumsum([0] + [len(model.position) for model in models])[:-1]
        self._stored: dict[str, np.ndarray] = {}
        """Particles and springs that the file has, of all, bool, for fields of these."""
        if any(of.per in ("particle", "bond") for of in self.metadata.fields):
            kept = [stored_particles(model, self.metadata.save) for model in models]
            springs = [stored_springs(model, particles) for model, particles in zip(models, kept)]
            self._stored = {"particle": np.concatenate(kept), "bond": np.concatenate(springs)}
        self._writer, self._closed = RowWriter(self.rows), False

    def write(
        self, step: int, time: float, position: np.ndarray, velocity: np.ndarray, fields: Fields = MappingProxyType({})
    ) -> None:
        """Add a frame.

        Args:
            step: time step number, larger than that of the frame before.
            time: simulated time [s].
            position: of all particles, stored or not [m], shape (N, 3).
            velocity: [m/s], shape (N, 3).
            fields: values of ``metadata.fields``, by name.

        Raises:
            OutputError: the frame cannot be written; those before it are kept.
            ValueError: an array has another shape or is not one of a frame, the step is not larger, or the file has all its
                frames.
        """
        for name, array in (("position", position), ("velocity", velocity)):
            if np.shape(array) != (self.metadata.total, 3):
                raise ValueError(f"{name} must have shape ({self.metadata.total}, 3), found {np.shape(array)}")
        if unknown := set(fields) - {of.name for of in self.metadata.fields}:
            raise ValueError(f"frames of this trajectory have no {', '.join(sorted(unknown))}")
        self._check_frame(step)
        self._tables_of(fields)
        checksums = self._writer.write(self._count, [slice(0, self.metadata.total)], position, velocity)
        means = (centers(self._mass, self._starts, values) for values in (position, velocity))
        self.add(step, time, checksums, *means, fields)

    def add(
        self,
        step: int,
        time: float,
        checksums: np.ndarray,
        center: np.ndarray,
        center_velocity: np.ndarray,
        fields: Fields = MappingProxyType({}),
    ) -> None:
        """Add a frame whose rows of particles are written, by one or more `RowWriter` of `rows`.

        Args:
            step, time: as in `write`.
            checksums: of all positions and of all velocities of the frame, as the file has them, uint32, shape (2,).
            center: centres of mass of all objects [m], shape (O, 3).
            center_velocity: their velocities [m/s], shape (O, 3).
            fields: what effects tell of the frame (effects/fields.py).

        Raises:
            OutputError: the frame cannot be written; those before it are kept.
            ValueError: as in `write`.
        """
        self._check_frame(step)
        values = {"center_of_mass": center, "center_of_mass_velocity": center_velocity, **self._tables_of(fields)}
        values = {name: np.ascontiguousarray(value, self._tables[name].dtype) for name, value in values.items()}
        sums = [row_checksum(step, time), *checksums.tolist(), *map(checksum, values.values())]
        for name, value in (values | {CHECKSUM: np.array(sums, np.uint32), TIME: np.float64(time)}).items():
            self._put(name, self._count, value)
        self._count += 1
        self._last_step = int(step)
        self._pending.append(self._last_step)

    def _tables_of(self, fields: Fields) -> dict[str, np.ndarray]:
        """Values of all tables of fields in a frame."""
        found = {}
        for of in self.metadata.fields:
            value = of.to_table(fields[of.name]) if of.name in fields else None
            if value is not None and of.per in self._stored and len(value) == len(self._stored[of.per]):
                value = value[self._stored[of.per]]
            if value is None or not of.fits(value):
                rows = " or fewer rows" if of.per in ("row", "pair") else ""
                shape = None if value is None else np.shape(value)
                raise ValueError(f"{of.name} must have the shape {of.whole_shape}{rows}, found {shape}")
            rest = of.whole_shape[0] - len(value) if of.per in ("row", "pair") else 0
            found[of.table] = np.pad(value, ((0, rest), *((0, 0) for _ in np.shape(value)[1:]))) if rest else value
        return found

    def _check_frame(self, step: int) -> None:
        if step <= self._last_step:
            raise ValueError(f"step must be larger than that of the frame before ({self._last_step}), found {step}")
        if self._count == self._frames:
            raise ValueError(f"all {self._frames} frames of the file are written")

    def flush(self) -> None:
        """Return when all frames so far are on the disk. Raises OutputError."""
        if not self._pending:
            return
        # A step makes its frame count, so the data are on the disk before it.
        self._writer.sync()
        self._put(STEP, self._count - len(self._pending), np.array(self._pending, np.int64))
        self._writer.sync()
        self._pending.clear()

    def close(self, *, finished: bool = True) -> Path:
        """Flush, close, and give the file its name; returns where it is.

        Args:
            finished: False leaves it as ``PATH.part``, for a run that will be resumed.

        Raises:
            OutputError: the file cannot be written.
            ValueError: it is said to be finished, and lacks frames.
        """
        if not self._closed:
            self._closed = True
            try:
                self.flush()
                if finished and self._count < self._frames:
                    raise ValueError(f"{self._count} of {self._frames} frames are written: the trajectory is not finished")
            finally:
                self._writer.close()
            if finished:
                with disk_errors(self.path):
                    rename(self._partial, self.path)
        return self.path if finished else self._partial

    def __enter__(self) -> TrajectoryWriter:
        return self

    def __exit__(self, kind, value, traceback) -> None:
        self.close(finished=kind is None)

    def _put(self, name: str, frame: int, value: np.ndarray) -> None:
        """Write a quantity of a frame, or of several that follow each other. Raises OutputError."""
        self._writer.put(self._tables[name], frame, value)

    def _drop(self, keep: int) -> None:
        """Let no frame from this one on count."""
        self._put(STEP, keep, np.full(self._frames - keep, NOT_WRITTEN, np.int64))
        self._writer.sync()
