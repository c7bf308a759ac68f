# SPDX-License-Identifier: GPL-2.0-only
"""Columns of a plan: values that effects declare for particles, springs and objects (effects/fields.py), as LAMMPS has them.

LAMMPS keeps values of particles alone, and hands them on with these. So a value of an object is at each of its particles, and
one of a spring at both ends, in the row of the particle, at the place of the partner among its partners in ascending order.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..effects.fields import Field, pair_rows
from ..errors import SetupError
from .state import Records, StateRecords

if TYPE_CHECKING:
    from .plan import Plan

BITS = 31
"""Springs whose values, yes or no, are the bits of one whole number, the first the lowest."""
PREFIX = "column "
"""Begins the name of the records of a column; no fix has a space in its ID."""


class Places(NamedTuple):
    """Places of springs in the rows of both ends."""

    low: np.ndarray
    """In that of the lower end, from 0, int64, shape (S,)."""
    high: np.ndarray
    """In that of the higher end, shape (S,)."""


def places(bonds: np.ndarray, n: int) -> Places:
    """Places of springs, 0-based pairs i < j sorted (S, 2), in the rows of n particles."""
    i, j = bonds.T
    lower = np.bincount(j, minlength=n)  # partners below each particle
    count, order = np.arange(len(bonds)), np.argsort(j, kind="stable")
    low = lower[i] + count - np.searchsorted(i, i)
    high = np.empty(len(bonds), np.int64)
    high[order] = count - np.searchsorted(j[order], j[order])
    return Places(low, high)


def most_bonds(bonds: np.ndarray) -> int:
    """Springs of the particle that has most."""
    return int(np.bincount(bonds.ravel()).max(initial=0))


class Property(NamedTuple):
    """A property of particles in LAMMPS."""

    name: str
    """``d_NAME``, ``i_NAME``, or with several values for each particle ``d2_NAME``, ``i2_NAME``."""
    width: int
    """Number of these values; 0 where there is one, without a table."""

    @property
    def is_number(self) -> bool:
        """Whether it is one floating-point number."""
        return self.name.startswith("d_")

    @property
    def word(self) -> str:
        """The same for ``fix property/atom``."""
        return f"{self.name} {self.width}" if self.width else self.name


def property_of(field: Field, slots: int) -> Property:
    """The property of a column; ``slots`` are the springs that a particle has room for."""
    if _is_bits(field):
        return Property(f"i_{field.name}", 0) if slots <= BITS else Property(f"i2_{field.name}", -(-slots // BITS))
    kind = "i" if np.dtype(field.dtype).kind == "i" else "d"
    width = int(np.prod(field.shape, dtype=int)) * (slots if field.per == "bond" else 1)
    return (
        Property(f"{kind}_{field.name}", 0)
        if field.per != "bond" and not field.shape
        else Property(f"{kind}2_{field.name}", width)
    )


def _is_bits(field: Field) -> bool:
    return field.per == "bond" and field.dtype == "uint8" and not field.shape


def _to_bits(rows: np.ndarray) -> np.ndarray:
    """Whole numbers of particles, shape (N, width), from 0 or 1 of their springs, shape (N, slots)."""
    width = -(-rows.shape[1] // BITS)
    found = np.zeros((len(rows), width), np.int32)
    for slot in range(rows.shape[1]):
        found[:, slot // BITS] |= rows[:, slot].astype(np.int32) << (slot % BITS)
    return found


def _from_bits(numbers: np.ndarray, slots: int) -> np.ndarray:
    """The reverse of `_to_bits`."""
    slot = np.arange(slots)
    return (numbers.reshape(len(numbers), -1)[:, slot // BITS] >> (slot % BITS) & 1).astype(np.uint8)


def wide_columns(plan: Plan) -> list[str]:
    """Columns of several floating-point numbers: a line of a data file, of 255 signs in LAMMPS, has no room for them."""
    return [name for name, field in plan.fields.items() if property_of(field, plan.slots).name.startswith("d2_")]


def spread(plan: Plan, name: str, values: np.ndarray | None = None) -> np.ndarray:
    """A column as its property has it, shape (N,) or (N, width); None for its values at the start."""
    field, system = plan.fields[name], plan.system
    values = plan.columns[name] if values is None else values
    if field.per == "object":
        values = values[system.object]
    elif field.per == "bond":
        rows = np.full((system.particles, plan.slots, *field.shape), field.default, field.dtype)
        rows[plan.bonds[:, 0], plan.places.low] = rows[plan.bonds[:, 1], plan.places.high] = values
        values = _to_bits(rows) if _is_bits(field) else rows
    width = property_of(field, plan.slots).width
    return values.reshape(len(values), width) if width else values.reshape(len(values))


def gathered(plan: Plan, name: str, rows: np.ndarray) -> np.ndarray:
    """The reverse of `spread`: the values of a column from its property, by tags."""
    field = plan.fields[name]
    if field.per == "object":
        rows = rows[plan.system.first[:-1]]
    elif field.per == "bond":
        rows = _from_bits(rows, plan.slots) if _is_bits(field) else rows
        rows = rows.reshape(len(rows), plan.slots, -1)[plan.bonds[:, 0], plan.places.low]
    return np.array(rows).reshape(len(rows), *field.shape)


def to_records(plan: Plan, values: Mapping[str, np.ndarray]) -> dict[str, StateRecords]:
    """Values of columns as records of objects; those that never move have none."""
    moving = np.flatnonzero(~plan.system.still)
    keys = np.stack([moving + 1, np.zeros(len(moving))], axis=1).astype(np.int32)
    found = {}
    for name, all_values in values.items():
        first = plan.rows(plan.fields[name].per)
        rows = np.ascontiguousarray(all_values)
        size = rows.itemsize * int(np.prod(rows.shape[1:], dtype=int))
        pieces = [rows[first[m] : first[m + 1]] for m in moving.tolist()]
        data = np.concatenate([rows[:0], *pieces]).reshape(-1).view(np.uint8)
        begin = np.append(0, np.cumsum((first[moving + 1] - first[moving]) * size))
        found[PREFIX + name] = StateRecords(keys, begin.astype(np.int64), data)
    return found


def from_records(plan: Plan, name: str, records: Records) -> np.ndarray:
    """Values of a column by its records; those of objects without one are as at the start. Raises SetupError where a record does
    not fit its object."""
    values = np.array(plan.columns[name])
    mine = records.get(PREFIX + name)
    if mine is None:
        return values
    first = plan.rows(plan.fields[name].per)
    for (m, other), begin, end in zip(mine.keys.tolist(), mine.first[:-1].tolist(), mine.first[1:].tolist()):
        rows = values[first[m - 1] : first[m]] if m else values[:0]
        if other or not m or rows.nbytes != end - begin:
            raise SetupError(f"the record of column {name} of object {m} has {end - begin} bytes, not {rows.nbytes}")
        rows[...] = mine.data[begin:end].view(values.dtype).reshape(rows.shape)
    return values


def values_of_pairs(records: StateRecords, field: Field) -> np.ndarray:
    """Values that a fix keeps for pairs of objects: rows ``a``, ``b``, from 0, and ``value``, by ascending pairs. Its record of a
    pair is a version (int64) and the value. Raises SetupError where a record has another size."""
    row = np.dtype([("version", "i8"), ("value", field.dtype, field.shape)])
    mine = records.where(records.keys[:, 1] > 0)
    if (np.diff(mine.first) != row.itemsize).any():
        raise SetupError(f"records of pairs hold something else than {field.name} [{field.unit}]")
    found = np.empty(len(mine), pair_rows(field))
    found["a"], found["b"] = mine.keys.T - 1
    found["value"] = np.frombuffer(mine.data.tobytes(), row)["value"]
    return found
