# SPDX-License-Identifier: GPL-2.0-only
"""Objects that stand still on something at the start: they do not fall."""

from __future__ import annotations

import math

import numpy as np

from ..model.boxes import box_pairs
from ..model.overlap import BORN_AT_REST
from ..model.system import System, centers
from ..scene.scene import Box
from .acting import Acting

LEVEL = 1e-6
"""Tangent of gravity to what is level, and of an axis to upright, that is nothing but rounding."""


def standing(acting: Acting, system: System) -> np.ndarray:
    """Solids that are at rest at the start, on a floor, on an upright cuboid that never moves, or on one that stands itself, with
    their centre of mass above it, and that nothing else holds; bool, shape (M,). None where nothing pulls along -z, or something
    along x or y.
    """
    found = np.zeros(len(system.names), bool)
    least, most = acting.accelerations
    (x, y, _), z = np.maximum(np.abs(least), np.abs(most)), float(most[2])
    if z >= 0.0 or math.hypot(x, y) > -LEVEL * z:
        return found
    low, high = system.bounds(system.position)
    slowest, fastest = system.bounds(system.velocity)
    calm = ~system.still & ~acting.acted_on & ~slowest.any(axis=1) & ~fastest.any(axis=1)
    near = BORN_AT_REST * system.spacing
    for plane in acting.planes:
        if plane.axis == 2 and plane.sign > 0 and plane.motion is None:
            found |= calm & (np.abs(low[:, 2] - plane.at) <= near)
    flat = np.array(
        [isinstance(s.shape, Box) and np.abs(np.array(s.rotation))[2].max() > 1.0 - LEVEL for s in acting.scene.solids]
    )
    middle = centers(system.mass, system.first[:-1], system.position)[:, :2]
    pairs = list(box_pairs(low - near[:, None], high + near[:, None]))
    i, j = (np.concatenate([np.zeros(0, int), *(both[k] for both in pairs)]) for k in (0, 1))
    below, above = np.concatenate([i, j]), np.concatenate([j, i])
    close = np.maximum(near[below], near[above])
    bears = flat[below] & calm[above] & (np.abs(high[below, 2] - low[above, 2]) <= close)
    bears &= ((low[below, :2] <= middle[above]) & (middle[above] <= high[below, :2])).all(axis=1)
    below, above = below[bears], above[bears]
    for n in np.argsort(low[above, 2], kind="stable").tolist():
        found[above[n]] |= system.still[below[n]] or found[below[n]]
    return found
