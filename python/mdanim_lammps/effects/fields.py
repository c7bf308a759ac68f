# SPDX-License-Identifier: GPL-2.0-only
"""Named fields: values that effects give for a frame, each declared once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

PER = ("particle", "bond", "object", "cell", "column", "row", "run")
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
    """How many things there are, along each axis of the table: objects; rows and columns of cells; the most rows that fit."""

    def __post_init__(self):
        if self.per not in PER:
            raise ValueError(f"field {self.name} is per {self.per}, not per one of {', '.join(PER)}")
        if self.ledger and (self.per != "run" or self.shape):
            raise ValueError(f"field {self.name} is a column of the ledger, so it is one number per run")

    @property
    def whole_shape(self) -> tuple[int, ...]:
        """Shape of all values in one frame."""
        return (*self.counts, *self.shape)

    def fits(self, value: Any) -> bool:
        """Whether an array has the shape of its values in one frame; of a field per row there may be fewer."""
        found, most = np.shape(value), self.whole_shape
        return found == most or (self.per == "row" and len(found) == len(most) and found[1:] == most[1:] and found[0] < most[0])


def column(name: str, unit: str) -> Field:
    """A property of each particle, which fixes look up as ``d_NAME``."""
    return Field(name, unit, per="particle")


Fields = Mapping[str, Any]
"""Values by the names of fields: arrays, numbers for those per run."""


def join_fields(declared: Iterable[Field], still: np.ndarray, parts: Iterable[tuple[np.ndarray, Fields]]) -> dict[str, Any]:
    """The fields of a whole scene, from those of its parts.

    Fields per object are put together and have their default where an object never moves, which any part may have; those per run
    are added up; all others come whole from one part.

    Args:
        declared: all fields of the scene.
        still: objects that never move, bool, shape (M,).
        parts: numbers of objects, int64, shape (m,), and fields of these, or of all objects.
    """
    parts, found = list(parts), {}
    for field in declared:
        told = [(objects, fields[field.name]) for objects, fields in parts if field.name in fields]
        if field.per == "object":
            found[field.name] = np.full((len(still), *field.shape), field.default, field.dtype)
            for objects, values in told:
                moving = ~still[objects]
                found[field.name][objects[moving]] = (values[objects] if len(values) == len(still) else values)[moving]
        elif told:
            found[field.name] = sum(value for _, value in told) if field.per == "run" and len(told) > 1 else told[0][1]
    return found
