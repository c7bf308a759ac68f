# SPDX-License-Identifier: GPL-2.0-only
"""Named fields: values that effects give for a frame, each declared once."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from ..records import dataclass

GONE = "torn"
"""Name of the field of springs that has 1 for one that is gone: pictures leave out what it held together."""
GROWN = "grown"
"""Name of the field of springs that has by how much their rest lengths have changed for good [m]."""
BENT = "bent"
"""Name of the field of particles that has what the lines across each in a sheet are bent by for good [1/m]."""
PER = ("particle", "bond", "object", "pair", "cell", "column", "row", "run")
"""Things that a field has one value for each of: ``run`` has one number in all, ``row`` is a row of a table of any length."""


@dataclass(frozen=True, slots=True)
class Field:
    """A quantity with a value for each of some things."""

    name: str
    unit: str
    """SI; ``1`` for plain numbers."""
    per: str = "run"
    """One of PER."""
    dtype: str = "float64"
    """Type of an array per object, and of the table in a trajectory."""
    shape: tuple[int, ...] = ()
    """Shape of one value."""
    default: float = 0.0
    """The value where no effect gives one."""
    ledger: bool = False
    """Whether it is a column of the ledger that is not an energy."""
    whole: bool = False
    """Whether it counts something, and is written as a whole number where it is one."""
    table: str = ""
    """Its table in a trajectory, below ``/observables``; empty where a trajectory does not have it."""
    counts: tuple[int, ...] = ()
    """How many things there are, along each axis of the table: objects; rows and columns of cells; the most rows that fit, of a
    field per row or pair."""
    largest: bool = False
    """Whether the largest value of all parts of a scene is that of the whole, for a field per run; else it is their sum."""
    state: bool = False
    """Whether it changes during a run and later steps depend on it; a frame has it too."""
    tags: int = 0
    """How many of its first values are tags (from 1, 0 for none); a part of a plan numbers these anew."""

    def __post_init__(self):
        if self.per not in PER:
            raise ValueError(f"field {self.name} is per {self.per}, not per one of {', '.join(PER)}")
        if self.ledger and (self.per != "run" or self.shape):
            raise ValueError(f"field {self.name} is a column of the ledger, so it is one number per run")

    @property
    def whole_shape(self) -> tuple[int, ...]:
        """Shape of its table in one frame; a row of a pair begins with the numbers of both objects, from 1."""
        return (*self.counts, 2 + math.prod(self.shape)) if self.per == "pair" else (*self.counts, *self.shape)

    def fits(self, value: Any) -> bool:
        """Whether an array has the shape of its table in one frame; of a field per row or pair there may be fewer rows."""
        found, most, fewer = np.shape(value), self.whole_shape, self.per in ("row", "pair")
        return found == most or (fewer and len(found) == len(most) and found[1:] == most[1:] and found[0] < most[0])

    def to_table(self, value: Any) -> Any:
        """Values of a frame as they are in its table, without unused rows."""
        if self.per != "pair":
            return value
        return np.column_stack([value["a"] + 1, value["b"] + 1, value["value"].reshape(len(value), math.prod(self.shape))])

    def from_table(self, rows: np.ndarray) -> np.ndarray:
        """The reverse of `to_table`; rows that are unused are zeros."""
        if self.per != "pair":
            return rows
        rows = rows[rows[:, 0] > 0]
        found = np.empty(len(rows), pair_rows(self))
        found["a"], found["b"] = rows[:, 0] - 1, rows[:, 1] - 1
        found["value"] = rows[:, 2:].reshape(len(rows), *self.shape)
        return found


def column(name: str, unit: str, per: str = "particle", **more: Any) -> Field:
    """Values that fixes look up as properties of particles (engine/columns.py): ``d_NAME`` or, with a shape or for springs,
    ``d2_NAME``; those of whole numbers begin with i."""
    return Field(name, unit, per, **more)


def pair_rows(field: Field) -> np.dtype:
    """Type of a row of a field per pair: the two objects, from 0 and a < b, and the value. Of one with something else a = b;
    a pair may have several rows."""
    return np.dtype([("a", "i4"), ("b", "i4"), ("value", field.dtype, field.shape)])


Fields = Mapping[str, Any]
"""Values by the names of fields: arrays, numbers for those per run."""


Rows = Callable[[str], np.ndarray]
"""For a kind of thing that objects have, of PARTS: first row of each object in an array of all, and behind the last, shape
(M + 1,)."""
PARTS = ("particle", "bond", "object")
"""Kinds of things of which each object has its own, in rows side by side."""
OF_OBJECTS = (*PARTS, "pair")
"""Kinds of things that there are because of objects."""


def rows_of(first: np.ndarray, objects: np.ndarray) -> np.ndarray:
    """The rows of some objects, int64, by ``first`` of `Rows`."""
    size = first[objects + 1] - first[objects]
    return np.repeat(first[objects] - np.cumsum(size) + size, size) + np.arange(size.sum())


def part_of_fields(declared: Iterable[Field], fields: Fields, rows: Rows, objects: np.ndarray, chosen: np.ndarray) -> Fields:
    """Fields of a part, of some of its objects alone.

    Args:
        declared: the fields.
        fields: their values in the part.
        rows: of the part.
        objects: their numbers in the whole, ascending, int64, shape (m,).
        chosen: the objects to keep, bool, shape (m,); of a pair one of them is enough.
    """
    found, kept = dict(fields), np.flatnonzero(chosen)
    for field in declared:
        values = fields.get(field.name)
        if values is not None and field.per in PARTS:
            found[field.name] = values[rows_of(rows(field.per), kept)]
        elif values is not None and field.per == "pair":
            values = found[field.name] = values[chosen[values["a"]] | chosen[values["b"]]]
            values["a"], values["b"] = objects[values["a"]], objects[values["b"]]
    return found


def join_fields(
    declared: Iterable[Field], rows: Rows, still: np.ndarray, parts: Iterable[tuple[np.ndarray, Fields]], start: Fields
) -> dict[str, Any]:
    """The fields of a whole scene, from those of its parts.

    Fields of things that objects have are put together; where an object never moves, which any part may have, they are as at the
    start, or have their default. Those per pair come together in order, those per run are added up, or are the largest of all;
    all others come whole from one part.

    Args:
        declared: all fields of the scene.
        rows: of the whole.
        still: objects that never move, bool, shape (M,).
        parts: numbers of objects, int64, shape (m,), and fields of these, or of all objects.
        start: values at the start, of those that have some.
    """
    parts, found = list(parts), {}
    for field in declared:
        told = [(objects, fields[field.name]) for objects, fields in parts if field.name in fields]
        if field.per in PARTS:
            first = rows(field.per)
            first_values = start.get(field.name)
            empty = np.full((first[-1], *field.shape), field.default, field.dtype)
            found[field.name] = whole = empty if first_values is None else np.array(first_values)
            for objects, values in told:
                moving = objects[~still[objects]]
                mine = rows_of(first, moving)
                if len(values) == first[-1]:
                    whole[mine] = values[mine]
                else:
                    size = first[objects + 1] - first[objects]
                    whole[mine] = values[np.repeat(~still[objects], size)]
        elif field.per == "pair":
            rows_of_pairs = np.concatenate([np.empty(0, pair_rows(field)), *(v for _, v in told)])
            found[field.name] = rows_of_pairs[np.lexsort((rows_of_pairs["b"], rows_of_pairs["a"]))]
        elif told:
            values = [value for _, value in told]
            together = max if field.largest else sum
            found[field.name] = together(values) if field.per == "run" and len(values) > 1 else values[0]
    return found
