# SPDX-License-Identifier: GPL-2.0-only
"""Where joints are: near what they join."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...errors import Problem
from ...model import shapes
from ...model.distance import distance
from ...model.model import Model
from ...model.segments import to_segments
from ...scene.formatting import say
from ...scene.scene import Box, Mesh, SceneRecord, Solid
from .links import NOTHING, Link, links_of


def misplaced(scene: SceneRecord, models: Sequence[Model]) -> list[Problem]:
    """Problems of joints that are outside of both objects by more than a spacing, or than one is thick; of springs each end."""
    problems = []
    for link in links_of(scene).all:
        joint = link.joint
        ends = [(m, point) for m, point in ((link.first, link.begin), (link.named, link.end)) if m != NOTHING]
        if joint.kind == "spring":
            ends_of = {link.first: joint.spans.get("from"), link.named: joint.spans.get("to")}
            problems += [_far(scene, models, link, [end], ends_of.get(end[0])) for end in ends]
        else:
            problems.append(_far(scene, models, link, ends, joint.spans.get("at")))
        problems += [p for m, point in ends if models[m].frame.line for p in _off_line(models[m], link, point, scene.solids[m])]
    return [p for p in problems if p is not None]


ON = 1e-6
"""Distance from a line of particles, over its spacing, up to which a point is on it."""


def _off_line(model: Model, link: Link, point, solid: Solid) -> list[Problem]:
    """Problems of a joint with a line of particles, which has no place beside them, and no direction across."""
    joint, x, at = link.joint, model.position, np.array(point, float)
    if joint.kind in ("hinge", "slider"):
        cause = f"joint {joint.words} turns about an axis, and a rope does not resist twist: it has no direction across"
        return [Problem(joint.spans.get("joint"), cause, f"write joint ball, or joint weld, for {solid.name}")]
    away = to_segments(at[:, None], x[:-1].T, x[1:].T)
    if away.min() <= ON * model.spacing:
        return []
    nearest = x[np.linalg.norm(x - at, axis=1).argmin()]
    span = joint.spans.get("at") or joint.spans.get("from") or joint.spans.get("joint")
    cause = (
        f"joint {joint.words} is {say(float(away.min()), 'm')} beside the line of {solid.name}, which has all of its particles"
    )
    return [Problem(span, cause, f"write ({', '.join(f'{c:.9g}' for c in nearest)}) m, where its nearest particle is")]


def _far(scene: SceneRecord, models: Sequence[Model], link: Link, ends, span) -> Problem | None:
    """The problem of a place that is at none of these objects."""
    away = [outside(scene.solids[m], np.array(point, float)) for m, point in ends]
    nearest = int(np.argmin(away))
    most = max(max(models[m].spacing, shapes.thickness(scene.solids[m].shape)) for m, _ in ends)
    if away[nearest] <= most * (1.0 + 1e-9):
        return None
    names = [scene.solids[m].name for m, _ in ends]
    where = "both objects" if len(names) == 2 else names[0]
    solid, point = scene.solids[ends[nearest][0]], ends[nearest][1]
    return Problem(
        span or link.joint.spans.get("joint"),
        f"joint {link.joint.words} is outside of {where}: {say(away[nearest], 'm')} from {solid.name}",
        f"move it from ({', '.join(f'{c:g}' for c in point)}) m into {' or '.join(names)}, whose centre is at "
        f"({', '.join(f'{c:g}' for c in solid.position)}) m",
    )


def outside(solid: Solid, point: np.ndarray) -> float:
    """Distance of a point from an object [m], 0 inside; of a mesh from the box around it."""
    place = (point - solid.position) @ np.array(solid.rotation)
    if isinstance(solid.shape, Box | Mesh):
        low, high = shapes.extent(solid.shape)
        return float(np.linalg.norm(np.maximum(0.0, np.maximum(low - place, place - high))))
    return max(0.0, -float(distance(solid.shape, place[None])[0]))
