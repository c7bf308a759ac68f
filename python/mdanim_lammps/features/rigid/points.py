# SPDX-License-Identifier: GPL-2.0-only
"""Contacts of rigid objects at points of their surfaces, where they set the time step: which, and the way out."""

from __future__ import annotations

import math

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model.polyhedron import MOST_CORNERS
from ...scene.formatting import estimate
from . import touching
from .shapes import is_known

MUCH = 2.0
"""Times as many steps from which on another shape is advised."""


def notes(envelope: Envelope) -> list[Problem]:
    """Note that the contact of a rigid object with another one, whose shape has no known features, sets the time step."""
    context, control, system = envelope.context, envelope.scene.control, envelope.system
    contact = next((e.name for e in envelope.on if e.keeps_apart), None)
    if control.timestep is not None or contact not in envelope.rates:
        return []
    total = np.where(system.held, 0.0, sum(envelope.rates.values()))
    worst = int(total.argmax())
    m, others = int(system.object[worst]), total[~system.rigid[system.object]].max(initial=0.0)
    then = max(others, (touching.omega(context) / touching.STEP) ** 2)
    longer = math.sqrt(then / total[worst])
    found = _unknown(envelope, m)
    if not system.rigid[m] or envelope.rates[contact][worst] < 0.5 * total[worst] or longer > 1.0 / MUCH or found is None:
        return []
    strange, other = found
    steps, name = control.time / envelope.dt, system.names
    shape = type(envelope.scene.solids[strange].shape).__name__.lower()
    return [
        Problem(
            envelope.place(strange, "shape"),
            f"contact of {name[strange]} with {name[other]} sets the time step, of {estimate(steps)} steps: features of this "
            f"{shape} are not known to other objects, so points of its surface touch",
            f"write a box, or a convex mesh of at most {MOST_CORNERS} corners, in place of the {shape}, where it may be one: "
            f"{estimate(steps * longer)} steps",
            severity="note",
        )
    ]


def _unknown(envelope: Envelope, m: int) -> tuple[int, int] | None:
    """The solid without known features in the contact of a rigid one: that one or the nearest that meets it; and the other one
    of the pair. None where only what deforms meets it, or held cuboids in touch keep features off."""
    system, solids = envelope.system, envelope.scene.solids
    low, high = system.bounds(system.position)
    gap = np.linalg.norm(np.maximum(0.0, np.maximum(low - high[m], low[m] - high)), axis=1)
    known = np.array([is_known(solid) for solid in solids])
    partner = np.where(np.arange(len(gap)) != m, gap, np.inf)
    partner = np.where((system.rigid | system.still) & (~known if known[m] else True), partner, np.inf)
    nearest = int(partner.argmin())
    if not math.isfinite(partner[nearest]) or (known & system.still & ~touching.meets_objects(envelope.context)).any():
        return None
    return (nearest, m) if known[m] else (m, nearest)
