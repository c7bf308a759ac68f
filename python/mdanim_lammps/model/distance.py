# SPDX-License-Identifier: GPL-2.0-only
"""Signed distance of points to the true surface of every shape but the cuboid; body frame, whole arrays."""

from __future__ import annotations

import math
from functools import singledispatch
from itertools import pairwise

import numpy as np

from ..scene.scene import Cone, Cylinder, Ellipsoid, Mesh, Shape, Sphere, Torus
from . import mesh, shapes
from .nearest import Nearest, blocks, nearest_distances

MOST_SAMPLES = 8_000_000
"""Samples of a mesh; a body with more than 100 000 cells on its surface has them further apart."""
NEAR = 12
"""Samples of a mesh whose triangles are tried: for 3000 places in and around the duck the distance is then right to 1e-5 of the
samples' spacing, with 6 to 2e-2; right on the surface it is off by up to a tenth of the spacing."""
TRIANGLE_REACH, COARSE = 16, 4
"""Spacings of the samples up to which triangles are looked at. Further off the nearest of samples that are COARSE times as far
apart will do: around a duck and a knot it is too far by up to 1.1 spacings, 5 % of the distance, where a search among all samples
would take five times as long."""
LEVEL_REACH, COARSER = 48, 8
"""Spacings of coarse samples up to which these are looked at; beyond, those of the next level, COARSER times as far apart: far
from a flat side hundreds of close samples are equally near, and each is compared. It is at most 1 % too far for that."""
NEWTON_STEPS = 40
"""Not reached: 20 are enough for half axes from 1 to 100, in the middle and on planes of symmetry too."""


@singledispatch
def distance(shape: Shape, points: np.ndarray, spacing: float) -> np.ndarray:
    """Distance of points [m], shape (N, 3), to the surface [m], shape (N,), positive inside.

    Exact but for a mesh: there samples of the surface, ``spacing`` [m] apart, tell the distance, and near by which triangles to
    look at.
    """
    raise TypeError(f"no distance to {shape!r}: register a function for its kind in model/distance.py")


@distance.register
def _(shape: Sphere, points, spacing):
    return shapes.depth(shape, points)


@distance.register
def _(shape: Torus, points, spacing):
    return shapes.depth(shape, points)


@distance.register
def _(shape: Cylinder, points, spacing):
    r, h = shape.radius, shape.height
    return _to_outline(shape, points, [(0, -h / 2), (r, -h / 2), (r, h / 2), (0, h / 2)])


@distance.register
def _(shape: Cone, points, spacing):
    r, h = shape.radius, shape.height
    return _to_outline(shape, points, [(0, -h / 4), (r, -h / 4), (0, 3 * h / 4)])


def _to_outline(shape: Shape, points: np.ndarray, outline) -> np.ndarray:
    """Signed distance to what an outline (r, z) [m] makes when it turns about z."""
    corner, away = np.array(outline), np.full(len(points), np.inf)
    for rows in blocks(len(points)):
        x, y, z = points[rows].T
        place = np.stack([np.hypot(x, y), z])
        for a, b in pairwise(corner):
            np.minimum(away[rows], _to_segments(place, a[:, None], b[:, None]), out=away[rows])
        away[rows] = np.copysign(away[rows], shapes.depth(shape, points[rows]))
    return away


@distance.register
def _(shape: Ellipsoid, points, spacing):
    """Closest point y = r^2 x/(t + r^2 - c^2), c the least r: Newton from a t > 0 that is too small.

    The sum of the squares of y/r is convex in t, so no step goes too far.
    """
    r = np.array(shape.radii)[:, None]
    more = r**2 - r.min() ** 2
    # By symmetry in one octant. On a plane of symmetry the sum has a pole in the way, beside it has not.
    x = np.maximum(abs(points.T), 1e-12 * r.max())
    t = np.maximum((r * x - more).max(axis=0), np.sqrt(((r * x) ** 2).sum(axis=0)) - more.max())
    for _ in range(NEWTON_STEPS):
        below = t + more
        part = (r * x / below) ** 2
        step = (part.sum(axis=0) - 1) / (2 * (part / below).sum(axis=0))
        t += step
        if (abs(step) <= 1e-14 * t).all():
            break
    closest = r**2 * x / (t + more)
    return np.copysign(np.sqrt(((closest - x) ** 2).sum(axis=0)), shapes.depth(shape, points))


@distance.register
def _(shape: Mesh, points, spacing):
    body = mesh.load(shape)
    spacing = max(spacing, math.sqrt(body.area / MOST_SAMPLES))
    away = _to_samples(body, points, spacing)
    sample, triangle, _ = mesh.scatter(body, spacing)
    nearest = Nearest(sample)
    # Two spacings of the coarse samples more than is needed, as the nearest one is a little further off than the surface.
    close = np.flatnonzero(away < (TRIANGLE_REACH + 2 * COARSE) * spacing)
    for rows in blocks(len(close)):
        part = close[rows]
        length, near = nearest(points[part], NEAR, within=TRIANGLE_REACH * spacing)
        part, near = part[length[:, 0] < np.inf], near[length[:, 0] < np.inf]
        # Where fewer are close, any other one does no harm.
        tried = body.triangles[triangle[near.clip(max=len(sample) - 1)]]
        corners = (body.points.T[:, tried[..., corner]] for corner in range(3))
        away[part] = _to_triangles(points[part].T[..., None], *corners).min(axis=1)
    return np.where(mesh.contains(body, points), away, -away)


def _to_samples(body: mesh.Triangles, points: np.ndarray, spacing: float) -> np.ndarray:
    """Distance of points [m], shape (N, 3), to samples [m], shape (N,): the nearer the point, the closer are the samples."""
    apart = [COARSE * spacing]
    while LEVEL_REACH * apart[-1] < np.linalg.norm(np.ptp(points, axis=0)):
        apart.append(COARSER * apart[-1])
    away = np.zeros(len(points))
    for level in reversed(apart):
        close = away <= LEVEL_REACH * level
        away[close] = nearest_distances(mesh.scatter(body, level)[0], points[close])
    return away


def _to_segments(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance of points to segments from a to b, the first axis is that of components."""
    along, out = b - a, p - a
    t = ((out * along).sum(axis=0) / (along**2).sum(axis=0)).clip(0, 1)
    return np.sqrt(((out - t * along) ** 2).sum(axis=0))


def _to_triangles(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Distance of points to triangles, the first axis is that of components."""
    cross = lambda u, v: np.cross(u, v, axis=0)
    normal = cross(b - a, c - a)
    sides = [(cross(v - u, p - u) * normal).sum(axis=0) for u, v in ((a, b), (b, c), (c, a))]
    edge = np.minimum(np.minimum(_to_segments(p, a, b), _to_segments(p, b, c)), _to_segments(p, c, a))
    length = np.sqrt((normal**2).sum(axis=0))
    # A triangle without area is its edges.
    over = (np.minimum.reduce(sides) >= 0) & (length > 0)
    height = abs(((p - a) * normal).sum(axis=0)) / np.where(over, length, 1)
    return np.where(over, height, edge)
