# SPDX-License-Identifier: GPL-2.0-only
"""Mass and moments that ballast adds to a solid."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ...model import shapes
from ...model.added import Added
from ...model.clip import moments_in_box
from ...model.tessellate import ellipsoid, revolve
from ...scene.shapes import Box, Cylinder, Ellipsoid, Mesh, Shape, Sphere, Torus
from .words import Ballast

FACETS = 96
"""Facets along circles of a round shape; with twice as many the error of moments is a quarter: it is known, and taken off."""


def added(solid: Any) -> Added | None:
    """The sum over its boxes; None without ballast. Raises mesh.MeshError."""
    if not solid.ballast:
        return None
    own = solid.density if solid.density is not None else solid.mass / shapes.volume(solid.shape)
    return _added(solid.shape, tuple(solid.position), solid.rotation, own, solid.ballast)


@lru_cache(maxsize=4096)
def _added(shape: Shape, position, rotation, own: float, ballast: tuple[Ballast, ...]) -> Added:
    parts = [(one.density - own, *in_box(shape, position, rotation, one)) for one in ballast]

    def ratio(x: np.ndarray) -> np.ndarray:
        found = np.ones(len(x))
        for one in ballast:
            found[((x >= one.low) & (x <= one.high)).all(axis=1)] = one.density / own
        return found

    mass, first, second = (sum(more * part[n] for more, *part in parts) for n in range(3))
    return Added(float(mass), np.asarray(first), np.asarray(second), ratio)


@lru_cache(maxsize=4096)
def in_box(shape: Shape, position, rotation, one: Ballast) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume, first and second moments of a shape in the box of a ballast, about the place of the shape, axes of the world; see
    clip.moments_in_box."""
    low, high = np.subtract(one.low, position), np.subtract(one.high, position)
    turn = np.array(rotation, float)
    if isinstance(shape, Box | Mesh):
        a, b = shapes.extent(shape)
        return moments_in_box(*shapes.surface(shape, 2.0 * float((b - a).max())), turn, low, high)
    coarse, fine = (moments_in_box(*_surface(shape, n), turn, low, high) for n in (FACETS, 2 * FACETS))
    return tuple((4.0 * np.asarray(y) - np.asarray(x)) / 3.0 for x, y in zip(coarse, fine))


def _surface(shape: Shape, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners [m], shape (V, 3), and triangles, shape (T, 3), of a round shape with this many facets along its circles."""
    if isinstance(shape, Sphere | Ellipsoid):
        return ellipsoid((shape.radius,) * 3 if isinstance(shape, Sphere) else shape.radii, n)
    if isinstance(shape, Torus):
        angle = 2.0 * np.pi * np.arange(n) / n
        profile = np.stack([shape.major + shape.minor * np.cos(angle), shape.minor * np.sin(angle)], axis=1)
        return revolve(profile, n, closed=True)
    r, h = shape.radius, shape.height
    if isinstance(shape, Cylinder):
        return revolve(np.array([(0.0, -h / 2), (r, -h / 2), (r, h / 2), (0.0, h / 2)]), n)
    return revolve(np.array([(0.0, -h / 4), (r, -h / 4), (0.0, 3 * h / 4)]), n)
