# SPDX-License-Identifier: GPL-2.0-only
"""Where joints are: near what they join, as far as shapes tell it, beside all other problems of a file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import Problem
from ...model import shapes
from ...scene.naming import objects_by_name
from ...scene.scene import Solid
from ...scene.schema import Vector
from ..ropes.words import is_rope
from .place import BY_PARTICLES, far, outside, vector
from .words import WORLD, Joint


def check(v: Any, held: Mapping) -> None:
    """Problems of the places of all joints; v is the scene/validate.Validator."""
    solids = held["solids"]
    by_name = objects_by_name(s.name for s in solids)
    for joint in held["joints"]:
        others = [None] if joint.second == WORLD else [solids[j] for j in by_name.get(joint.second, ())]
        for first in (solids[i] for i in by_name.get(joint.first, ())):
            for found in (found for other in others if other is not first for found in misplaced(joint, first, other)):
                v.problem(found.span, found.message, found.hint)


def misplaced(joint: Joint, first: Solid, second: Solid | None) -> list[Problem]:
    """Problems of the place of a joint that follow from shapes alone: it is outside of both objects by more than one is thick, of
    a spring each end; nothing says where along a rope it is. ``second`` is None for the world."""
    solids = [solid for solid in (first, second) if solid is not None]
    if joint.kind == "spring":
        ends = [(first, joint.begin, "from"), *([(second, joint.end, "to")] if second is not None else [])]
        places = [[(solid, given or solid.position, word)] for solid, given, word in ends]
    else:
        ends = [(first, joint.at, "at")]
        places = [[(solid, joint.at or first.position, "at") for solid in solids]]
    if joint.kind in ("hinge", "slider") and (rope := next(filter(is_rope, solids), None)) is not None:
        cause = f"joint {joint.words} turns about an axis, and a rope does not resist twist: it has no direction across"
        return [Problem(joint.spans.get("joint"), cause, f"write joint ball, or joint weld, for {rope.name}")]
    along = [(solid, word) for solid, given, word in ends if given is None and is_rope(solid)]
    if along:
        return [_along(joint, rope, next((s for s in solids if s is not rope), None), word) for rope, word in along]
    plain = [place for place in places if not any(isinstance(solid.shape, BY_PARTICLES) for solid, *_ in place)]
    found = (far(joint, place, max(shapes.thickness(solid.shape) for solid, *_ in place)) for place in plain)
    return [p for p in found if p is not None]


def _along(joint: Joint, rope: Solid, other: Solid | None, word: str) -> Problem:
    """The problem of a joint that does not say where along a rope it is."""

    def away(end: Vector) -> tuple[float, float]:
        if other is None:
            return 0.0, 0.0
        return 0.0 if is_rope(other) else outside(other, np.array(end, float)), math.dist(other.position, end)

    end = min((rope.shape.start, rope.shape.end), key=away)
    near = "an end of it" if other is None else f"its end that is nearer to {other.name}"
    cause = f"joint {joint.words} has no {word}: where along {rope.name} is it?"
    return Problem(joint.spans.get("joint"), cause, f"write {word} {vector(end)} m, {near}")
