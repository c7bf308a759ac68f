# SPDX-License-Identifier: GPL-2.0-only
"""Rigid balls in a row that touch, which share a blow: what ``check`` tells of them."""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...scene.scene import Sphere

GAP = 2e-3
"""Gap of two balls over their mean diameter below which they touch."""
STRAIGHT = -0.98
"""Cosine between the ways from a ball to both of its neighbours below which the three are a row."""


def notes(envelope: Envelope) -> list[Problem]:
    """One note, for the first rigid ball with exactly two others in touch, on opposite sides."""
    solids = envelope.scene.solids
    free = envelope.system.rigid & envelope.reach.free
    balls = [m for m in np.flatnonzero(free) if isinstance(solids[m].shape, Sphere)]
    if len(balls) < 3:
        return []
    centre = np.array([solids[m].position for m in balls])
    radius = np.array([solids[m].shape.radius for m in balls])
    for k, m in enumerate(balls):
        way = centre - centre[k]
        far, both = np.linalg.norm(way, axis=1), radius + radius[k]
        near = np.flatnonzero((far < (1.0 + GAP) * both) & (np.arange(len(balls)) != k))
        if len(near) != 2 or way[near[0]] @ way[near[1]] > STRAIGHT * far[near].prod():
            continue
        return [
            Problem(
                solids[m].spans.get("position"),
                f"{solids[m].name} is in a row of balls that touch: these share a blow as springs in a row do, so all of them "
                "move on, where one is to go out for one that comes in (docs/physics-rigid.md#restitution)",
                "leave gaps of a hundredth of a ball between them, as scenes/newton.txt does, if it is to be Newton's cradle",
                severity="note",
            )
        ]
    return []
