# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ...records import dataclass
from ...scene.schema import BOX, OneOf, Vector, setting
from ...scene.units import show
from ..contact.words import ContactModel
from ..drives.words import DriveOscillation, DriveVelocity, ShiftKey, check_shift

SWITCHES = {"walls": "`walls`"}


@dataclass(frozen=True, slots=True)
class Walls:
    """A box that objects never leave."""

    FORMS: ClassVar = (BOX,)
    low: Vector
    """[m]"""
    high: Vector
    """[m]"""


@dataclass(frozen=True, slots=True)
class WallsVelocity(DriveVelocity):
    """The box goes straight on."""

    FORMS: ClassVar = tuple(f"drive {form}" for form in DriveVelocity.FORMS)


@dataclass(frozen=True, slots=True)
class WallsOscillation(DriveOscillation):
    """The box goes to and fro."""

    FORMS: ClassVar = tuple(f"drive {form}" for form in DriveOscillation.FORMS)


@dataclass(frozen=True, slots=True)
class WallsKey(ShiftKey):
    """A point of the box's path."""

    FORMS: ClassVar = tuple(f"key {form}" for form in ShiftKey.FORMS)


class BoxAndMotion(OneOf):
    """One box, and lines that say how it moves: the record has the box, its drives and its keys."""

    def __init__(self):
        super().__init__(Walls, WallsVelocity, WallsOscillation, WallsKey)

    def gather(self, values: tuple) -> tuple:
        """The box, its drives, its keys."""
        boxes = [n for n, one in enumerate(values) if isinstance(one, Walls)]
        if not boxes:
            raise ValueError("these walls have no place", "write walls from (-2, -2, 0) m to (2, 2, 3) m, too", 0)
        if len(boxes) > 1:
            raise ValueError("walls have one place", "leave one of these lines out", boxes[1])
        keys = tuple(one for one in values if isinstance(one, ShiftKey))
        drives = tuple(one for one in values if not isinstance(one, Walls | ShiftKey))
        return values[boxes[0]], drives, keys

    def scatter(self, value: tuple) -> tuple:
        """The lines."""
        box, drives, keys = value if isinstance(value, tuple) else (value, (), ())
        return () if box is None else (box, *drives, *keys)


class WallsWords:
    """Settings outside of all blocks."""

    walls: Walls | None = setting(
        None,
        "A box that objects never leave. Absent: no walls. Further lines move it as a whole: `drive` at a velocity or to and "
        "fro, `key` through displacements from where it is, both as of [objects](#object); they add up.",
        "from (-2, -2, 0) m to (2, 2, 3) m", default=None, many=True, also=("walls_drive", "walls_keys"),
        codec=BoxAndMotion())  # fmt: skip
    walls_drive: tuple[DriveVelocity | DriveOscillation, ...] = ()
    walls_keys: tuple[ShiftKey, ...] = ()


SCENE = WallsWords

TOUCHED = {"walls": ""}


def touched(scene) -> bool:
    """Whether it brings something into a scene that objects may touch."""
    return scene.walls is not None


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """An object's centre must lie between the walls; how far it reaches is checked with its model.

    Args:
        v: the scene/validate.Validator.
        top: settings outside of all blocks.
        held: records of blocks.
    """
    if (walls := top.get("walls")) is None:
        return
    lines = v.out.settings.get("walls", ())
    said = [(s, s.record()) for s in lines]
    v.corners(next(s for s, one in said if isinstance(one, Walls)), "the space between the walls")
    moves = next((s for s, one in said if not isinstance(one, Walls)), None)
    if moves and held["control"] is not None and held["control"].contact_model is ContactModel.PAPER:
        v.problem(moves.span(), "the walls of contact-model paper stand", "take contact-model paper out of control")
    check_shift(v, "the box of the walls", [pair for pair in said if not isinstance(pair[1], Walls)])
    for s in held["solids"]:
        if not all(a < x < b for a, x, b in zip(walls.low, s.position, walls.high)):
            v.problem(
                s.spans.get("position") or s.spans.get("shape"),
                f"{s.name} stands outside the walls: its centre is {show(s.position)} m",
                f"the walls go from {show(walls.low)} to {show(walls.high)} m",
            )
