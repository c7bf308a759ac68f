# SPDX-License-Identifier: GPL-2.0-only
"""Frames of a trajectory as soon as they are written, by their place in the file, while its run goes on (docs/view.md)."""

from __future__ import annotations

import math
import os
import weakref
from pathlib import Path

import numpy as np

from ..errors import OutputError
from .trajectory import Trajectory
from .trajectory_file import CHECKSUM, FORMAT, NOT_WRITTEN, STEP, TIME, checksum, frame_tables, open_trajectory


class WrittenFrames:
    """Reads frames from where they lie in the file, without HDF5 and without a lock, also from several threads.

    A frame can be read as soon as its run has written it, before it is on the disk. It stays readable when the file is renamed
    at the end of the run. Every value is compared with its checksum.

    Args:
        path: output folder.

    Raises:
        OutputError: no trajectory there, one that is damaged, or of a format before checksums.
    """

    def __init__(self, path: Path):
        with Trajectory(path) as whole:  # with all its checks
            if whole.format < FORMAT:
                raise OutputError(
                    f"{whole.path}: format {whole.format} cannot be viewed; run the scene again, or draw it: "
                    f"mdanim-lammps render {path}"
                )
            self.path, self.metadata, self.dt, self.steps_per_frame = whole.path, whole.metadata, whole.dt, whole.steps_per_frame
            with open_trajectory(whole.path) as file:
                self._tables = frame_tables(file)
            if any(table.offset == 0 and table.stride * table.frames for table in self._tables.values()):
                raise OutputError(f"{whole.path}: damaged: a table of its frames does not lie in one piece")
            for name, dtype in ((STEP, np.int64), (TIME, np.float64), (CHECKSUM, np.uint32)):
                if self._tables[name].dtype != dtype:
                    raise OutputError(f"{whole.path}: damaged: {name} of its frames holds {self._tables[name].dtype}")
        self._sums = self._tables.pop(CHECKSUM)
        self._row = {name: self._tables.pop(name) for name in (STEP, TIME)}
        try:
            self._file = os.open(self.path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be read: {error.strerror}") from error
        self.close = weakref.finalize(self, os.close, self._file)
        """Close the file; else it is closed when nothing refers to this object any more."""

    @property
    def total(self) -> int:
        """Frames of the whole run."""
        return self._row[STEP].frames

    def on_disk(self) -> int:
        """Frames that are on the disk: those that a reader of the finished file will find."""
        steps = self._bytes(self._row[STEP].offset, self._row[STEP].stride * self.total, 0)
        return int((np.frombuffer(steps, np.int64) != NOT_WRITTEN).sum())

    def is_at(self, path: Path) -> bool:
        """Whether this is the file of that name."""
        try:
            return os.path.samestat(os.lstat(path), os.fstat(self._file))
        except FileNotFoundError:
            return False

    def time(self, frame: int) -> float:
        """Simulated time of a frame [s]. Raises as `value`."""
        time = float(self._read(self._row[TIME], frame))
        if not math.isfinite(time):
            raise OutputError(f"{self.path}: frame {frame} is not there, or damaged: its time is {time}")
        return time

    def value(self, name: str, frame: int) -> np.ndarray:
        """One quantity of a frame (`trajectory_file`), e.g. ``position`` [m], shape (N, 3).

        Raises OutputError where it is not written or is damaged, IndexError.
        """
        found = self._read(self._tables[name], frame)
        if checksum(found) != self._read(self._sums, frame)[1 + list(self._tables).index(name)]:
            raise OutputError(
                f"{self.path}: frame {frame} is damaged or not there: its {name} differs from what was written (checksum)"
            )
        return found

    def __enter__(self) -> WrittenFrames:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _read(self, table, frame: int) -> np.ndarray:
        if not 0 <= frame < self.total:
            raise IndexError(f"frame {frame} of a trajectory with {self.total} frames")
        return np.frombuffer(self._bytes(table.offset, table.stride, frame), table.dtype).reshape(table.shape)

    def _bytes(self, offset: int, stride: int, frame: int) -> bytes:
        parts, at, end = [], offset + frame * stride, offset + (frame + 1) * stride
        while at < end:
            part = os.pread(self._file, end - at, at)
            if not part:
                raise OutputError(f"{self.path}: ends before frame {frame}: it is damaged")
            parts.append(part)
            at += len(part)
        return b"".join(parts)
