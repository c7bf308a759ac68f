# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on gravity."""

from __future__ import annotations

from ...effects.envelope import Envelope
from ...errors import Problem
from ...scene.formatting import vector


def notes(envelope: Envelope) -> list[Problem]:
    """Whether all that moves rises from the ground."""
    scene = envelope.scene
    if scene.ground is None or scene.gravity[2] <= 0.0 or any(g[2] <= 0.0 for _, g in scene.gravity_path):
        return []
    down = vector(tuple(-abs(x) if n == 2 else x for n, x in enumerate(scene.gravity)))
    cause = "gravity points up, and the ground is below: objects rise and do not come back"
    return [Problem(scene.spans.get("gravity"), cause, f"z is up: write gravity {down} m/s^2", severity="note")]
