# SPDX-License-Identifier: GPL-2.0-only
"""Planes that push objects back."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Protocol

import numpy as np

from ..records import dataclass
from ..scene.schema import Vector

AXES = "xyz"


@dataclass(frozen=True, slots=True)
class PlaneMotion:
    """How planes move as one, without being turned."""

    fix: str
    """ID of the fix that tells where they are."""
    words: str
    """Words of its command."""
    low: Vector
    """Displacement from the start, at least along each axis [m]."""
    high: Vector
    """The same at most [m]."""
    speed: float
    """Largest speed [m/s]."""
    quickest: float
    """Highest frequency in it [Hz]."""
    at: Callable[[float], Vector]
    """Displacement at a time [s]."""


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane across an axis that objects belong above (sign 1) or below (sign -1)."""

    effect: str
    """Name of the effect that pushes back."""
    name: str
    """``the ground``."""
    axis: int
    sign: int
    at: float
    """[m]"""
    beyond: str
    """Position of an object beyond the plane: ``below the ground``."""
    room: str = ""
    """The room that it bounds together with others: ``the basin``; empty for a plane that stands alone."""
    motion: PlaneMotion | None = None
    """None of a plane that stands."""

    @property
    def least(self) -> float:
        """The lowest place that it has until the end of a scene [m]."""
        return self.at + (self.motion.low[self.axis] if self.motion else 0.0)

    @property
    def most(self) -> float:
        """The highest one [m]."""
        return self.at + (self.motion.high[self.axis] if self.motion else 0.0)

    def at_time(self, time: float) -> float:
        """Its place at a time [s], in [m]."""
        return self.at + (self.motion.at(time)[self.axis] if self.motion else 0.0)


class Corners(Protocol):
    """Two corners of a box, the lower one first."""

    low: Vector
    high: Vector


def box_sides(effect: str, box: Corners, axes: int, room: str, motion: PlaneMotion | None = None) -> tuple[Plane, ...]:
    """The planes on both sides of a box across the first ``axes`` axes; ``room`` is the name of the box."""
    return tuple(
        Plane(
            effect,
            f"the {effect}",
            axis,
            sign,
            at,
            f"outside the {effect} at {'-' if sign > 0 else '+'}{AXES[axis]}",
            room,
            motion,
        )
        for axis in range(axes)
        for sign, at in ((1, box.low[axis]), (-1, box.high[axis]))
    )


def innermost(planes: Iterable[Plane]) -> tuple[np.ndarray, np.ndarray]:
    """Highest plane that objects stay above and lowest that they stay below, across each axis [m], each of shape (3,); infinite
    where there is none. Of planes that move the outermost places."""
    return _bounds((p, p.least if p.sign > 0 else p.most) for p in planes)


def closest(planes: Iterable[Plane]) -> tuple[np.ndarray, np.ndarray]:
    """The same with the innermost places of planes that move: objects beyond these may touch one."""
    return _bounds((p, p.most if p.sign > 0 else p.least) for p in planes)


def _bounds(places: Iterable[tuple[Plane, float]]) -> tuple[np.ndarray, np.ndarray]:
    low, high = np.full(3, -np.inf), np.full(3, np.inf)
    for plane, at in places:
        if plane.sign > 0:
            low[plane.axis] = max(low[plane.axis], at)
        else:
            high[plane.axis] = min(high[plane.axis], at)
    return low, high
