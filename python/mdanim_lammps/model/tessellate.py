# SPDX-License-Identifier: GPL-2.0-only
"""Closed triangle surfaces of revolution and of boxes, facing outward."""

from __future__ import annotations

import itertools
from math import ceil, pi

import numpy as np

# Facets that keep a round silhouette smooth in a picture, however coarse the particles are.
ROUND = 48


def revolve(profile: np.ndarray, facets: int, closed: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Turn a profile (r, z) [m], shape (P, 2), about z; return points (V, 3) and triangles (T, 3).

    The body lies to the left of the profile (it runs from the lower pole to the upper one, or
    counter-clockwise where ``closed`` joins its ends). Points with r = 0 at the ends become single vertices.
    """
    angle = 2 * pi * np.arange(facets) / facets
    rings = profile if closed else profile[1:-1]
    points = np.stack(
        [
            np.outer(rings[:, 0], np.cos(angle)),
            np.outer(rings[:, 0], np.sin(angle)),
            np.broadcast_to(rings[:, 1:], (len(rings), facets)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    ring = np.arange(len(points), dtype=np.int32).reshape(len(rings), facets)
    lower, upper = (ring, np.roll(ring, -1, axis=0)) if closed else (ring[:-1], ring[1:])
    a, b = lower.ravel(), np.roll(lower, -1, axis=1).ravel()
    c, d = np.roll(upper, -1, axis=1).ravel(), upper.ravel()
    triangles = [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    if not closed:
        south, north = np.int32(len(points)), np.int32(len(points) + 1)
        points = np.concatenate([points, [(0, 0, profile[0, 1]), (0, 0, profile[-1, 1])]])
        first, last = ring[0], ring[-1]
        triangles += [
            np.stack([np.full(facets, south), np.roll(first, -1), first], axis=1),
            np.stack([last, np.roll(last, -1), np.full(facets, north)], axis=1),
        ]
    return points, np.concatenate(triangles).astype(np.int32)


def ellipsoid(radii: np.ndarray, facets: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) [m] and triangles (T, 3) of an ellipsoid with these half axes [m]."""
    polar = pi * np.arange(facets // 2 + 1) / (facets // 2)
    points, triangles = revolve(np.stack([np.sin(polar), -np.cos(polar)], axis=1), facets)
    return points * radii, triangles


def grid_box(size, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) [m] and triangles (T, 3) of a cuboid whose faces are divided into steps [m]."""
    counts = [max(1, ceil(length / step)) for length in size]
    low = -np.array(size, float) / 2
    points, triangles = [], []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        nu, nv = counts[u] + 1, counts[v] + 1
        index = np.arange(nu * nv).reshape(nu, nv)
        a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
        quads = np.stack([a, b, c, d], axis=-1).reshape(-1, 4)
        for side in (-1, 1):
            face = np.empty((nu * nv, 3))
            face[:, axis] = side * -low[axis]
            face[:, u] = np.repeat(np.linspace(low[u], -low[u], nu), nv)
            face[:, v] = np.tile(np.linspace(low[v], -low[v], nv), nu)
            outward = quads if side > 0 else quads[:, ::-1]
            triangles.append(np.concatenate([outward[:, [0, 1, 2]], outward[:, [0, 2, 3]]]) + sum(map(len, points)))
            points.append(face)
    points, inverse = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    return points, inverse.reshape(-1)[np.concatenate(triangles)].astype(np.int32)


def facets(length: float, size: float, least: int = ROUND) -> int:
    """Facets around a circle of this length [m]; a multiple of 4, so that extremes are vertices."""
    return 4 * ceil(max(least, length / size) / 4)


def polyline(corners, size: float) -> np.ndarray:
    """Points (r, z) [m], shape (P, 2), along straight lines between corners, at most ``size`` apart."""
    corners = np.asarray(corners, float)
    parts = [
        a + np.linspace(0, 1, max(1, ceil(np.linalg.norm(b - a) / size)), endpoint=False)[:, None] * (b - a)
        for a, b in itertools.pairwise(corners)
    ]
    return np.concatenate([*parts, corners[-1:]])
