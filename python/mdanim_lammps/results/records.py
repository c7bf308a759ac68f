# SPDX-License-Identifier: GPL-2.0-only
"""The quantities that a scene records: records.csv, a column for each and a row for every frame."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..effects.measured import Measured, Of
from ..errors import OutputError
from ..scene.keywords import did_you_mean
from .html import html_table
from .quantities import series
from .untrusted import check_room

if TYPE_CHECKING:
    import pandas

MEMORY = 10
"""Bytes of memory that a byte of the file takes."""


class Records(Mapping[str, np.ndarray]):
    """Columns by the quantity as scenes write it, ``ball.speed``, each of shape (F,), in SI units; ``time`` [s] is the first.

    A number is NaN where a frame has none, as the first one of a mean since the frame before.
    """

    def __init__(self, columns: Mapping[str, np.ndarray], units: Mapping[str, str]):
        self._columns, self.units = dict(columns), dict(units)
        """Units of the columns; empty for plain numbers."""

    @classmethod
    def of(cls, asked: Iterable[Of], measured: Measured) -> Records:
        """The records of a run that has ended."""
        units = {of.what: of.unit for of in asked}
        columns = {of.what: series(of, measured) for of in asked}
        return cls({"time": measured.times, **columns}, {"time": "s", **units})

    def __getitem__(self, what: str) -> np.ndarray:
        """A column. Raises KeyError that names a near one."""
        if what not in self._columns:
            raise KeyError(f"the run has no record {what!r}; {did_you_mean(what, self._columns)}")
        return self._columns[what]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def heads(self) -> list[str]:
        """``ball.speed [m/s]``, for each column."""
        return [f"{what} [{self.units[what]}]" if self.units[what] else what for what in self]

    def to_pandas(self) -> pandas.DataFrame:
        """A row for each frame. Raises SetupError where pandas is not installed."""
        from .trajectory import import_pandas

        return import_pandas().DataFrame(self._columns)

    def write(self, path: Path) -> None:
        """Write them as CSV, with units in the head, and floats in digits that keep every bit. Raises OSError."""
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(self.heads())
            for row in zip(*(column.tolist() for column in self.values())):
                writer.writerow(["" if math.isnan(x) else repr(x) for x in row])

    @classmethod
    def read(cls, path: Path) -> Records:
        """Read a records.csv back. Raises OutputError, also where it would not fit in memory."""
        try:
            with open(path, newline="", encoding="utf-8") as file:
                check_room(MEMORY * os.fstat(file.fileno()).st_size, path)
                reader = csv.reader(file)
                heads = [head.removesuffix("]").partition(" [") for head in next(reader, [])]
                names = [what for what, _, _ in heads]
                rows = [[float(x) if x else math.nan for x in row] for row in reader]
                table = np.array(rows, float).reshape(len(rows), len(names))
        except (OSError, ValueError, csv.Error) as error:
            raise OutputError(f"{path} cannot be read: {error}") from error
        if names[:1] != ["time"] or len(set(names)) < len(names):
            raise OutputError(f"{path} cannot be read: its columns are not those of records")
        return cls(dict(zip(names, table.T)), {what: unit for what, _, unit in heads})

    def __repr__(self) -> str:
        return f"<records of {len(self['time'])} frames: {', '.join(self.heads())}>"

    def _repr_html_(self) -> str:
        rows = [
            (head, f"{np.nanmin(c):.6g}", f"{np.nanmax(c):.6g}") for head, c in zip(self.heads(), self.values()) if len(c) > 1
        ]
        return html_table(f"records of {len(self['time'])} frames", ("quantity", "least", "most"), rows)
