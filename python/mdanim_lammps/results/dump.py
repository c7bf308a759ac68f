# SPDX-License-Identifier: GPL-2.0-only
"""Dumps that ``lmp -in in.NAME`` writes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

COLUMNS = "id mol type x y z vx vy vz"
"""The columns that ``in.NAME`` asks for."""


def read_dump(path: Path, particles: int) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Frames of a dump: step, positions [m], velocities [m/s], shape (N, 3) each.

    A last frame that is not whole, as of a killed run, is left out. Raises OSError, and ValueError for a dump of other columns or
    of another number of particles, or one that is not sorted by id.
    """
    with open(path, encoding="ascii") as file:
        while file.readline():
            head = [file.readline() for _ in range(8)]
            if not head[-1].endswith("\n"):
                return
            if head[-1].split()[2:] != COLUMNS.split():
                raise ValueError(f"its columns are not '{COLUMNS}'")
            if int(head[2]) != particles:
                raise ValueError(f"it has {int(head[2])} particles, the scene has {particles}")
            lines = [file.readline() for _ in range(particles)]
            if not lines[-1].endswith("\n"):
                return
            table = np.array(" ".join(lines).split(), dtype=np.float64).reshape(particles, len(COLUMNS.split()))
            if not np.array_equal(table[:, 0], np.arange(1, particles + 1)):
                raise ValueError("its particles are not sorted by id; keep the line 'dump_modify trajectory sort id' of in.NAME")
            yield int(head[0]), table[:, 3:6], table[:, 6:9]
