# SPDX-License-Identifier: GPL-2.0-only
"""Rigid objects that turn on the spot, which friction brakes too hard: what ``check`` tells of them."""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...scene.scene import Ellipsoid, Sphere, Torus
from ..contact.pairs import frictions

UPRIGHT = 0.9
"""Share of a spin about the upright axis from which something turns on the spot."""
BROAD = 0.5
"""Length of what an object stands on over its own, from which it does not stand on a point."""
NEAR = 0.1
"""Gap below an object over its height with which it stands."""


def notes(envelope: Envelope) -> list[Problem]:
    """One note, for the first rigid object that stands broadly, has friction and is given a spin about the upright axis."""
    scene, system = envelope.scene, envelope.system
    if envelope.reach.g <= 0.0 or scene.ground is None:
        return []
    friction = frictions(scene, "ground")
    for m in np.flatnonzero(system.rigid & envelope.reach.free):
        solid = scene.solids[m]
        spin = np.linalg.norm(solid.spin)
        if (
            isinstance(solid.shape, (Sphere, Ellipsoid, Torus))
            or not friction[m]
            or not spin
            or abs(solid.spin[2]) < UPRIGHT * spin
        ):
            continue
        at = system.position[system.first[m] : system.first[m + 1]]
        if not _stands_broadly(at, scene.ground, system.spacing[m]):
            continue
        return [
            Problem(
                solid.spans.get("spin"),
                f"{solid.name} turns on the spot: a rigid object bears its weight at corners and rims alone, so friction brakes "
                "such a turn 1.5 times too hard (discs) to twice (long sides) (docs/physics-rigid.md#turning-on-the-spot)",
                "leave elasticity rigid out, which bears weight all over the face, or write two thirds of the friction",
                severity="note",
            )
        ]
    return []


def _stands_broadly(at: np.ndarray, ground: float, spacing: float) -> bool:
    """Whether particles at these places [m], shape (N, 3), stand on the ground by more than a point."""
    low, height = at[:, 2].min(), np.ptp(at[:, 2])
    foot = at[at[:, 2] <= low + NEAR * height]
    width, of_foot = (np.ptp(part[:, :2], axis=0).max() for part in (at, foot))
    return low - ground <= NEAR * height + spacing and of_foot >= BROAD * width
