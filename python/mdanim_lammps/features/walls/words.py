# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from ...scene.schema import BOX, OneOf, Vector, setting
from ...scene.units import show

SWITCHES = {"walls": "`walls`"}


@dataclass(frozen=True, slots=True)
class Walls:
    """A box that objects never leave."""

    FORMS: ClassVar = (BOX,)
    low: Vector
    """[m]"""
    high: Vector
    """[m]"""


class WallsWords:
    """Settings outside of all blocks."""

    walls: Walls | None = setting(
        None, "A box that objects never leave. Absent: no walls.",
        "from (-2, -2, 0) m to (2, 2, 3) m", default=None, codec=OneOf(Walls))  # fmt: skip


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
    v.corners(v.out.first("walls"), "the space between the walls")
    for s in held["solids"]:
        if not all(a < x < b for a, x, b in zip(walls.low, s.position, walls.high)):
            v.problem(
                s.spans.get("position") or s.spans.get("shape"),
                f"{s.name} stands outside the walls: its centre is {show(s.position)} m",
                f"the walls go from {show(walls.low)} to {show(walls.high)} m",
            )
