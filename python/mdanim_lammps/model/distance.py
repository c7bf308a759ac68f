# SPDX-License-Identifier: GPL-2.0-only
"""Signed distance to the true surface of every shape but the cuboid; body frame, whole arrays."""

from __future__ import annotations

from functools import singledispatch
from itertools import pairwise

import numpy as np

from ..scene.scene import Cone, Cylinder, Ellipsoid, Mesh, Rope, Shape, Sheet, Shell, Sphere, Torus
from . import mesh, mesh_distance, shapes
from .nearest import blocks
from .segments import to_segments

NEWTON_STEPS = 40
"""Not reached: 20 are enough for half axes from 1 to 100, in the middle and on planes of symmetry too."""


@singledispatch
def grid_distance(shape: Shape, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Distance of the nodes of an even grid, x (nx,), y (ny,), z (nz,) [m], to the surface [m], shape (nz, ny, nx), positive
    inside.

    As exact as `distance`; that of a mesh as `mesh_distance` says.
    """
    nodes = np.stack(np.meshgrid(z, y, x, indexing="ij")[::-1], axis=-1)
    return distance(shape, nodes.reshape(-1, 3)).reshape(nodes.shape[:-1])


@grid_distance.register
def _(shape: Mesh, x, y, z):
    return mesh_distance.on_grid(mesh.load(shape), x, y, z)


@singledispatch
def distance(shape: Shape, points: np.ndarray) -> np.ndarray:
    """Distance of points [m], shape (N, 3), to the surface [m], shape (N,), positive inside; exact."""
    raise TypeError(f"no distance to {shape!r}: register a function for its kind in model/distance.py")


@distance.register
def _(shape: Sphere, points):
    return shapes.depth(shape, points)


@distance.register
def _(shape: Torus, points):
    return shapes.depth(shape, points)


@distance.register
def _(shape: Rope, points):
    return shapes.depth(shape, points)  # of one that hangs through, to straight parts of its curve


@distance.register
def _(shape: Sheet, points):
    half = 0.5 * np.array(shape.plate.size)
    out = np.abs(points) - half
    return -np.where((out > 0.0).any(axis=1), np.linalg.norm(np.maximum(out, 0.0), axis=1), out.max(axis=1))


@distance.register
def _(shape: Shell, points):
    return shapes.depth(shape, points)


@distance.register
def _(shape: Cylinder, points):
    r, h = shape.radius, shape.height
    return _to_outline(shape, points, [(0, -h / 2), (r, -h / 2), (r, h / 2), (0, h / 2)])


@distance.register
def _(shape: Cone, points):
    r, h = shape.radius, shape.height
    return _to_outline(shape, points, [(0, -h / 4), (r, -h / 4), (0, 3 * h / 4)])


def _to_outline(shape: Shape, points: np.ndarray, outline) -> np.ndarray:
    """Signed distance to what an outline (r, z) [m] makes when it turns about z."""
    corner, away = np.array(outline), np.full(len(points), np.inf)
    for rows in blocks(len(points)):
        x, y, z = points[rows].T
        place = np.stack([np.hypot(x, y), z])
        for a, b in pairwise(corner):
            np.minimum(away[rows], to_segments(place, a[:, None], b[:, None]), out=away[rows])
        away[rows] = np.copysign(away[rows], shapes.depth(shape, points[rows]))
    return away


@distance.register
def _(shape: Ellipsoid, points):
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
