# SPDX-License-Identifier: GPL-2.0-only
"""The planes that push objects back: ground, walls, floor and sides of a basin."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..scene.scene import SceneRecord

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


def scene_planes(scene: SceneRecord) -> tuple[Plane, ...]:
    """Every plane that a scene names, whether its effect is on or not."""
    planes = []
    if scene.ground is not None:
        planes.append(Plane("ground", "the ground", 2, 1, scene.ground, "below the ground"))
    if scene.walls is not None:
        planes += [_side("walls", axis, *side) for axis in range(3) for side in _sides(scene.walls, axis)]
    if scene.liquid is not None:
        planes += [_side("basin", axis, *side) for axis in range(2) for side in _sides(scene.liquid, axis)]
        planes.append(Plane("basin", "the basin", 2, 1, scene.liquid.low[2], "below the floor of the basin"))
    return tuple(planes)


def _sides(box, axis: int) -> tuple[tuple[int, float], ...]:
    return (1, box.low[axis]), (-1, box.high[axis])


def _side(effect: str, axis: int, sign: int, at: float) -> Plane:
    return Plane(effect, f"the {effect}", axis, sign, at, f"outside the {effect} at {'-' if sign > 0 else '+'}{AXES[axis]}")


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
