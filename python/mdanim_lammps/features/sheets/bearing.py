# SPDX-License-Identifier: GPL-2.0-only
"""Whether a sheet that is held bears what comes onto it, or its particles are pressed through to the other side.

Particles are the only contacts of a sheet: springs k = kappa w of the depth d below the surface of the other object. Where the
object is half through, those in its cross-section A hold U = k/h^2 int_A d^2/2 dA, at most; for a ball of radius R
pi k R^4/(12 h^2). An object with more energy than that may come out on the other side.
"""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import shapes
from ...scene.formatting import number, say
from ...scene.scene import Box, Solid
from ..contact.rigid_surfaces import moduli
from ..contact.surface import LINE, own_area
from ..contact.words import CONTACT_STIFFNESS
from ..tearing.words import tears
from .words import finest

ACROSS = 32
"""Places along either axis of a cross-section."""
ASIDE = 2.0
"""U over what particles hold of what is not a cuboid: it pushes them aside as well, where the sheet is about as soft."""
SURE = 2.0
"""Energy over U above which an object goes through: the sheet takes a part by itself, as a trampoline, so that up to here some
are borne."""
SPARE = 1.1
"""Over the least stiffness or number of particles, in what is to be written."""


def pressed_through(envelope: Envelope, sheets: np.ndarray) -> list[Problem]:
    """The sheet that is held somewhere, by number, and the object that it bears least, where it may not bear it: a warning, or a
    note where it may yet, and of a sheet that tears, which is to let things through."""
    system, found = envelope.system, []
    low, high = system.bounds(system.position)
    swept = envelope.reach.region
    free = ~system.bare & ~system.held_whole & ~system.still
    held = np.logical_or.reduceat(system.held, system.first[:-1])
    for sheet in sheets[held[sheets]].tolist():
        near = ((swept.low[sheet] < swept.high) & (swept.low < swept.high[sheet])).all(axis=1) & free
        pairs = [(min(k, sheet), max(k, sheet)) for k in np.flatnonzero(near).tolist()]
        for other in (sum(pair) - sheet for pair in pairs if pair not in swept.passing):
            comes, bears = energy_of(envelope, sheet, other, low, high), borne_by(envelope, sheet, other)
            if comes > bears:
                found.append((comes / bears, sheet, other, comes, bears))
    return [_warning(envelope, *max(found))] if found else []


def energy_of(envelope: Envelope, sheet: int, other: int, low: np.ndarray, high: np.ndarray) -> float:
    """Energy with which an object comes to be half through a sheet [J]: that of its start, and of its fall where it is above.

    ``low`` and ``high`` are the bounds of all objects at the start [m], shape (M, 3)."""
    system, mass = envelope.system, float(envelope.system.mass_of[other])
    velocity = system.center_of_mass(system.velocity)
    energy = 0.5 * mass * float(((velocity[other] - velocity[sheet]) ** 2).sum())
    over = (low[other, :2] < high[sheet, :2]).all() and (low[sheet, :2] < high[other, :2]).all()
    middle = 0.5 * (low + high)[:, 2]
    if not over or middle[other] < middle[sheet]:
        return energy
    return energy + mass * envelope.reach.g * float(middle[other] - middle[sheet])


def borne_by(envelope: Envelope, sheet: int, other: int) -> float:
    """Energy that the particles of a sheet hold where an object is half through [J]."""
    context, system = envelope.context, envelope.system
    young, own = moduli(context), system.object == sheet
    pair = 2.0 * young[sheet] * young[other] / (young[sheet] + young[other])
    kappa = LINE * context.scene.control.contact_stiffness * pair / np.cbrt(system.cell_volume[sheet])
    per_area = kappa * float(own_area(system)[own].max()) / float(system.spacing[sheet]) ** 2
    radius = system.frames[system.contact_kind[sheet]].contact.radius
    return per_area * _half_through(envelope.scene.solids[other], radius)


def _half_through(solid: Solid, radius: float) -> float:
    """int_A d^2/2 dA over the level cross-section through the middle of an object as it is placed [m^4], for round points of this
    radius [m]. A cuboid is left by the side that was met first."""
    turn = np.asarray(solid.rotation, float)
    low, high = shapes.extent(solid.shape)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    reach = np.abs(turn) @ half
    step = (np.arange(ACROSS) + 0.5) / ACROSS * 2.0 - 1.0
    x, y = np.meshgrid(reach[0] * step, reach[1] * step, indexing="ij")
    place = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]) @ turn + middle
    depth = shapes.depth(solid.shape, place)
    cuboid = isinstance(solid.shape, Box)
    pressed = np.where(depth > 0.0, float(half.min()) if cuboid else depth + radius, 0.0)
    return float((pressed**2).sum()) * 2.0 * reach[0] * reach[1] / ACROSS**2 / (1.0 if cuboid else ASIDE)


def _warning(envelope: Envelope, over: float, sheet: int, other: int, comes: float, bears: float) -> Problem:
    system, names, control = envelope.system, envelope.system.names, envelope.scene.control
    h, more = float(system.spacing[sheet]), SPARE * over
    stiffness, fine = control.contact_stiffness * more, h / np.sqrt(more)
    ways = [f"resolution {say(fine, 'm')} in {names[sheet]}"] if fine >= finest(envelope.scene.solids[sheet].shape) else []
    if stiffness <= CONTACT_STIFFNESS.most:
        ways.append(f"contact-stiffness {number(stiffness, 2)} in control")
    return Problem(
        envelope.place(other, "shape"),
        f"{names[other]} may fall through {names[sheet]}: it comes with {say(comes, 'J')}, and particles of {names[sheet]} that "
        f"are {say(h, 'm')} apart bear {say(bears, 'J')} before they are pressed through it",
        "write " + ", or ".join(ways) if ways else f"make {names[other]} lighter or slower, or {names[sheet]} thicker",
        severity="warning" if over > SURE and not tears(envelope.scene.solids[sheet]) else "note",
    )
