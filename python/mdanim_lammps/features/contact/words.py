# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field
from enum import Enum
from typing import Any

from ...errors import Span
from ...records import dataclass
from ...scene.formatting import whole
from ...scene.holding import all_held
from ...scene.limits import Limit
from ...scene.naming import objects_by_name, pairs_of
from ...scene.schema import Block, Observable, Rule, Words, setting

CONTACT_STIFFNESS = Limit(
    "contact-stiffness",
    100.0,
    0.1,
    "1 is as stiff as the material itself; 4 halves how deep objects sink in, for a shorter time step",
)
"""Softer, objects pass through each other before they are crushed; stiffer, only time is lost."""
FRICTION = Limit(
    "friction", 10.0, way_out="rubber on dry concrete has 1; above 10 objects stick to walls, as glue would hold them"
)
"""At 10 an object stays on a slope of 84 degrees."""
CONTACT_DAMPING = Limit("contact-damping", 1.0, way_out="1 is critical damping: nothing chatters any more")
RESTITUTION = Limit("restitution", 1.0, way_out="1 is a blow that loses nothing")
MOST_PAIRS = 10**5
"""Pairs of objects that all contact blocks of a scene name together."""

SWITCHES = {"contact": "two objects that can meet"}

WORLD = "world"
"""Subject of what never moves: ground, walls and all that is held."""

QUANTITIES = {
    ("penetration", "max"): Observable("m", "deepest overlap of two objects", bound=True),
    ("NAME", "contact"): Observable(
        "N",
        "magnitude of the force of contact, or of that with one thing alone: `ball.contact(ground)`",
        takes="touched",
        alone=True,
    ),
    **{
        ("NAME", f"contact.{axis}"): Observable(
            "N",
            f"force of contact with objects, ground and walls on an object, mean since the frame before, {axis}; that with one "
            f"thing alone is `ball.contact.{axis}(cube)`, which has no value where another way leads to that thing, as over the "
            "ground that both stand on",
            takes="touched",
            alone=True,
        )
        for axis in "xyz"
    },
    (WORLD, "contact"): Observable("N", "magnitude of the force of contact on ground, walls and all that is held together"),
    **{
        (WORLD, f"contact.{axis}"): Observable("N", f"force of contact on ground, walls and all that is held together, {axis}")
        for axis in "xyz"
    },
}

MARGINS = {
    "contact": "the time step that contact alone would bear, by its largest curvature over a plane (an estimate)",
    "wall": "the time step that ground, walls and basin alone would bear",
    "closing speed": "how fast objects may meet so that nothing passes through; softer or thinner objects bear less",
    "narrow part": "cells of what meets a held rod or plate, whose end or edge goes through wider ones (an estimate)",
    "slim tip": "height over radius of a held cone, whose tip goes through what falls on it beyond 3.3 (an estimate)",
}


class ContactModel(Enum):
    SURFACE = "surface"
    """The drawn surface is where objects touch; friction."""
    PAPER = "paper"
    """A barrier between boundary and inner particles, without friction."""


@dataclass(frozen=True, slots=True)
class ContactPair:
    """The rule of contact where some objects touch some others, or a plane."""

    first: str
    """An object, all objects of a repeat, ``ground``, ``walls`` or ``basin``."""
    second: str
    friction: float | None = setting(
        "<mu>", "Coefficient of friction of these two. Absent: sqrt(mu_A mu_B), or that of the object against a plane.",
        "0.1", Rule.NOT_NEGATIVE, default=None, limit=FRICTION)  # fmt: skip
    """mu [-]; None is that of the two objects."""
    contact_damping: float | None = setting(
        "<beta>", "Damping of their contact. Absent: that of `control`.",
        "0.1", Rule.NOT_NEGATIVE, default=None, limit=CONTACT_DAMPING)  # fmt: skip
    """Share of critical damping [-]; None is that of the scene."""
    restitution: float | None = setting(
        "<e>", "Restitution of their blows, in place of damping, where both are rigid or held. Absent: the lower one of the two.",
        "0.5", Rule.NOT_NEGATIVE, default=None, limit=RESTITUTION)  # fmt: skip
    """e [-]; None is that of the two objects."""
    rolling: float | None = setting(
        "<r:m>", "Arm of what resists their rolling, where both are rigid or held. Absent: the larger one of the two.",
        "0.5 mm", Rule.NOT_NEGATIVE, default=None)  # fmt: skip
    """r [m]; None is that of the two objects."""
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["contact"]`` is that of the names."""


class FrictionWords:
    """Settings of an object."""

    friction: float | None = setting(
        "<mu>",
        "Coefficient of friction; two objects in touch have sqrt(mu_A mu_B), an object has its own against ground, walls and "
        "basin. Not with `contact-model paper`. Absent: that of `control`.",
        "0.4", Rule.NOT_NEGATIVE, default=None, limit=FRICTION, after="drag", shared=True)  # fmt: skip
    """mu [-]; None is that of the scene."""
    restitution: float | None = setting(
        "<e>",
        "Coefficient of restitution, speed after a blow over the speed before it, of a rigid or held object on rigid and held "
        "ones, ground and walls; the lower one of two counts. Absent: that of `control`.",
        "0.8", Rule.NOT_NEGATIVE, default=None, limit=RESTITUTION, after="friction", shared=True)  # fmt: skip
    """e [-]; None is that of the scene."""
    rolling: float | None = setting(
        "<r:m>",
        "Rolling resistance of a rigid or held object: the arm of the torque that resists, over the force of the contact. What "
        "is round begins to roll on slopes steeper than r/R. The larger one of two counts. Absent: none.",
        "1 mm", Rule.NOT_NEGATIVE, default=None, after="restitution", shared=True)  # fmt: skip
    """r [m]; None is 0."""


OBJECT = FrictionWords


class ContactControl:
    """Settings of ``control``."""

    contact_stiffness: float = setting(
        "<factor>",
        "What objects, ground and walls push back with, over E h, the stiffness of the material behind a surface; from 0.1 to "
        "100. The stiffer it is, the less objects sink into each other, and the shorter time steps get.",
        "4", Rule.POSITIVE, default=1.0, limit=CONTACT_STIFFNESS, after="accuracy")  # fmt: skip
    """Stiffness with which objects and walls push back, over E h [-]."""
    contact_model: ContactModel = setting(
        None,
        "`surface`: objects touch where their drawn surfaces are, and may have friction. `paper`: the barrier of Wcislo 1999 "
        "between particles, which keeps objects about half a spacing apart, without friction.",
        "paper", default=ContactModel.SURFACE, codec=Words(ContactModel), after="contact_stiffness")  # fmt: skip
    friction: float = setting(
        "<mu>", "Coefficient of friction of objects that have none of their own. Not with `contact-model paper`.",
        "0.5", Rule.NOT_NEGATIVE, default=0.0, limit=FRICTION, after="contact_model")  # fmt: skip
    """mu [-]"""
    contact_damping: float | None = setting(
        "<beta>",
        "Damping of contacts that have friction, as a fraction of critical damping: it ends chatter. Not with `contact-model "
        "paper`. Absent: 0.3.",
        "0.3", Rule.NOT_NEGATIVE, default=None, limit=CONTACT_DAMPING, after="friction")  # fmt: skip
    """Share of critical damping where there is friction [-]; None is 0.3."""
    restitution: float | None = setting(
        "<e>", "Restitution of rigid objects that have none of their own. Absent: what `contact-damping` leaves.",
        "0.5", Rule.NOT_NEGATIVE, default=None, limit=RESTITUTION, after="contact_damping")  # fmt: skip
    """e [-]; None is what damping leaves."""


CONTROL = ContactControl


class ContactWords:
    """Rules of pairs in a scene."""

    contacts: tuple[ContactPair, ...] = ()


SCENE = ContactWords

BLOCKS = (
    Block("contact", ContactPair, "contacts", "What holds where two objects touch, instead of what follows from each: "
          "`contact ball floor { friction 0.1 }`. The name of a repeat without its index stands for all of its objects, that "
          "of a placed group for all in it; in a group its own objects are meant first. "
          "`ground`, `walls` and `basin` may stand for one of the two. No pair may be named twice.",
          names=("first", "second"), indexed=True, of_objects=True, many=True, in_group=True, order=20),
)  # fmt: skip


def points(scene: Any) -> bool:
    """Whether objects touch with points of their surfaces."""
    return scene.control.contact_model is ContactModel.SURFACE


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """The contact of the paper has neither friction nor damping, and one spacing for all objects; that of surfaces has damping
    where it has friction."""
    control = held["control"]
    if control is None:
        return
    own = next((s for s in held["solids"] if s.resolution is not None), None)
    if control.contact_model is ContactModel.PAPER and own:
        cause = f"{own.name} has a resolution of its own; the contact of the paper, between particles, needs one spacing for all"
        v.problem(
            own.spans["resolution"], cause, "write resolution in control, or take contact-model paper out", key="own-spacing"
        )
    _check_restitution(v, held)
    _check_rolling(v, held)
    blocks, words = v.blocks("contact"), {"friction": control.friction, "contact-damping": control.contact_damping}
    asked = [("a contact block", b.head) for b in blocks]
    asked += [("friction", s.spans["friction"]) for s in held["solids"] if s.friction]
    asked += [(word, control.spans[word]) for word, value in words.items() if value]
    if control.contact_model is ContactModel.PAPER and asked:
        what, span = asked[0]
        cause = f"{what} needs contact-model surface; the contact of the paper has no friction"
        v.problem(span, cause, "take contact-model paper out of control", key="contact-model")
    elif [what for what, _ in asked] == ["contact-damping"]:
        cause = "contact-damping of control acts where there is friction, and nothing in the scene has any"
        way_out = "write friction 0.5 in control, or contact-damping in a contact block"
        v.problem(control.spans["contact-damping"], cause, way_out, severity="warning")


def _check_restitution(v: Any, held: Mapping) -> None:
    """Blows of what is rigid or held alone have a restitution that can be promised."""
    hard = {s.name for s in held["solids"] if _is_rigid(s) or all_held(s)}
    way_out = "set damping in it, or write elasticity rigid"
    for solid in held["solids"]:
        if solid.restitution is not None and solid.name not in hard:
            cause = (
                f"{solid.name} is elastic: waves in it take part of a blow, so what is left follows from its shape and damping"
            )
            v.problem(solid.spans["restitution"], cause, way_out)
    by_name = objects_by_name(s.name for s in held["solids"])
    for contact in held["contacts"]:
        if contact.restitution is None:
            continue
        span = contact.spans["restitution"]
        named = [held["solids"][i].name for name in (contact.first, contact.second) for i in by_name.get(name, ())]
        if soft := next((name for name in named if name not in hard), None):
            v.problem(span, f"{soft} is elastic: what is left of a blow follows from its shape and damping", way_out)
        elif contact.contact_damping is not None:
            v.problem(span, "restitution and contact-damping of one contact say the same in two ways", "leave one of them out")
    control = held["control"]
    if control.restitution is None:
        return
    if not any(map(_is_rigid, held["solids"])):
        cause = "restitution of control acts on rigid objects, and the scene has none"
        v.problem(control.spans["restitution"], cause, "set damping in the objects, or write elasticity rigid in them")


def _check_rolling(v: Any, held: Mapping) -> None:
    """Rolling resistance acts between what is rigid or held."""
    hard = {s.name for s in held["solids"] if _is_rigid(s) or all_held(s)}
    by_name = objects_by_name(s.name for s in held["solids"])
    asked = [(s.rolling, s.spans, [s.name]) for s in held["solids"]]
    for contact in held["contacts"]:
        named = [held["solids"][i].name for name in (contact.first, contact.second) for i in by_name.get(name, ())]
        asked.append((contact.rolling, contact.spans, named))
    for rolling, spans, named in asked:
        if rolling is not None and (soft := next((name for name in named if name not in hard), None)):
            cause = f"{soft} is elastic: it loses energy by its own damping where it rolls"
            v.problem(spans["rolling"], cause, "set damping in it, or write elasticity rigid")


def _is_rigid(solid: Any) -> bool:
    return getattr(solid.elasticity, "modulus", 0.0) == math.inf


def check_contact(v: Any, block: Any, contact: ContactPair) -> ContactPair | None:
    """Two things that can touch, no pair of them twice, and something to say about them."""
    place, paired = block.head, v.memory.setdefault("contact", {})
    own = {
        "friction": contact.friction,
        "contact-damping": contact.contact_damping,
        "restitution": contact.restitution,
        "rolling": contact.rolling,
    }
    if all(value is None for value in own.values()) and not block.excused(*own):
        cause = f"contact {block.name} says nothing{block.where}"
        v.problem(place, cause, "write friction 0.1 or contact-damping 0 in it, or leave it out")
        return None
    planes = [name for name in block.names if name in v.touched and name not in v.named]
    if planes and contact.contact_damping is not None:
        cause = f"the contact-damping of {planes[0]} is that of control; a contact block cannot change it"
        v.problem(contact.spans["contact-damping"], cause, "write contact-damping in control")
        return None
    if len(planes) == 2:
        v.problem(place, f"{planes[0]} and {planes[1]} never touch", "write the name of an object for one of them")
        return None
    first, second = (v.named.get(name, ()) for name in block.names)
    if first == second and len(first) == 1:
        cause = f"{contact.first} does not touch itself{block.where}"
        v.problem(place, cause, "write the names of two objects, or ground, walls or basin for one")
        return None
    if len(paired) + max(1, len(first)) * max(1, len(second)) > MOST_PAIRS:
        cause = f"the contact blocks of the scene name more than {whole(MOST_PAIRS)} pairs of objects"
        v.problem(place, cause, "write friction in the objects, or in control", key="pairs")
        return None
    for pair in [(planes[0], i) for i in (*first, *second)] if planes else pairs_of(first, second):
        if (given := paired.setdefault(pair, place)) is not place:
            names = list(v.names)
            one, other = (i if isinstance(i, str) else names[i] for i in pair)
            cause = f"the contact of {one} and {other} is given twice{block.where}"
            v.problem(place, cause, f"first given at {given}", key=("contact", id(block.group)))
            return None
    return contact


CHECKS = {"contact": check_contact}
