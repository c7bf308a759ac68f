# SPDX-License-Identifier: GPL-2.0-only
"""Rows of particles in the frames of a trajectory file: every process that simulates writes those of its own objects."""

from __future__ import annotations

import os
import socket
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..model.system import side_by_side
from ..records import dataclass
from .checksums import joined, shifts
from .files import disk_errors
from .trajectory_file import FrameTable, checksum

WAY_OUT = "all ranks write into the output folder: put it with -o DIR on a file system that all hosts share"


@dataclass(frozen=True)
class FrameRows:
    """Data that a process needs to write rows into a trajectory file that another process has made."""

    path: Path
    """Where the file is while it is written."""
    inode: int
    """Number of the file in its file system, the same on all hosts that share it."""
    position: FrameTable
    velocity: FrameTable
    stored: np.ndarray | None
    """Particles that the file has, from 0 and ascending, int64, shape (N,); None where it has all."""


class RowWriter:
    """Writes rows of positions and velocities of frames where they belong, also while other processes write other rows.

    A frame counts when the process that has made the file writes its step, so rows of a frame that is given up do no harm.

    Raises:
        OutputError: the file cannot be opened here, or another file has its name; so do `write` and `sync` when the file cannot
            be written, e.g. because the disk is full.
    """

    def __init__(self, rows: FrameRows):
        self.rows = rows
        try:
            self._descriptor: int | None = os.open(rows.path, os.O_WRONLY | os.O_CLOEXEC)
        except OSError as error:
            raise OutputError(f"{rows.path}: cannot be opened on {socket.gethostname()}: {error.strerror}; {WAY_OUT}") from error
        if os.fstat(self._descriptor).st_ino != rows.inode:
            self.close()
            raise OutputError(f"{rows.path}: on {socket.gethostname()} this is another file than on the first host; {WAY_OUT}")
        self._places: list[slice] | None = None
        """Particles that were written last, and for these:"""
        self._pieces: list[slice] = []
        self._shifts = shifts(np.zeros(0, np.int64))

    def write(self, frame: int, places: Sequence[slice], position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Write the rows of some particles.

        Args:
            frame: from 0.
            places: the particles, as stretches that do not overlap.
            position: of all particles, of which only these are read [m], shape (N, 3).
            velocity: [m/s], shape (N, 3).

        Returns:
            What these rows have in the checksums of the frame's positions and velocities: those of the frame are the sums modulo
            2 over all processes, uint32, shape (2,).
        """
        if places != self._places:
            self._arrange(list(places))
        stored, sums = self.rows.stored, np.zeros((2, len(self._pieces)), np.uint32)
        with disk_errors(self.rows.path):
            for n, (table, values) in enumerate(((self.rows.position, position), (self.rows.velocity, velocity))):
                begin, row = table.offset + frame * table.stride, table.row
                for k, piece in enumerate(self._pieces):
                    data = np.ascontiguousarray(values[piece if stored is None else stored[piece]], table.dtype)
                    sums[n, k] = checksum(data)
                    self._pwrite(data, begin + piece.start * row)
        return joined(sums, self._shifts)

    def _arrange(self, places: list[slice]) -> None:
        """Find the rows of these particles."""
        table, edges = self.rows.position, np.array([(p.start, p.stop) for p in places], np.int64).reshape(-1, 2)
        if self.rows.stored is not None:
            edges = np.searchsorted(self.rows.stored, edges)
        begin, end = edges[np.argsort(edges[:, 0])].T
        some = begin < end
        self._places = places
        self._pieces = [piece for (piece,) in side_by_side((end - begin)[some], begin[some])]
        after = np.array([table.shape[0] - piece.stop for piece in self._pieces], np.int64)
        self._shifts = shifts(after * table.row)

    def put(self, table: FrameTable, frame: int, values: np.ndarray) -> None:
        """Write all values of a frame, or those of several frames that follow each other. Raises OutputError."""
        with disk_errors(self.rows.path):
            self._pwrite(values, table.offset + frame * table.stride)

    def _pwrite(self, values: np.ndarray, offset: int) -> None:
        """Write values at a place of the file. Raises OSError."""
        values = np.ascontiguousarray(values)
        written = os.pwrite(self._descriptor, values, offset)
        while written < values.nbytes:  # a signal has cut it short
            written += os.pwrite(self._descriptor, memoryview(values.reshape(-1).view(np.uint8))[written:], offset + written)

    def sync(self) -> None:
        """Return when all that was written is on the disk."""
        with disk_errors(self.rows.path):
            os.fdatasync(self._descriptor)

    def close(self) -> None:
        """Close the file; harmless when called twice."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None
