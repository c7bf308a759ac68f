# SPDX-License-Identifier: GPL-2.0-only
"""Planes that push objects back."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..scene.schema import Vector

AXES = "xyz"


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


class Corners(Protocol):
    """Two corners of a box, the lower one first."""

    low: Vector
    high: Vector


def box_sides(effect: str, box: Corners, axes: int, room: str) -> tuple[Plane, ...]:
    """The planes on both sides of a box across the first ``axes`` axes; ``room`` is the name of the box."""
    return tuple(
        Plane(effect, f"the {effect}", axis, sign, at, f"outside the {effect} at {'-' if sign > 0 else '+'}{AXES[axis]}", room)
        for axis in range(axes)
        for sign, at in ((1, box.low[axis]), (-1, box.high[axis]))
    )


def innermost(planes: Iterable[Plane]) -> tuple[np.ndarray, np.ndarray]:
    """Highest plane that objects stay above and lowest that they stay below, across each axis [m], each of shape (3,); infinite
    where there is none."""
    low, high = np.full(3, -np.inf), np.full(3, np.inf)
    for plane in planes:
        if plane.sign > 0:
            low[plane.axis] = max(low[plane.axis], plane.at)
        else:
            high[plane.axis] = min(high[plane.axis], plane.at)
    return low, high
