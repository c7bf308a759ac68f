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
    problems: list[Problem | None] = []
    for link in links_of(scene).all:
        ends = [(m, n) for n, m in enumerate((link.first, link.named)) if m != NOTHING]
        lines = [p for m, n in ends if models[m].frame.dimensions == 1 for p in _off_line(models[m], link, n, scene.solids[m])]
        problems += lines
        if link.joint.kind == "spring":
            problems += [_far(scene, models, link, [end]) for end in ends if models[end[0]].frame.dimensions > 1]
        elif not lines:
            problems.append(_far(scene, models, link, ends))
    return [p for p in problems if p is not None]


def doubled(scene: SceneRecord) -> list[Problem]:
    """Warnings of joints that are of one kind, between the same objects, at one place: each beside the first of them."""
    first: dict[tuple, Link] = {}
    problems = []
    for link in links_of(scene).all:
        ends = tuple(sorted(((link.first, link.begin), (link.named, link.end))))
        axis = None if link.axis is None else max(link.axis, tuple(-x for x in link.axis))
        before = first.setdefault((link.joint.kind, ends, axis), link)
        if before is not link:
            cause = f"joint {link.joint.words} is between the same objects at the same place as joint {before.joint.words}"
            way_out = "leave one of them out, or move it: both act, and share what they bear"
            problems.append(Problem(link.joint.spans.get("joint"), cause, way_out, severity="warning"))
    return problems


def _word(link: Link, n: int) -> str:
    """Setting with the place of a joint in its object n, 0 or 1."""
    return "at" if link.joint.kind != "spring" else ("from", "to")[n ^ link.swapped]


ON = 1e-6
"""Distance from a line of particles, over its spacing, up to which a point is on it."""


def _off_line(model: Model, link: Link, n: int, solid: Solid) -> list[Problem]:
    """Problems of a joint whose object n is a line of particles, which has no place beside them, and no direction across."""
    joint, x, at = link.joint, model.position, np.array((link.begin, link.end)[n], float)
    if joint.kind in ("hinge", "slider"):
        cause = f"joint {joint.words} turns about an axis, and a rope does not resist twist: it has no direction across"
        return [Problem(joint.spans.get("joint"), cause, f"write joint ball, or joint weld, for {solid.name}")]
    away = to_segments(at[:, None], x[:-1].T, x[1:].T)
    if away.min() <= ON * model.spacing:
        return []
    word = _word(link, n)
    span = joint.spans.get(word)
    wanted = np.array((link.end, link.begin)[n], float) if span is None else at
    nearest = x[np.linalg.norm(x - wanted, axis=1).argmin()]
    place = joint.words if span is not None else f"{joint.words} has no {word}, and the centre of {solid.name}"
    cause = f"joint {place} is {say(float(away.min()), 'm')} beside the line of {solid.name}, which has all of its particles"
    way_out = f"write {word} ({', '.join(f'{c:.9g}' for c in nearest)}) m, where its nearest particle is"
    return [Problem(span or joint.spans.get("joint"), cause, way_out)]


def _far(scene: SceneRecord, models: Sequence[Model], link: Link, ends: list[tuple[int, int]]) -> Problem | None:
    """The problem of a place that is at none of these objects, each with its number in the joint, 0 or 1."""
    points = (link.begin, link.end)
    away = [outside(scene.solids[m], np.array(points[n], float)) for m, n in ends]
    nearest = int(np.argmin(away))
    most = max(max(models[m].spacing, shapes.thickness(scene.solids[m].shape)) for m, _ in ends)
    if away[nearest] <= most * (1.0 + 1e-9):
        return None
    names = [scene.solids[m].name for m, _ in ends]
    where = "both objects" if len(names) == 2 else names[0]
    solid, n = scene.solids[ends[nearest][0]], ends[nearest][1]
    at, centre = (f"({', '.join(f'{c:g}' for c in place)}) m" for place in (points[n], solid.position))
    way_out = f"move it from {at} into {' or '.join(names)}, whose centre is at {centre}"
    if link.named == NOTHING and link.joint.kind != "spring":
        way_out += (
            f"; or hold {solid.name} at a distance: by joint spring {solid.name} world {{ from {centre} to {at} }}, or by a rod"
        )
        way_out += f", another object that a joint weld ties to {solid.name}, and this joint to the world"
    return Problem(
        link.joint.spans.get(_word(link, n)) or link.joint.spans.get("joint"),
        f"joint {link.joint.words} is outside of {where}: {say(away[nearest], 'm')} from {solid.name}",
        way_out,
    )


def outside(solid: Solid, point: np.ndarray) -> float:
    """Distance of a point from an object [m], 0 inside; of a mesh from the box around it."""
    place = (point - solid.position) @ np.array(solid.rotation)
    if isinstance(solid.shape, Box | Mesh):
        low, high = shapes.extent(solid.shape)
        return float(np.linalg.norm(np.maximum(0.0, np.maximum(low - place, place - high))))
    return max(0.0, -float(distance(solid.shape, place[None])[0]))
