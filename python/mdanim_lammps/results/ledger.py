# SPDX-License-Identifier: GPL-2.0-only
"""The energy ledger: where the energy of a scene is at every frame, and how well it adds up."""

from __future__ import annotations

import csv
import os
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import field
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np

from ..errors import OutputError
from ..records import dataclass
from ..scene.formatting import exact
from ..scene.keywords import did_you_mean
from .untrusted import check_room

LONGEST_LINE = 1 << 24
"""Signs of a line: 25 for each column."""
MEMORY = 10
"""Bytes of memory that a byte of the file takes."""


@dataclass
class Ledger:
    """One row per frame: time [s], one energy per effect that is on [J], and the residual.

    residual = (total now - total at the start) / (largest energy in play so far). The total is the sum of all columns,
    losses included, less what ``sources`` have brought in; the energy in play is the sum of the columns' absolute values, each
    of ``potentials`` counted from its own lowest value so far: their zeros are arbitrary, and a floating body trades one for the
    other.
    """

    terms: tuple[str, ...]
    """Energy columns, ``kinetic`` first."""
    extras: tuple[str, ...] = ()
    """Further columns that are not energies, such as ``strain.NAME`` where an ``expect`` asks for it."""
    floor: float = 0.0
    """Energy that is nothing but rounding [J]: less than this in play counts as this much."""
    potentials: tuple[str, ...] = ()
    """Terms whose zero is arbitrary: only how far they have changed says how much is in play."""
    counts: tuple[str, ...] = ()
    """Extras that count something; whole numbers of them are written as such."""
    sources: tuple[str, ...] = ()
    """Terms that count what was brought in from outside: the total is without them."""
    rows: list[dict[str, float]] = field(default_factory=list)
    _peak: float = 0.0
    _lowest: dict[str, float] = field(default_factory=dict)

    @property
    def columns(self) -> tuple[str, ...]:
        return ("time", *self.terms, "residual", *self.extras)

    def add(self, time: float, values: Mapping[str, float]) -> None:
        """Append a row with these energies and extras."""
        self.rows.append(self.weigh(time, values))

    def weigh(self, time: float, values: Mapping[str, float]) -> dict[str, float]:
        """The row that would come next, with these energies and extras and the residual that they make."""
        row = {"time": time, **{t: float(values[t]) for t in (*self.terms, *self.extras)}}
        first = self.rows[0] if self.rows else row
        potentials = {t: row[t] for t in self.potentials}
        in_play = sum(abs(row[t]) for t in self.terms if t not in potentials) + sum(potentials.values())
        self._lowest = {t: min(self._lowest.get(t, e), e) for t, e in potentials.items()}
        self._peak = max(self._peak, in_play) if self.rows else in_play
        change = sum((first[t] - row[t] if t in self.sources else row[t] - first[t]) for t in self.terms)
        scale = max(self._peak - sum(self._lowest.values()), self.floor)
        row["residual"] = change / scale if scale else 0.0
        return row

    @property
    def residual(self) -> float:
        """Largest absolute residual so far [-]."""
        return max((abs(r["residual"]) for r in self.rows), default=0.0)

    def checksum(self, rows: int) -> int:
        """Checksum of the columns' names and the first rows, for a checkpoint."""
        table = np.array([[row[column] for column in self.columns] for row in self.rows[:rows]])
        return zlib.crc32(table, zlib.crc32(",".join(self.columns).encode()))

    def array(self, column: str) -> np.ndarray:
        """One column, shape (F,). Raises KeyError that names a near column."""
        if column not in self.columns:
            raise KeyError(f"the ledger has no column {column!r}; {did_you_mean(column, self.columns)}")
        return np.array([r[column] for r in self.rows])

    def to_pandas(self):
        """All columns as a pandas.DataFrame, a row for each frame. Raises SetupError where pandas is not installed."""
        from .trajectory import import_pandas

        return import_pandas().DataFrame(self.rows, columns=list(self.columns))

    def write(self, path: Path) -> None:
        """Write the ledger as CSV, floats in digits that keep every bit. Raises OSError."""
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(self.columns)
            writer.writerows([exact(r[c]) if c in self.counts else repr(r[c]) for c in self.columns] for r in self.rows)

    @classmethod
    def read(cls, path: Path, most: int | None = None) -> Ledger:
        """Read a ledger.csv back, with the residuals as they stand in it: the file does not say what they were weighed by.

        Args:
            path: the file.
            most: the largest number of rows to read, from the first; None for all.

        Raises OutputError, also where the rows would not fit in memory.
        """
        try:
            with open(path, newline="", encoding="utf-8") as file:
                if most is None:
                    check_room(MEMORY * os.fstat(file.fileno()).st_size, path)
                reader = csv.reader(_lines(file))
                columns = next(reader, [])
                middle = columns.index("residual")
                if columns[0] != "time" or len(set(columns)) < len(columns):
                    raise ValueError("its columns are not those of a ledger")
                ledger = cls(tuple(columns[1:middle]), tuple(columns[middle + 1 :]))
                for row in islice(reader, most):
                    if len(row) != len(columns):
                        raise ValueError(f"row {len(ledger.rows) + 1} has {len(row)} values, not {len(columns)}")
                    ledger.rows.append(dict(zip(columns, map(float, row))))
        except (OSError, ValueError, csv.Error) as error:
            raise OutputError(f"{path} cannot be read: {error}") from error
        return ledger


def _lines(file: TextIO) -> Iterator[str]:
    """The lines of a file. Raises ValueError where one is longer than any of a ledger."""
    while line := file.readline(LONGEST_LINE):
        if len(line) == LONGEST_LINE:
            raise ValueError(f"a line of it has more than {LONGEST_LINE} signs")
        yield line
