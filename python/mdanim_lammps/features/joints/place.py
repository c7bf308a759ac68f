# SPDX-License-Identifier: GPL-2.0-only
"""Where joints are: near what they join, by its particles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from ...errors import Problem, Span
from ...model import shapes
from ...model.distance import distance
from ...model.model import Model
from ...model.segments import to_segments
from ...scene.formatting import say, whole
from ...scene.scene import Box, Mesh, PieceShape, Rope, SceneRecord, Sheet, Shell, Solid
from ...scene.schema import Vector
from .links import NOTHING, Link, links_of
from .planes import ON, across, off_plane
from .words import WORLD, Joint

BENT = 3e-5
"""Part of its length by which a piece of a rope is off a straight line, from which on it has two directions."""

BY_PARTICLES = (Rope, Sheet, Shell, Mesh, PieceShape)
"""Shapes whose places are told by their particles, or by a file."""


def misplaced(scene: SceneRecord, models: Sequence[Model]) -> list[Problem]:
    """Problems of the places of joints that follow from particles: what is a line, a sheet or a mesh is far from them, or does
    not have them or their directions."""
    problems: list[Problem | None] = []
    beside: dict[Span | None, list[Problem]] = {}
    for link in links_of(scene).all:
        ends = [(m, n) for n, m in enumerate((link.first, link.named)) if m != NOTHING]
        lines = [p for m, n in ends if models[m].frame.dimensions == 1 for p in _off_line(models[m], link, n, scene.solids[m])]
        for one in lines:
            beside.setdefault(one.span, []).append(one)
        problems += [_tilted(scene, link), _unlike(scene, models, link)]
        if link.joint.kind == "spring":
            places = [[end] for end in ends if models[end[0]].frame.dimensions > 1]
        else:
            places = [] if lines else [ends]
        for place in places:
            problem = None
            if any(isinstance(scene.solids[m].shape, BY_PARTICLES) for m, _ in place):
                most = max(max(models[m].spacing, shapes.thickness(scene.solids[m].shape)) for m, _ in place)
                problem = far(link.joint, [(scene.solids[m], (link.begin, link.end)[n], _word(link, n)) for m, n in place], most)
            problems.append(problem or _off_sheet(scene, models, link, place))
    return [*map(_one_of_all, beside.values()), *(p for p in problems if p is not None)]


def _one_of_all(beside: list[Problem]) -> Problem:
    """The first of the problems of one place in the text, which a repeat has made many joints of, with the number of all."""
    first, *others = beside
    if not others:
        return first
    way_out = "ropes with a length sag: without it they are straight, and take points between their ends, as at (i*w, 0, h)"
    return replace(first, message=f"{first.message}, and {whole(len(others))} more so", hint=way_out)


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


def _off_line(model: Model, link: Link, n: int, solid: Solid) -> list[Problem]:
    """Problems of a joint whose object n is a line of particles, which has no place beside them."""
    joint, x, at = link.joint, model.position, np.array((link.begin, link.end)[n], float)
    away = to_segments(at[:, None], x[:-1].T, x[1:].T)
    if away.min() <= ON * model.spacing:
        return []
    word = _word(link, n)
    span = joint.spans.get(word)
    wanted = np.array((link.end, link.begin)[n], float) if span is None else at
    nearest = x[np.linalg.norm(x - wanted, axis=1).argmin()]
    place = joint.words if span is not None else f"{joint.words} has no {word}, and the centre of {joint.first}"
    cause = f"joint {place} is {say(float(away.min()), 'm')} beside the line of {solid.name}"
    way_out = f"write {word} {vector(nearest)} m, where its nearest particle is"
    if isinstance(solid.shape, Rope) and solid.shape.length > math.dist(solid.shape.start, solid.shape.end):
        way_out += "; without length it is straight"
    return [Problem(span or joint.spans.get("joint"), cause, way_out)]


def _off_sheet(scene: SceneRecord, models: Sequence[Model], link: Link, ends: list[tuple[int, int]]) -> Problem | None:
    """The problem of a place that is off the plane of a sheet among these objects, each with its number in the joint, 0 or 1."""
    links, objects = links_of(scene), [m for m, _ in ends]
    n = next((n for m, n in ends if links.sheets([m])), None)
    if n is None:
        return None
    at, word = np.array((link.begin, link.end)[n], float), _word(link, n)
    span = link.joint.spans.get(word)
    place = f"joint {link.joint.words}"
    if span is None:
        place += f" has no {word}, and the centre of {link.joint.first}"
    sheets = [(scene.solids[m], models[m]) for m in links.sheets(objects)]
    found = off_plane(place, at, word, sheets, links.rope(objects))
    return None if found is None else Problem(span or link.joint.spans.get("joint"), *found)


def _tilted(scene: SceneRecord, link: Link) -> Problem | None:
    """The problem of an axis across a sheet: a hinge takes a direction of both objects, a slider one of the second."""
    if link.axis is None:
        return None
    links, joint = links_of(scene), link.joint
    sheets = [scene.solids[m] for m in links.sheets([link.second] if joint.kind == "slider" else [link.first, link.second])]
    others = [joint.first, joint.second]
    found = across(joint.words, joint.kind, link.axis, sheets, others[others[0] == sheets[0].name]) if sheets else None
    return None if found is None else Problem(joint.spans.get("axis") or joint.spans.get("joint"), *found)


def _unlike(scene: SceneRecord, models: Sequence[Model], link: Link) -> Problem | None:
    """The problem of what a weld or a slider cannot hold, as two sheets or ropes have no directions in common there."""
    joint = link.joint
    if joint.kind not in ("weld", "slider") or NOTHING in (link.first, link.second):
        return None
    spans = [_span(models[m], scene.solids[m], np.array(link.begin, float)) for m in (link.first, link.second)]
    flat, other = sorted((s for s in spans if len(s) < 3), key=len) if max(map(len, spans)) < 3 else (np.eye(3), np.eye(3))
    if np.linalg.norm(flat - flat @ other.T @ other, axis=1).max() <= ON:
        return None
    names = " and ".join(scene.solids[m].name for m in (link.first, link.second))
    cause = f"joint {joint.words} holds the directions of both objects, and {names} have not the same ones there"
    way_out = f"write joint ball {joint.first} {joint.second}, or hold both to a small rigid object by joint weld"
    return Problem(joint.spans.get("joint"), cause, way_out)


def _span(model: Model, solid: Solid, at: np.ndarray) -> np.ndarray:
    """Directions that an object has at a point, orthonormal rows, shape (1..3, 3): of a rope that of its particles there."""
    if model.frame.spans == 3:
        return np.eye(3)
    if model.frame.spans == 2:
        return np.array(solid.rotation, float).T[:2]
    away = np.linalg.norm(model.position - at, axis=1)
    near = model.position[away <= np.sort(away)[1] + 0.1 * model.spacing]
    _, sizes, rows = np.linalg.svd(near - near.mean(axis=0), full_matrices=False)
    return rows[sizes > BENT * sizes[0]]


def far(joint: Joint, ends: Sequence[tuple[Solid, Vector, str]], most: float) -> Problem | None:
    """The problem of a place that is farther than ``most`` [m] from each of these objects, given with the place in each and the
    setting that says it."""
    away = [outside(solid, np.array(point, float)) for solid, point, _ in ends]
    nearest = int(np.argmin(away))
    if away[nearest] <= most * (1.0 + 1e-9):
        return None
    names = [solid.name for solid, *_ in ends]
    where = "both objects" if len(names) == 2 else names[0]
    solid, point, word = ends[nearest]
    at, centre = (f"({', '.join(f'{c:g}' for c in place)}) m" for place in (point, solid.position))
    way_out = f"move it from {at} into {' or '.join(names)}, whose centre is at {centre}"
    if joint.second == WORLD and joint.kind != "spring":
        way_out += (
            f"; or hold {solid.name} at a distance: by joint spring {solid.name} world {{ from {centre} to {at} }}, or by a rod"
        )
        way_out += f", another object that a joint weld ties to {solid.name}, and this joint to the world"
    return Problem(
        joint.spans.get(word) or joint.spans.get("joint"),
        f"joint {joint.words} is outside of {where}: {say(away[nearest], 'm')} from {solid.name}",
        way_out,
    )


def outside(solid: Solid, point: np.ndarray) -> float:
    """Distance of a point from an object [m], 0 inside; of a mesh from the box around it."""
    place = (point - solid.position) @ np.array(solid.rotation)
    if isinstance(solid.shape, Box | Mesh):
        low, high = shapes.extent(solid.shape)
        return float(np.linalg.norm(np.maximum(0.0, np.maximum(low - place, place - high))))
    return max(0.0, -float(distance(solid.shape, place[None])[0]))


def vector(point: Iterable[float]) -> str:
    return f"({', '.join(f'{c:.9g}' for c in point)})"
