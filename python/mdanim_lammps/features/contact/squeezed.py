# SPDX-License-Identifier: GPL-2.0-only
"""Stress of what something driven squeezes, of which contact takes a part of the way: what ``check`` tells of it."""

from __future__ import annotations

import math

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem

DEEP = 0.25
"""Depth of a face in another one, in spacings, over the root of pressure by stiffness times Young's modulus (docs/physics-
contact.md)."""
STRAIN, TOLD = 0.05, 0.05
"""Strain for which the note tells the stress, and the share of it that is told when it is missing."""


def borne(strain: float, cells: float, stiffness: float) -> float:
    """Share of the stress E * strain that a body bears between two faces that come nearer by ``strain`` times its length, as
    contact gives way. ``cells`` are those along its length.

    Pressure p over E is s, each face sinks in by DEEP h (s/stiffness)^1/2: s + 2 DEEP (s/stiffness)^1/2/cells = strain.
    """
    half = DEEP / (cells * math.sqrt(stiffness))
    return (math.sqrt(half**2 + strain) - half) ** 2 / strain


def notes(envelope: Envelope) -> list[Problem]:
    """One note, for the first elastic object whose stress is asked for and that something driven may press."""
    scene, system = envelope.scene, envelope.system
    driven = np.flatnonzero([bool(solid.drive or solid.key_points) for solid in scene.solids])
    asked = {of.subject for of in scene.asked if of.quantity.startswith("stress.")}
    for m in np.flatnonzero(~(system.rigid | system.held_whole | system.bare)).tolist():
        name, spans = system.names[m], scene.solids[m].spans
        others = driven[driven != m]
        if name not in asked or not envelope.reach.region.may_touch(np.full(len(others), m), others).any():
            continue
        missing = 1.0 - borne(STRAIN, envelope.cells[m], scene.control.contact_stiffness)
        if missing < TOLD:
            continue
        cause = (
            f"{name} may be pressed by what is driven: faces sink in where they touch, so between two faces that "
            f"squeeze it across its thinnest part by {100.0 * STRAIN:.0f} % its stress is {100.0 * missing:.0f} % too low, "
            "by less more (docs/physics-contact.md#squeezed-by-a-given-way)"
        )
        way_out = "write a larger contact-stiffness or a finer resolution; a load by weight or force is borne in full"
        return [Problem(spans.get("elasticity"), cause, way_out, severity="note")]
    return []
