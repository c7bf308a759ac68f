# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ...scene.schema import BOX, OneOf, Vector, setting

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


def touched(scene) -> bool:
    """Whether it brings something into a scene that objects may touch."""
    return scene.walls is not None
