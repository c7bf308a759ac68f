# SPDX-License-Identifier: GPL-2.0-only
"""Where sides of held cuboids are covered by other held cuboids, flush: nothing can come there, and nothing of them acts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from ..scene.scene import Box, Solid
from .boxes import box_pairs
from .contact_body import BodyFrame
from .model import Model

FLUSH = 0.01
"""Gap between two sides, or step between two edges, that is not felt, over the spacing: about the depth of what lies there."""
AROUND = 0.5
"""Cells by which a side acts beyond its open part: what lies on a neighbour is sunk in a little."""
BEYOND = 8.0
"""Cells by which an open part reaches beyond an edge of its side: farther than any contact."""
NOTHING = (1.0, -1.0, 1.0, -1.0)
"""The open part of a side that is covered as a whole."""
DIGITS = 6
"""Digits of the part that is left open, in cells, so that rounding makes no bodies of its own."""


def with_covers(models: Sequence[Model], solids: Sequence[Solid]) -> tuple[Model, ...]:
    """The models of a scene; contact bodies of what never moves, or moves as a whole, know that they do not deform and how thick
    ropes and sheets are, and those of held cuboids which of their sides are covered in part.

    Decided from the poses of the whole scene, so it is the same for every part of it.
    """
    stiff: dict[int, BodyFrame] = {}
    radius = max((model.frame.radius for model in models), default=0.0)
    whole = [model.still or model.inertia is not None for model in models]
    for frame in (model.frame for model, one in zip(models, whole) if one):
        stiff.setdefault(id(frame), frame.stiff(radius))
    models = [replace(model, frame=stiff[id(model.frame)]) if one else model for model, one in zip(models, whole)]
    held = [n for n, model in enumerate(models) if isinstance(model.frame.shape, Box) and model.still]
    if len(held) < 2:
        return tuple(models)
    beside: dict[int, list[int]] = {n: [] for n in held}
    for i, j in beside_each_other([solids[n] for n in held]):
        beside[held[i]].append(held[j])
        beside[held[j]].append(held[i])
    corners = {n: _corners(models[n].frame) @ np.array(solids[n].rotation).T + solids[n].position for n in held if beside[n]}
    frames: dict[tuple[int, bytes], BodyFrame] = {}
    found = list(models)
    for n in corners:
        frame, turn = models[n].frame, np.array(solids[n].rotation)
        others = (np.array([corners[k] for k in sorted(beside[n])]) - solids[n].position) @ turn
        if len(left := open_parts(frame.cells.low, frame.cells.count, frame.cells.edge, others)):
            key = (id(frame), left.tobytes())
            found[n] = replace(models[n], frame=frames.setdefault(key, replace(frame, open=left)))
    return tuple(found)


def beside_each_other(held: Sequence[Solid]) -> list[tuple[int, int]]:
    """Pairs of held cuboids, by number, whose sides may cover each other: no other ones do, at any spacing.

    Cells are at most as wide as a cuboid is thin, so its box, FLUSH of that larger, reaches all that is flush with it. The
    spacing is not read, as it depends on whether there are such pairs (bodies.only_features).
    """
    cuboids = [n for n, solid in enumerate(held) if isinstance(solid.shape, Box)]
    if len(cuboids) < 2:
        return []
    size = np.array([held[n].shape.size for n in cuboids])
    place = np.array([held[n].position for n in cuboids], float)
    half = 0.5 * (np.abs(np.array([held[n].rotation for n in cuboids])) @ size[:, :, None])[:, :, 0]
    half = half + FLUSH * size.min(axis=1, keepdims=True)
    pairs = box_pairs(place - half, place + half)
    return [(cuboids[i], cuboids[j]) for one, other in pairs for i, j in zip(one.tolist(), other.tolist())]


def hidden_sides(held: Sequence[Solid]) -> list[tuple[int, ...]] | None:
    """Sides of held solids that other ones hide as a whole, flush, by their numbers 0 to 5 for -x, +x, -y, …

    None where it is not that simple: a side is hidden in part, or cuboids are nearly flush, or in each other at an angle. Within
    FLUSH of a quarter of the smaller thickness of both counts as flush: as `beside_each_other`, it does not read the spacing.
    """
    hidden: list[tuple[int, ...]] = [() for _ in held]
    beside: dict[int, list[int]] = {}
    for i, j in beside_each_other(held):
        beside.setdefault(i, []).append(j)
        beside.setdefault(j, []).append(i)
    unit = np.array(list(product((-0.5, 0.5), repeat=3)))
    corner, thin = np.zeros((len(held), 8, 3)), np.zeros(len(held))
    for n in beside:
        corner[n] = (unit * held[n].shape.size) @ np.array(held[n].rotation).T + held[n].position
        thin[n] = min(held[n].shape.size)
    for n in beside:
        size, turn, near = np.array(held[n].shape.size), np.array(held[n].rotation), sorted(beside[n])
        spacing = 0.25 * thin[[n, *near]].min()
        count = np.maximum(1.0, np.rint(size / spacing))
        others = (corner[near] - held[n].position) @ turn
        low, high = others.min(axis=1), others.max(axis=1)
        hair = FLUSH * spacing
        is_along = (np.minimum(others - low[:, None], high[:, None] - others) <= hair).all()
        if not is_along or (np.maximum(low - 0.5 * size, -0.5 * size - high) > hair).any():
            return None
        rows = open_parts(-0.5 * size, count, size / count, others)
        if (rows[:, 1:] != NOTHING).any():
            return None
        hidden[n] = tuple(rows[:, 0].astype(int).tolist())
    return hidden


def _corners(frame: BodyFrame) -> np.ndarray:
    """Corners of a cuboid, body frame [m], shape (8, 3)."""
    return frame.cells.low + np.array(list(product((0, 1), repeat=3))) * frame.cells.count * frame.cells.edge


def open_parts(lowest: np.ndarray, count: np.ndarray, edge: np.ndarray, others: np.ndarray) -> np.ndarray:
    """The parts of the sides of a cuboid that others leave open, rows as `ContactBody.open`, shape (R, 5).

    Args:
        lowest: its lowest corner [m], shape (3,).
        count: its cells along each axis, shape (3,).
        edge: edges of a cell [m], shape (3,).
        others: corners of cuboids in the body frame [m], shape (K, 8, 3). Those whose axes are not along its own cover nothing.
    """
    hair = FLUSH * np.cbrt(edge.prod()) / edge
    at = (others - lowest) / edge
    low, high = at.min(axis=1), at.max(axis=1)
    is_along = (np.minimum(at - low[:, None], high[:, None] - at) <= hair).all(axis=(1, 2))
    low, high = low[is_along], high[is_along]
    rows = []
    for side, (axis, end) in enumerate(product(range(3), (0, 1))):
        across = [a for a in range(3) if a != axis]
        layer = end * count[axis] + (2 * end - 1) * hair[axis]  # just outside of the side
        meets = np.flatnonzero((low[:, axis] <= layer) & (layer <= high[:, axis]))[:, None]
        covers = low[meets, across] - hair[across], high[meets, across] + hair[across]
        left = _left(*covers, count[across].astype(float), hair[across])
        if left is not None:
            rows += [(side, *part) for part in left or [NOTHING]]
    return np.round(np.array(rows, float).reshape(-1, 5), DIGITS)


def _left(low: np.ndarray, high: np.ndarray, size: np.ndarray, hair: np.ndarray) -> list[tuple[float, ...]] | None:
    """Rectangles that covers leave of a side of this size, shape (2,), and what is around them; None where nothing is covered.

    ``low`` and ``high`` are the ends of the covers, shape (K, 2). A cover counts that comes to an edge of the side: what stands
    in its middle is met from above alone.
    """
    start, stop = np.maximum(low, 0.0), np.minimum(high, size)
    is_inside = ((low > AROUND) & (high < size - AROUND)).all(axis=1)
    counts = (stop - start > 2.0 * hair).all(axis=1) & ~is_inside
    if not counts.any():
        return None
    left = [(0.0, size[0], 0.0, size[1])]
    for (a, c), (b, d) in zip(start[counts].tolist(), stop[counts].tolist()):
        left = [part for one in left for part in _without(one, a, b, c, d)]
        if not left:
            break
    return [part for one in left for part in _with_around(one, size.tolist())]


def _with_around(one: tuple[float, ...], size: list[float]) -> list[tuple[float, ...]]:
    """An open part, with strips AROUND it where it does not end at an edge of the side: there it slides over the edges of both
    bodies, which are flush."""
    span = [one[:2], one[2:]]
    core = [(a - BEYOND * (a <= 0.0), b + BEYOND * (b >= n)) for (a, b), n in zip(span, size)]
    parts = [(*core[0], *core[1])]
    for axis in (0, 1):
        a, b = span[axis]
        low, high = max(span[1 - axis][0], AROUND), min(span[1 - axis][1], size[1 - axis] - AROUND)
        if low < high and (a > 0.0 or b < size[axis]):
            strip = [(low, high), (low, high)]
            strip[axis] = (a - (AROUND if a > 0.0 else BEYOND), b + (AROUND if b < size[axis] else BEYOND))
            parts.append((*strip[0], *strip[1]))
    return parts


def _without(one: tuple[float, ...], a: float, b: float, c: float, d: float) -> list[tuple[float, ...]]:
    """A rectangle (low, high, low, high) without that from (a, c) to (b, d), in pieces."""
    low, high, under, over = one
    if a >= high or b <= low or c >= over or d <= under:
        return [one]
    inner, outer = max(low, a), min(high, b)
    parts = [(low, a, under, over), (b, high, under, over), (inner, outer, under, c), (inner, outer, d, over)]
    return [(p, q, r, s) for p, q, r, s in parts if p < q and r < s]
