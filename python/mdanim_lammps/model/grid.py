# SPDX-License-Identifier: GPL-2.0-only
"""Cells that fill a box exactly, in which some effects live."""

from __future__ import annotations

import math

import numpy as np

from ..records import dataclass
from ..scene.schema import Vector


@dataclass(frozen=True, slots=True)
class Grid:
    """Cells that fill a box exactly."""

    low: Vector
    """Lower corner [m]."""
    high: Vector
    """Upper corner [m]."""
    shape: tuple[int, int, int]
    """Cells along x, y, z."""

    @property
    def cell(self) -> Vector:
        """Edges of a cell [m]."""
        return tuple((b - a) / n for a, b, n in zip(self.low, self.high, self.shape))

    @property
    def cell_volume(self) -> float:
        """[m^3]"""
        return math.prod(self.cell)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return math.prod(self.shape)

    def units(self, volume: float) -> int:
        """Whole cells that a volume [m^3] is rounded to."""
        return math.floor(volume / self.cell_volume + 0.5)

    def cells_within(self, low: Vector, high: Vector) -> int:
        """Number of cells whose centre lies in a box [m]."""
        count = 1
        for axis, n in enumerate(self.shape):
            centre = self.low[axis] + (np.arange(n) + 0.5) * self.cell[axis]
            count *= int(np.count_nonzero((centre >= low[axis]) & (centre <= high[axis])))
        return count
