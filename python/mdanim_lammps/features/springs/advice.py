# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on what lattices are known to get wrong, where a scene meets it."""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model.shapes import thickness
from ...scene.formatting import number, say
from ...scene.scene import Box
from ..joints.links import links_of

STIFF = 2.5
"""How much too stiff a square bar is against twist, times the square of its cells across: 0.59 with 2, 0.165 with 4, 0.038 with 8
(docs/physics-solids.md)."""
TOLD = 0.05
"""How much of it is told."""


def notes(envelope: Envelope) -> list[Problem]:
    """On the first bar of few cells that a torque twists."""
    for m in np.flatnonzero(~(envelope.system.rigid | envelope.system.held_whole | envelope.system.bare)).tolist():
        solid, cells = envelope.scene.solids[m], envelope.cells[m]
        more = STIFF / max(cells, 1.0) ** 2
        if isinstance(solid.shape, Box) and more > TOLD and _twisted(envelope, m):
            enough = thickness(solid.shape) / np.ceil(np.sqrt(STIFF / TOLD))
            stiff = f"a bar is {100 * more:.0f} % too stiff against twist (docs/physics-solids.md#masses)"
            cause = f"{solid.name} has {number(cells, 2)} cells across, with which {stiff}"
            return [Problem(solid.spans.get("torque"), cause, f"write resolution {say(enough, 'm')} in it", severity="note")]
    return []


def _twisted(envelope: Envelope, m: int) -> bool:
    """Whether a part of a solid is held, or joined, and a torque turns the rest, mostly about its longest axis."""
    system, solid = envelope.system, envelope.scene.solids[m]
    rows = slice(*system.first[m : m + 2])
    if not solid.torque or not (system.held[rows].any() or any(m in link.ends for link in links_of(envelope.scene).all)):
        return False
    x = system.position[rows] - system.position[rows].mean(axis=0)
    along = np.linalg.eigh(x.T @ x)[1][:, -1]
    return any(abs(along @ one.vector) > np.linalg.norm(one.vector) / 2.0 for one in solid.torque)
