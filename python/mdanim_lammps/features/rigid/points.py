# SPDX-License-Identifier: GPL-2.0-only
"""Contacts of rigid objects that set the time step, because a part is thin or touches at points of its surface: which, and the
way out."""

from __future__ import annotations

import math

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import shapes
from ...model.polyhedron import MOST_CORNERS
from ...scene.formatting import estimate, number, say
from ..contact.rigid_surfaces import frequency
from . import touching
from .shapes import is_known

MUCH, MANY = 2.0, 20_000
"""Times as many steps from which on another shape is advised; steps from which on something thin is told of."""


def notes(envelope: Envelope) -> list[Problem]:
    """Notes on contacts of rigid objects that set the time step."""
    return [] if envelope.scene.control.timestep is not None else [*_at_points(envelope), *_thin(envelope)]


def _thin(envelope: Envelope) -> list[Problem]:
    """Note that one that is thinner than others sets the step of all."""
    found, rate = frequency(envelope.context), envelope.rates.get("rigid")
    total, steps = sum(envelope.rates.values()), envelope.scene.control.time / envelope.dt
    if found.thicker is None or rate is None or rate.max() < 0.5 * total.max() or steps < MANY:
        return []
    others = (total - rate).max() / rate.max()
    longer = math.sqrt(max((found.thicker / found.omega) ** 2, others))
    if longer > 1.0 / MUCH:
        return []
    solid = envelope.scene.solids[found.thinnest]
    body = envelope.reach.body
    is_part = bool((body == body[found.thinnest]).sum() > 1)
    softer = number(envelope.scene.control.contact_stiffness / 4.0, 2)
    return [
        Problem(
            envelope.place(found.thinnest, "shape"),
            f"{solid.name}, {say(shapes.thickness(solid.shape), 'm')} thin, sets the time step, of {estimate(steps)} steps; by "
            f"thicker rigid objects there would be {estimate(steps * longer)}",
            f"make it thicker{'' if is_part else ', weld it to something larger'}, or write contact-stiffness {softer} in "
            "control: half of the steps, and blows twice as deep",
            severity="note",
        )
    ]


def _at_points(envelope: Envelope) -> list[Problem]:
    """Note that the contact of a rigid object with another one, whose shape has no known features, sets the time step."""
    context, control, system = envelope.context, envelope.scene.control, envelope.system
    contact = next((e.name for e in envelope.on if e.keeps_apart), None)
    if contact not in envelope.rates:
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
