# SPDX-License-Identifier: GPL-2.0-only
"""Objects that come to rest on others and on slopes: what ``check`` tells of friction."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import shapes
from ...model.boxes import nearest_boxes, overlaps_in_plan
from ...model.planes import Plane
from ...model.system import System
from ...scene.formatting import number
from ...scene.scene import Box, SceneRecord, Solid
from .pairs import any_friction, frictions, pair_rules
from .words import ContactModel

LEVEL = 1e-6
"""Tangent of a slope that is nothing but rounding."""


class Slope(NamedTuple):
    """An object that may slide, and the slope under it."""

    tangent: float
    friction: float
    object: int
    word: str
    """Word of the slope in a contact block."""
    name: str
    """Name of the slope in a message."""


def frictionless(envelope: Envelope) -> list[Problem]:
    """Note that objects will slide, once, where some may come to rest and nothing has friction."""
    scene, system = envelope.scene, envelope.system
    free = envelope.reach.free & ~envelope.reach.acting.acted_on
    if any_friction(scene) or envelope.reach.acting.changes or envelope.reach.g <= 0.0 or not free.any():
        return []
    sinks = (free & (envelope.reach.weight_left > 0.0)).any()
    if not any(sinks or p.effect != "basin" for p in floors(envelope)):
        low, high = system.bounds(system.position)
        holding = np.logical_or.reduceat(system.held, system.first[:-1])
        met = any(e.keeps_apart for e in envelope.on) and holding.any()
        if not met or low[holding, 2].min() >= high[free, 2].max():
            return []
    paper = scene.control.contact_model is ContactModel.PAPER
    hint = f"write friction 0.5 in control{' in place of contact-model paper' if paper else ''}"
    hint += _against_hops(envelope)
    return [
        Problem(
            scene.control.spans.get("contact-model") or scene.control.spans.get("control"),
            f"contacts are frictionless{', as in the paper' if paper else ''}: objects slide off what they stand or lie on",
            hint,
            severity="note",
        )
    ]


def _against_hops(envelope: Envelope) -> str:
    """Addition to a hint, where nothing that moves loses energy in blows: damping of an object that deforms, or restitution."""
    system, scene = envelope.system, envelope.scene
    if not ((envelope.context.damping_ratio == 0.0) | ~envelope.reach.free).all():
        return ""
    if (soft := np.flatnonzero(envelope.reach.free & ~system.rigid)).size:
        return f", and damping 0.2 in object {system.names[soft[0]]}: without damping an object that lands keeps hopping"
    given = (scene.control.restitution, *(part.restitution for part in (*scene.solids, *scene.contacts)))
    return (
        ""
        if any(e is not None for e in given)
        else ", or restitution 0.3: without either a rigid object that lands keeps hopping"
    )


def slopes(envelope: Envelope) -> list[Problem]:
    """The object that slides worst because a slope is steeper than its friction holds. Without friction it is meant to slide."""
    if envelope.reach.acting.changes or envelope.reach.g <= 0.0 or not envelope.reach.moving.any():
        return []
    found, own = _Slopes(envelope), np.array(frictions(envelope.scene))
    steep = [s for s in (*found.on_floors(), *found.on_solids(own)) if s.tangent > s.friction]
    if not steep:
        return []
    worst = max(steep, key=lambda s: s.tangent / s.friction)
    name = envelope.system.names[worst.object]
    return [
        Problem(
            envelope.place(worst.object, "friction", "object"),
            f"{name} will slide on {worst.name}: its slope has a tangent of {number(worst.tangent, 2)}, "
            f"friction is {number(worst.friction, 2)}",
            f"write contact {worst.word} {name} {{ friction {number(math.ceil(11.0 * worst.tangent) / 10.0, 2)} }} "
            "where it is to stay",
            severity="note",
        )
    ]


def one_sided(scene: SceneRecord, system: System, passing: Sequence[tuple[int, int]] = ()) -> list[Problem]:
    """Warning that friction of one object is 0 against others that have none: once, for the pair that is nearest at the start.

    A warning where that is within a spacing, else a note. ``passing``: pairs i < j that may be in each other, which never touch.
    """
    solids, own = scene.solids, np.array(frictions(scene))
    rough = np.array([bool(s.friction) for s in solids])
    smooth = np.array([s.friction is None for s in solids]) & (own == 0.0)
    if not rough.any() or not smooth.any():
        return []
    told = {*passing, *((i, j) for i, j, _, _ in pair_rules(scene, system.names))}
    low, high = system.bounds(system.position)

    def counts(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        right = rough[i] & smooth[j] & ~(system.still[i] & system.still[j]) & ~(system.bare[i] & system.bare[j])
        for k in np.flatnonzero(right).tolist() if told else ():
            right[k] = (min(i[k], j[k]), max(i[k], j[k])) not in told
        return right

    found = nearest_boxes(low, high, counts)
    if found is not None and (far := found[0] > float(system.spacing[list(found[1:])].max()) ** 2):
        # The friction of a material counts for what is near alone: the scene does not say it.
        rough &= np.array([s.spans.get("friction") != s.spans.get("material") for s in solids])
        found = nearest_boxes(low, high, counts)
    if found is None:
        return []
    pair = list(found[1:])
    one, other, mu = *(solids[m].name for m in pair), number(own[pair[0]])
    return [
        Problem(
            solids[pair[0]].spans.get("friction"),
            f"friction {mu} of {one} works as 0 against {other}, which has none: two objects have the root of the product",
            f"write friction {mu} in control, or contact {one} {other} {{ friction {mu} }}; or friction 0 in {other}",
            severity="note" if far else "warning",
        )
    ]


def floors(envelope: Envelope) -> list[Plane]:
    """Planes that objects may lie on."""
    return [p for p in envelope.planes if p.axis == 2 and p.sign > 0]


class _Slopes:
    """Finds every slope, for the object there that has the least friction above 0."""

    def __init__(self, envelope: Envelope):
        self.envelope, self.scene = envelope, envelope.scene
        self.gravity = np.array(self.scene.gravity)
        rolling = np.array([shapes.LAWS[type(s.shape)].rolls for s in self.scene.solids])
        self.sliding = envelope.reach.moving & ~rolling & ~envelope.reach.acting.acted_on

    def on_floors(self) -> Iterator[Slope]:
        tangent = math.hypot(*self.gravity[:2]) / -self.gravity[2]
        for plane in floors(self.envelope) if tangent > LEVEL else ():
            mu = np.array(frictions(self.scene, plane.effect))
            yield from self._worst(tangent, mu[self.sliding], np.flatnonzero(self.sliding), plane.effect, plane.name)

    def on_solids(self, own: np.ndarray) -> Iterator[Slope]:
        """Cuboids that never move, and what is above each at the start; ``own`` friction of each object, shape (M,)."""
        system = self.envelope.system
        if not any(e.keeps_apart for e in self.envelope.on):
            return
        up = -self.gravity / np.linalg.norm(self.gravity)
        low, high = system.bounds(system.position)
        told: dict[int, dict[int, float]] = {}
        for i, j, mu, _ in pair_rules(self.scene, system.names):
            told.setdefault(i, {})[j] = told.setdefault(j, {})[i] = mu
        tangents = {k: t for k in np.flatnonzero(system.still).tolist() if (t := self._tangent(self.scene.solids[k], up)) > LEVEL}
        for k, near in sorted(overlaps_in_plan(low, high, np.array(list(tangents), int)), key=lambda found: found[0]):
            above = near[self.sliding[near] & ((low + high)[near, 2] > low[k, 2] + high[k, 2])]
            usual, of_pairs = np.sqrt(own[above] * own[k]), told.get(k, {})
            mu = np.array([of_pairs.get(m, mu) for m, mu in zip(above.tolist(), usual.tolist())])
            yield from self._worst(tangents[k], mu, above, *2 * (self.scene.solids[k].name,))

    def _tangent(self, solid: Solid, up: np.ndarray) -> float:
        """Slope of the side of a cuboid that is nearest to level, 0 of other shapes; ``up`` is against gravity."""
        if not isinstance(solid.shape, Box):
            return 0.0
        cosine = float(np.abs(up @ np.array(solid.rotation)).max())
        return math.sqrt(max(0.0, 1.0 - cosine**2)) / cosine

    def _worst(self, tangent: float, mu: np.ndarray, among: np.ndarray, *names: str) -> Iterator[Slope]:
        """The slope for the object that slides most, of these numbers, with their friction, both of shape (K,)."""
        rough = np.flatnonzero(mu > 0.0)
        if len(rough):
            n = rough[mu[rough].argmin()]
            yield Slope(tangent, float(mu[n]), int(among[n]), *names)
