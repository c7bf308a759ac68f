# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

from ...records import dataclass
from ...scene.formatting import say
from ...scene.holding import all_held
from ...scene.schema import OneOf, Vector, setting

SWITCHES: dict[str, str] = {}


@dataclass(frozen=True, slots=True)
class Ballast:
    """Another density in this box (world frame, at the start)."""

    FORMS: ClassVar = ("<rho:kg/m^3> within box <(x0, y0, z0):m> to <(x1, y1, z1):m>",)

    density: float
    """[kg/m^3]"""
    low: Vector
    """[m]"""
    high: Vector
    """[m]"""

    @classmethod
    def read(cls, form: int, values: tuple) -> Ballast:
        """Corners of a box in any order. Raises ValueError(message, hint, number of the value)."""
        density, a, b = values
        if density <= 0.0:
            raise ValueError("ballast has a density above 0", "write ballast 1 kg/m^3 for what is nearly empty", 0)
        return cls(density, tuple(map(min, a, b)), tuple(map(max, a, b)))

    def moved(self, place: Any) -> Ballast:
        """The same of an object in a group that is placed. Raises ValueError(cause, way out, word) where that is turned by other
        than right angles."""
        if (box := place.box(self.low, self.high)) is None:
            cause = "a box of ballast lies along the axes of the world, and its group is turned"
            raise ValueError(cause, "turn the group by 90 deg or 180 deg, or place the object without a group", "ballast")
        return replace(self, low=box[0], high=box[1])

    def meets(self, other: Ballast) -> bool:
        """Whether both boxes share a volume."""
        return all(a < d and c < b for a, b, c, d in zip(self.low, self.high, other.low, other.high))


class BallastWords:
    """Settings of an object."""

    ballast: tuple[Ballast, ...] = setting(
        None,
        "The part of a solid in a box (world frame, at the start) has this density, in place of its own. Mass, centre of mass "
        "and moments of inertia follow; `position` is that of the shape, and the centre of mass is elsewhere. `mass` is that "
        "without ballast. Several lines add up; their boxes may touch ([how](physics-solids.md#ballast)).",
        "11340 kg/m^3 within box (-1, -1, -1) m to (1, 1, 0.1) m", default=(), many=True, codec=OneOf(Ballast),
        after="mass")  # fmt: skip


OBJECT = BallastWords


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Ballast of what fills a volume and may move, in boxes that are apart."""
    for n, (s, one) in enumerate(zip(block.settings.get("ballast", ()), solid.ballast)):
        if getattr(solid.shape, "BENDS", False):
            cause = f"{solid.name} is a {type(solid.shape).__name__.lower()}: ballast is a part of a volume"
            v.problem(s.span(), cause, "weld a small heavy object to it: joint weld A B { at (x, y, z) m }")
        elif all_held(solid) and not getattr(solid, "release", None):
            cause = f"{solid.name} is held as a whole, so its mass does not matter"
            v.problem(s.span(), cause, "leave the ballast out, or hold a part of it")
        elif not all(a < b for a, b in zip(one.low, one.high)):
            v.problem(s.span(1), "the box of this ballast has no volume", "write two opposite corners")
        elif any(one.meets(other) for other in solid.ballast[:n]):
            cause = f"two boxes of ballast in {solid.name} share a part of {say(_shared(one, solid.ballast[:n]), 'm^3')}"
            v.problem(s.span(1), cause, "let them touch, or write one box")
    return solid


def _shared(one: Ballast, others: tuple[Ballast, ...]) -> float:
    """Largest volume that a box shares with others [m^3]."""
    found = 0.0
    for other in others:
        volume = 1.0
        for a, b, c, d in zip(one.low, one.high, other.low, other.high):
            volume *= max(0.0, min(b, d) - max(a, c))
        found = max(found, volume)
    return found


CHECKS = {"object": check_object}
