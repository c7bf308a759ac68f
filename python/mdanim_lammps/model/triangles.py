# SPDX-License-Identifier: GPL-2.0-only
"""Triangles as arrays: normals, areas, places on them. Points [m] have the shape (V, 3), triangles (T, 3)."""

from __future__ import annotations

import numpy as np


def normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Outward normals of twice the triangles' areas [m^2], shape (T, 3)."""
    corners = points[triangles]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def unit_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Outward normals of the triangles, of length 1 (0 without area), shape (T, 3)."""
    normal = normals(points, triangles)
    length = np.linalg.norm(normal, axis=1)[:, None]
    return np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area of each triangle [m^2], shape (T,)."""
    return np.linalg.norm(normals(points, triangles), axis=1) / 2


def spots(corners: np.ndarray, first: int = 0) -> np.ndarray:
    """An even place [m] in each triangle, corners (K, 3, 3): barycentric weights from two low-discrepancy sequences, of which
    the first one gets the ``first``."""
    u, v = (np.arange(first, first + len(corners))[:, None] * [0.7548776662466927, 0.5698402909980532] % 1).T
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    a, b, c = np.moveaxis(corners, 1, 0)
    return a + u[:, None] * (b - a) + v[:, None] * (c - a)


def surface_of(polydata) -> tuple[np.ndarray, np.ndarray]:
    """Points, float (V, 3), and triangles, int32 (T, 3), of a pyvista.PolyData of triangles."""
    return np.asarray(polydata.points, float), np.asarray(polydata.faces).reshape(-1, 4)[:, 1:].astype(np.int32)


def edges(triangles: np.ndarray) -> np.ndarray:
    """Directed edges, shape (3 T, 2)."""
    return triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)


def edge_keys(triangles: np.ndarray, directed: bool = False) -> np.ndarray:
    """A number for each of the `edges`, int64, shape (3 T,): the same for the same two points, whichever comes first unless
    ``directed``. Numbers sort as the pairs do, in a tenth of the time."""
    first, second = edges(triangles).astype(np.int64).T
    if not directed:
        first, second = np.minimum(first, second), np.maximum(first, second)
    return first * (int(triangles.max(initial=0)) + 1) + second


def volume_and_centre(points: np.ndarray, triangles: np.ndarray) -> tuple[float, np.ndarray]:
    """Signed volume and centre of mass, by summing the tetrahedra from one point to each triangle."""
    origin = points.mean(axis=0)
    a, b, c = np.moveaxis((points - origin)[triangles], 1, 0)
    six = np.einsum("td,td->t", a, np.cross(b, c))
    volume = six.sum() / 6
    if volume == 0:
        return 0.0, origin
    return float(volume), origin + (six[:, None] * (a + b + c)).sum(axis=0) / (24 * volume)


def spread_of(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Integral of x x' over the triangles by their area [m^2], shape (3, 3)."""
    area, corners = areas(points, triangles), points[triangles]
    ends = np.concatenate([corners, corners.sum(axis=1, keepdims=True)], axis=1)
    return np.einsum("t,tkd,tke->de", area, ends, ends) / (12.0 * area.sum())


def connected(triangles: np.ndarray) -> np.ndarray:
    """The part of each triangle, its number, int, shape (T,): triangles hang together by edges that two of them have. Parts that
    touch in a corner are two."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, number, uses = np.unique(edge_keys(triangles), return_inverse=True, return_counts=True)
    number = number.reshape(-1)
    by_edge = np.argsort(number, kind="stable")
    first, second = (by_edge[uses[number[by_edge]] == 2] // 3).reshape(-1, 2).T
    joined = coo_array((np.ones(len(first), bool), (first, second)), shape=(len(triangles),) * 2)
    return connected_components(joined, directed=False)[1]
