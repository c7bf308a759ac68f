# SPDX-License-Identifier: GPL-2.0-only
"""Elastic objects that no one would see bend: they may as well be rigid (docs/physics-rigid.md, "Which objects")."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from ...bodies import kind_of
from ...effects.context import Context
from ...effects.envelope import Envelope
from ...effects.proposal import Proposal
from ...model import shapes
from ...model.overlap import BORN_AT_REST
from ...reach.standing import LEVEL
from ...scene.formatting import number
from ...scene.naming import bare_name, told_together
from ...scene.scene import Box, Cylinder, SceneRecord, Solid
from ..contact.pairs import damping, frictions
from ..contact.rigid_surfaces import loads, struck_at
from ..contact.words import ContactModel
from ..springs import measure as springs
from ..springs.strength import folds_at, spots
from .strains import Strains
from .words import SENSELESS, Rigid

LADDER = "rigid"
"""Name of the ladder of studies (vary.py)."""
STRAIN = 0.15
"""Largest strain that is not seen: it is at the spot where an object is struck. Of bricks, dominoes, stones and billiard balls of
scenes/ it is up to 0.13, of jelly, rubber balls and all that is thrown and visibly pressed flat 0.19 and more."""
STRAY = 0.015
"""Distance from a rigid motion over the size, root mean square over particles and frames, that is not seen: a bar that sags by a
twentieth of its length is 0.015 off."""
SAG = 0.05
"""Sag of a bar that lies at its ends over its length, before the run."""
BORNE = 0.8
"""Part of either side of a flat object that one flat thing below it takes, so that what is above it does not bend it."""
BLOW = 0.7
"""Fastest blow that will not be seen, over the one that folds up the spot where an object is struck: up to 0.69 of the objects of
scenes/ that strained by less than STRAIN, and 0.9 or more of those that strained by more."""
BAR = 5.0 * 12.0 / 384.0
"""Sag of a bar with ends that are free to turn over its length, over (rho g L/E) (L/t)^2: 5 q L^4/(384 E I) with I = w t^3/12."""


def before(envelope: Envelope) -> Proposal | None:
    """Objects that will not be seen to bend, by what may strike them, and by their weights and those above them."""
    context, system = envelope.context, envelope.system
    found = groups(context.scene)
    if not found:
        return None
    solids, free = context.solids, np.flatnonzero(~system.still)
    meets = len(system.names) > 1 or len(envelope.planes) > 0
    blow = struck_at(context, system) / envelope.reach.wave if meets else np.zeros(len(solids))
    size = np.array([_size(s) for s in solids])
    thin = np.array([shapes.thickness(s.shape) for s in solids])
    weight = system.density * envelope.reach.g * size / system.young
    sag = BAR * weight * (size / thin) ** 2
    sag[free] *= np.where(_lies_flat(context)[free], 1.0, loads(system, free, context.reach.body))
    fine = (blow <= BLOW * folds_at(spots(envelope))) & (sag <= SAG)
    return _proposal(
        context.scene,
        found,
        fine,
        lambda m: f"struck at {_percent(blow[m])} of its wave speed at most, sags by at most {_percent(sag[m])} of its length",
        "estimated from blows and weights at the start",
    )


def after(context: Context, trajectory: Any) -> Proposal | None:
    """Objects that were not seen to bend in a run, by a results.trajectory.Trajectory."""
    found = groups(context.scene)
    if not found or len(trajectory) < 2:
        return None
    chosen = np.sort(np.concatenate(list(found.values())))
    strains = Strains(trajectory, chosen)
    largest, stray = np.zeros(len(context.solids)), np.zeros(len(context.solids))
    largest[chosen] = strains.largest()
    stray[chosen] = strains.strays() / [_size(context.solids[m]) for m in chosen.tolist()]
    return _proposal(
        context.scene,
        found,
        (largest <= STRAIN) & (stray <= STRAY),
        lambda m: f"largest strain {_percent(largest[m])}, {_percent(stray[m])} of its size off a rigid motion",
        "measured in the frames of the run",
    )


def groups(scene: SceneRecord) -> dict[str, np.ndarray]:
    """Groups of like objects, by their names without indices, that may be rigid as far as their words go: numbers of solids,
    ascending."""
    if scene.control.contact_model is not ContactModel.SURFACE:
        return {}
    found: dict[str, list[int]] = {}
    for m, solid in enumerate(scene.solids):
        found.setdefault(bare_name(solid.name), []).append(m)
    looked_at = {e.subject for e in scene.asked if e.key in springs.MEASURES}
    free = [_may_be(s, s.name in looked_at, takes) for s, takes in zip(scene.solids, _take_energy(scene))]
    return {name: np.array(of) for name, of in found.items() if all(free[m] for m in of)}


def as_rigid(scene: SceneRecord, chosen: Iterable[int]) -> SceneRecord:
    """The scene with these solids rigid."""
    rigid = set(chosen)
    solids = (replace(s, elasticity=Rigid(), damping=0.0) if m in rigid else s for m, s in enumerate(scene.solids))
    return replace(scene, solids=tuple(solids))


def _take_energy(scene: SceneRecord) -> list[bool]:
    """Whether contacts of each solid, were it rigid, take energy of blows: by the restitution of the scene, or where it has
    friction."""
    if scene.control.restitution is not None:
        return [scene.control.restitution < 1.0] * len(scene.solids)
    return [mu > 0.0 and damping(scene) > 0.0 for mu in frictions(scene)]


def _may_be(solid: Solid, is_looked_at: bool, takes: bool) -> bool:
    """Whether nothing that is said of an object needs its springs: it is not a rope, no part is held, no `expect` asks for what
    springs tell, and damping has a dashpot of the contact to take its place."""
    kind = kind_of(solid)
    if solid.hold or not (kind.deforms and kind.fills) or is_looked_at:
        return False
    return not any(getattr(solid, word) and (word != "damping" or not takes) for word in SENSELESS)


def _lies_flat(context: Context) -> np.ndarray:
    """Objects that lie with a flat side on level ground or along most of another flat side at the start, bool, shape (M,): what
    is above them presses them together, and does not bend them."""
    system, planes = context.reach.system, context.reach.acting.planes
    low, high = system.bounds(system.position)
    near = BORN_AT_REST * system.spacing
    flat = np.array([_is_level(s) for s in context.solids])
    found = np.zeros(len(flat), bool)
    for plane in (p for p in planes if p.axis == 2 and p.sign > 0 and p.motion is None):
        found |= flat & (abs(low[:, 2] - plane.at) <= near)
    for m in np.flatnonzero(flat & ~found).tolist():
        shared = np.minimum(high[:, :2], high[m, :2]) - np.maximum(low[:, :2], low[m, :2])
        along = (shared >= BORNE * (high[m, :2] - low[m, :2])).all(axis=1)
        found[m] = (flat & along & (abs(high[:, 2] - low[m, 2]) <= np.maximum(near, near[m]))).any()
    return found


def _is_level(solid: Solid) -> bool:
    """Whether the upper and the lower side of an object are flat and level."""
    down = abs(np.array(solid.rotation)[2])
    if isinstance(solid.shape, Box):
        return bool(down.max() > 1.0 - LEVEL)
    return isinstance(solid.shape, Cylinder) and bool(down[2] > 1.0 - LEVEL)


def _size(solid: Solid) -> float:
    """Largest side of the box around a shape along its own axes [m]."""
    low, high = shapes.extent(solid.shape)
    return float(np.max(np.subtract(high, low)))


def _percent(values: np.ndarray) -> str:
    return f"{number(100.0 * float(np.max(values)), 2)} %"


def _proposal(
    scene: SceneRecord, found: dict[str, np.ndarray], fine: np.ndarray, tells: Callable[[np.ndarray], str], how: str
) -> Proposal | None:
    kept = [of for of in found.values() if fine[of].all()]
    if not kept:
        return None
    names = [s.name for s in scene.solids]
    told = tuple((told_together([names[m] for m in of.tolist()]), tells(of)) for of in kept)
    return Proposal("elasticity rigid", told, how, as_rigid(scene, np.concatenate(kept).tolist()), LADDER)
