# SPDX-License-Identifier: GPL-2.0-only
"""Drawn surfaces with larger triangles: air need not push at more of them than an object has cells to bend by."""

from __future__ import annotations

import numpy as np

from ...model.model import Surface
from ...model.triangles import normals, volume_and_centre

EDGE, ACROSS = 0.5, 8.0
"""Edges of triangles over the least edge of a cell, about; and how many at least lie across the object where it is thinnest."""
WORTH = 2.0
"""Times as many triangles as are left, from which on a surface is made coarser."""


def coarser(surface: Surface, position: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Particles and weights of points, each of shape (P, K), and triangles, shape (T, 3), of a closed surface, for places of
    particles [m], shape (N, 3), whose cells have this least ``edge`` [m]; the surface itself where it has few more.

    Of all vertices in a cube that face alike the one in their middle stays. Then all move away from the centre until the surface
    encloses as much as before.
    """
    place, triangle = surface.vertices(position), surface.triangle
    number, kept = _groups(place, triangle, min(EDGE * edge, float(np.ptp(place, axis=0).min()) / ACROSS))
    left = _without_folds(number[triangle])
    if WORTH * len(left) > len(triangle):
        return surface.index, surface.weight, triangle
    index, weight = surface.index[kept], surface.weight[kept]
    whole, centre = volume_and_centre(place, triangle)
    part, _ = volume_and_centre(place[kept], left)
    if not 0.5 * whole < part:
        return surface.index, surface.weight, triangle
    away = (np.cbrt(whole / part) - 1.0) * (place[kept] - centre)
    return index, weight + _weights_of_ways(position[index], place[kept], away), left


def _groups(place: np.ndarray, triangle: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the groups of vertices, shape (V,), and the vertex in the middle of each, shape (G,)."""
    normal, of_triangle = np.zeros_like(place), normals(place, triangle)
    for column in triangle.T:
        np.add.at(normal, column, of_triangle)
    axis = np.abs(normal).argmax(axis=1)
    side = 2 * axis + (normal[np.arange(len(normal)), axis] > 0.0)
    cube = np.floor((place - place.min(axis=0)) / size).astype(int)
    number = np.unique(np.column_stack([cube, side]), axis=0, return_inverse=True)[1].ravel()
    count = np.bincount(number)
    middle = np.stack([np.bincount(number, x) for x in place.T], axis=1) / count[:, None]
    order = np.lexsort((((place - middle[number]) ** 2).sum(axis=1), number))
    return number, order[np.cumsum(count) - count]


def _without_folds(triangle: np.ndarray) -> np.ndarray:
    """Triangles with three corners, without those that lie on each other and face opposite ways."""
    a, b, c = triangle.T
    turn = np.sign((b - a) * (c - a) * (c - b))
    triangle, turn = triangle[turn != 0], turn[turn != 0]
    number = np.unique(np.sort(triangle, axis=1), axis=0, return_inverse=True)[1].ravel()
    return triangle[np.bincount(number, turn)[number] != 0.0]


def _weights_of_ways(corner: np.ndarray, place: np.ndarray, way: np.ndarray) -> np.ndarray:
    """The least weights of corners [m], shape (P, K, 3), that sum to 0 and to a way [m], shape (P, 3), for each place."""
    rows = np.concatenate([np.swapaxes(corner - place[:, None], 1, 2), np.ones((len(place), 1, corner.shape[1]))], axis=1)
    asked = np.column_stack([way, np.zeros(len(way))])
    return np.einsum("pkd,pd->pk", np.linalg.pinv(rows), asked)
