# SPDX-License-Identifier: GPL-2.0-only
"""Weighted sums of rows, as `scipy.sparse` has them. To import that takes a tenth of the time of ``mdanim-lammps picture``."""

from __future__ import annotations

import numpy as np

from ..model.patches import Patches
from ..model.tube import Tubes
from ..records import dataclass


@dataclass(frozen=True)
class Weights:
    """A sparse matrix of V rows, each with one entry at least."""

    weight: np.ndarray
    """Entries, row by row, shape (E,)."""
    index: np.ndarray
    """Column of each, int64, shape (E,)."""
    first: np.ndarray
    """First entry of each row, int64, shape (V,)."""

    @classmethod
    def of(cls, row: np.ndarray, column: np.ndarray, weight: np.ndarray) -> Weights:
        """From entries in any order, each of shape (E,); rows are counted from 0 without a gap."""
        order = np.argsort(row, kind="stable")
        return cls(weight[order], column[order].astype(np.int64), np.searchsorted(row[order], np.arange(row.max(initial=-1) + 1)))

    def __len__(self) -> int:
        return len(self.first)

    def places(self, position: np.ndarray, gone: np.ndarray | None = None) -> np.ndarray:
        """Places [m], shape (V, 3), that hang on particles at these positions [m], shape (N, 3); ``gone`` are the ends of springs
        that are gone, shape (G, 2), None where none may be."""
        return self @ np.asarray(position, dtype=np.float64)

    def __matmul__(self, value: np.ndarray) -> np.ndarray:
        """Sums of ``value``, shape (V, ...) for shape (N, ...)."""
        if not len(self):
            return np.zeros((0, *value.shape[1:]))
        if value.ndim == 1:
            return np.add.reduceat(self.weight * value[self.index], self.first)
        # Column by column: a third of the time of rows of three.
        columns = np.moveaxis(value, -1, 0)
        return np.stack([self @ np.ascontiguousarray(column) for column in columns], axis=-1)

    def __getitem__(self, row: np.ndarray) -> Weights:
        """Some of the rows, in any order."""
        count = np.diff(self.first, append=len(self.index))[row]
        first = np.cumsum(count) - count
        entry = np.arange(count.sum()) + np.repeat(self.first[row] - first, count)
        return Weights(self.weight[entry], self.index[entry], first)


@dataclass(frozen=True)
class Carry(Weights):
    """Weights of particles in vertices, some of which stand around a line of particles, or are not drawn while all is whole."""

    tubes: Tubes
    """The tubes of these vertices."""
    around: np.ndarray
    """Row of each vertex among those of the tubes, -1 for none, int64, shape (V,)."""
    patches: Patches
    """Patches of all rows, before some were chosen."""
    row: np.ndarray
    """Which of these each is, int64, shape (V,)."""
    rows: int
    """How many they were."""

    def places(self, position: np.ndarray, gone: np.ndarray | None = None) -> np.ndarray:
        position = np.asarray(position, dtype=np.float64)
        gone = np.zeros((0, 2), np.int64) if gone is None else gone
        found = self @ position
        here = self.around >= 0
        found[here] += self.tubes.around(position)[self.around[here]]
        for rows, vertices in self.tubes.torn(position, gone):
            torn = here & (self.around >= rows.start) & (self.around < rows.stop)
            found[torn] = vertices[self.around[torn] - rows.start]
        drawn, place = np.ones(self.rows, bool), np.zeros((self.rows, 3))
        self.patches.hide(position, gone, place, drawn)
        away = ~drawn[self.row]
        found[away] = place[self.row[away]]
        return found

    def __getitem__(self, row: np.ndarray) -> Carry:
        some = super().__getitem__(row)
        return Carry(some.weight, some.index, some.first, self.tubes, self.around[row], self.patches, self.row[row], self.rows)
