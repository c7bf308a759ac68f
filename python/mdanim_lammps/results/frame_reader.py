# SPDX-License-Identifier: GPL-2.0-only
"""Reads frames of a trajectory from where they lie in the file, also while its run goes on (docs/trajectory.md)."""

from __future__ import annotations

import math
import os
import weakref
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import OutputError
from .trajectory_file import CHECKSUM, NOT_WRITTEN, STEP, TIME, FrameTable, checksum, frame_tables

if TYPE_CHECKING:
    import h5py

EVERYTHING = slice(None)


class FrameReader:
    """Reads frames without HDF5 and without a lock, also from several threads.

    A frame can be read as soon as its run has written it, before it is on the disk. It stays readable when the file is renamed
    at the end of the run. Every value is compared with its checksum when it is read for the first time.

    Args:
        path: of the file.
        file: the same, opened; may be closed then, but for an older format.

    Raises:
        OutputError: its tables of frames are damaged; KeyError where one is missing.
    """

    def __init__(self, path: Path, file: h5py.File):
        self.path, tables = path, frame_tables(file)
        older = CHECKSUM not in tables
        if not older and any(table.offset == 0 and table.stride * table.frames for table in tables.values()):
            raise OutputError(f"{path}: damaged: a table of its frames does not lie in one piece")
        for name, dtype in ((STEP, np.int64), (TIME, np.float64), (CHECKSUM, np.uint32)):
            if name in tables and tables[name].dtype != dtype:
                raise OutputError(f"{path}: damaged: {name} of its frames holds {tables[name].dtype}")
        self._row, self._sums = {name: tables.pop(name) for name in (STEP, TIME)}, tables.pop(CHECKSUM, None)
        self.tables = tables
        """Tables of the quantities, in the order of their checksums."""
        self._column = {name: number for number, name in enumerate(tables, 1)}
        if self._sums and not (
            self._row[STEP].frames == self._row[TIME].frames == self._sums.frames and self._sums.shape == (1 + len(tables),)
        ):
            raise OutputError(f"{path}: damaged: its tables of steps, times and checksums do not fit together")
        self._good = {name: np.zeros(self.total, bool) for name in tables}
        try:
            self._file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
        except OSError as error:
            raise OutputError(f"{path}: cannot be read: {error.strerror}") from error
        self.close = weakref.finalize(self, _close, self._file, file if older else None)
        """Close the file; else it is closed when nothing refers to this object any more."""

    @property
    def total(self) -> int:
        """Frames of the whole run; of an older format, without checksums, those that all tables have."""
        if self._sums:
            return self._row[STEP].frames
        return min(table.frames for table in (*self._row.values(), *self.tables.values()))

    @property
    def has_checksums(self) -> bool:
        """Whether damage is noticed: not before format 3."""
        return self._sums is not None

    def rows(self) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Steps and times [s] of all frames, each of shape (F,), and checksums, shape (F, 1 + quantities)."""
        steps, times = (self.all(self._row[name], self.total) for name in (STEP, TIME))
        return steps, times, self.all(self._sums, self.total) if self._sums else None

    def on_disk(self) -> int:
        """Frames that are on the disk: those that a reader of the finished file will find."""
        return int((self.all(self._row[STEP], self.total) != NOT_WRITTEN).sum())

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

    def value(self, name: str, frame: int, rows: slice = EVERYTHING) -> np.ndarray:
        """One quantity of a frame (`trajectory_file`), or some rows of it, e.g. ``position`` [m], shape (N, 3).

        Raises OutputError where it is not written or is damaged, IndexError.
        """
        table = self.tables[name]
        if 0 <= frame < self.total and self._good[name][frame] and rows != EVERYTHING and not table.pieces:
            first, end, _ = rows.indices(table.shape[0])
            return self._bytes(table, frame * table.stride + first * table.row, (end - first, *table.shape[1:]))
        found = self._read(table, frame)
        self.compare(name, frame, found)
        return found[rows]

    def values(self, name: str, count: int) -> np.ndarray:
        """One quantity of the first frames, shape (count, ...). Raises OutputError."""
        found = self.all(self.tables[name], count)
        for frame, value in enumerate(found):
            self.compare(name, frame, value)
        return found

    def compare(self, name: str, frame: int, value: np.ndarray) -> None:
        """Raises OutputError where a value is not the one that was written."""
        if self._sums and not self._good[name][frame] and checksum(value) != self._read(self._sums, frame)[self._column[name]]:
            raise self.damaged(frame, name)
        self._good[name][frame] = True

    def damaged(self, frame: int, what: str) -> OutputError:
        """The error for a frame that is not what was written."""
        missing = " or not there" if self._read(self._row[STEP], frame) == NOT_WRITTEN else ""
        return OutputError(
            f"{self.path}: frame {frame} is damaged{missing}: its {what} differs from what was written (checksum); "
            "copy the file again from its source, or run the scene again with --force"
        )

    def all(self, table: FrameTable, count: int) -> np.ndarray:
        """A table of the first frames."""
        if table.pieces:
            return table.pieces[:count]
        return self._bytes(table, 0, (count, *table.shape))

    def _read(self, table: FrameTable, frame: int) -> np.ndarray:
        if not 0 <= frame < self.total:
            raise IndexError(f"frame {frame} of a trajectory with {self.total} frames")
        if table.pieces:
            return table.pieces[frame]
        return self._bytes(table, frame * table.stride, table.shape)

    def _bytes(self, table: FrameTable, begin: int, shape: tuple[int, ...]) -> np.ndarray:
        if not self.close.alive:
            raise OutputError(f"{self.path} was closed")
        found, at = np.empty(shape, table.dtype), table.offset + begin
        rest = memoryview(found.reshape(-1).view(np.uint8))
        while rest:
            try:
                read = os.preadv(self._file, [rest], at)
            except OSError as error:
                raise OutputError(f"{self.path}: cannot be read: {error.strerror}") from error
            if not read:
                raise OutputError(f"{self.path}: ends before what its tables tell of: it is damaged")
            rest, at = rest[read:], at + read
        return found


def _close(descriptor: int, file: h5py.File | None) -> None:
    os.close(descriptor)
    if file:
        file.close()
