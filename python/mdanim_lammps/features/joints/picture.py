# SPDX-License-Identifier: GPL-2.0-only
"""Joints in pictures and exports: a small ball where two objects turn or slide, a coil for a spring, a line for a rod or rope."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from ...picture.drawn import Drawn
from .rows import BROKEN, DRAWN, FIELD, FIRST, KIND, SECOND, SIZE

BALL = 0.55
"""Radius of the ball over the thinnest part of what it joins: it stands out of a rod that it is in the middle of."""
FINE = 2
"""Times that the triangles of an icosahedron are cut in four for it: 162 points."""
TURNS, EACH = 12, 12
"""Turns of a coil, and points of each."""
WIDE = 0.1
"""Radius of a coil over its length at the start."""
MOST_COILS = 300
"""Springs from which on all are drawn as lines."""


def drawn(trajectory):
    """Balls, coils and lines."""
    if FIELD not in {field.name for field in trajectory.metadata.fields}:
        return ()

    @lru_cache(maxsize=2)
    def rows(frame):
        return trajectory.field(FIELD, frame)["value"]

    kind, size = rows(0)[:, KIND].astype(int), rows(0)[:, SIZE]
    found = []
    if len(balls := np.flatnonzero(np.isin(kind, [DRAWN.index(word) for word in ("ball", "hinge", "slider")]))):
        found.append(_balls(rows, balls, size[balls]))
    coils, lines = (np.flatnonzero(kind == DRAWN.index(word)) for word in ("spring", "line"))
    if len(coils) > MOST_COILS:
        coils, lines = coils[:0], np.sort(np.concatenate([coils, lines]))
    if len(lines):
        line = np.arange(2 * len(lines), dtype=np.int32).reshape(-1, 2)
        found.append(Drawn("cables", lambda frame: _ends(rows(frame)[lines]).reshape(-1, 3), line=line))
    if len(coils):
        found.append(_coils(rows, coils))
    return tuple(found)


def _balls(rows: Callable, which: np.ndarray, size: np.ndarray) -> Drawn:
    import pyvista as pv

    ball = pv.Icosphere(radius=1.0, nsub=FINE)
    point, triangle = np.asarray(ball.points, float), ball.regular_faces
    radius = BALL * size[:, None, None]
    triangles = (triangle[None] + len(point) * np.arange(len(which))[:, None, None]).reshape(-1, 3).astype(np.int32)

    def points(frame):
        own = rows(frame)[which]
        shown = np.where(own[:, BROKEN] > 0.0, 0.0, 1.0)[:, None, None]
        return (own[:, None, FIRST] + shown * radius * point[None]).reshape(-1, 3)

    return Drawn("joints", points, triangles, normals=lambda frame: np.tile(point, (len(which), 1)))


def _ends(own: np.ndarray) -> np.ndarray:
    """Both ends of some springs, in one place where they have broken, shape (n, 2, 3)."""
    ends = np.stack([own[:, FIRST], own[:, SECOND]], axis=1)
    return np.where(own[:, None, None, BROKEN] > 0.0, ends[:, :1], ends)


def _coils(rows: Callable, which: np.ndarray) -> Drawn:
    along = np.linspace(0.0, 1.0, TURNS * EACH + 1)
    ramp = np.clip(np.minimum(along, 1.0 - along) * TURNS, 0.0, 1.0)  # both ends lie on the line
    angle = 2.0 * np.pi * TURNS * along
    ends = _ends(rows(0)[which])
    radius = WIDE * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    count = len(along)
    one = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    line = (one[None] + count * np.arange(len(which))[:, None, None]).reshape(-1, 2).astype(np.int32)

    def points(frame):
        first, way = (ends := _ends(rows(frame)[which]))[:, 0], ends[:, 1] - ends[:, 0]
        axis = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), np.finfo(float).tiny)
        least = np.eye(3)[np.abs(axis).argmin(axis=1)]
        across = np.cross(axis, least)
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), np.finfo(float).tiny)
        other = np.cross(axis, across)
        wide = radius * (np.linalg.norm(way, axis=1) > 0.0)
        around = np.cos(angle)[None, :, None] * across[:, None] + np.sin(angle)[None, :, None] * other[:, None]
        return (
            first[:, None] + along[None, :, None] * way[:, None] + wide[:, None, None] * ramp[None, :, None] * around
        ).reshape(-1, 3)

    return Drawn("springs", points, line=line)
