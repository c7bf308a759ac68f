# SPDX-License-Identifier: GPL-2.0-only
"""Rigid balls in a row that touch, which share a blow: what ``check`` tells of them."""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model.boxes import box_pairs
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
    centre = np.array([solids[m].position for m in balls]).reshape(-1, 3)
    radius = np.array([solids[m].shape.radius for m in balls])
    reach = (1.0 + GAP) * radius[:, None]
    found = list(box_pairs(centre - reach, centre + reach)) if balls else []
    i, j = np.concatenate([np.stack(pair) for pair in found], axis=1) if found else np.zeros((2, 0), int)
    way = centre[j] - centre[i]
    far = np.linalg.norm(way, axis=1)
    touch = far < (1.0 + GAP) * (radius[i] + radius[j])
    one, to = np.concatenate([i[touch], j[touch]]), np.concatenate([way[touch], -way[touch]])
    to /= np.linalg.norm(to, axis=1)[:, None]
    for k in np.flatnonzero(np.bincount(one, minlength=len(balls)) == 2).tolist():
        if np.prod(to[one == k], axis=0).sum() > STRAIGHT:
            continue
        m = balls[k]
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
