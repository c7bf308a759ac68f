# SPDX-License-Identifier: GPL-2.0-only
"""Points of contact between the particles of a sheet: the corners of its triangles cut into smaller ones."""

from __future__ import annotations

import numpy as np

from ...model.triangles import areas
from .tiled import Tiled
from .weave import Weave


def refined(layer: Weave | Tiled, parts: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The corners of triangles cut into ``parts``^2 each: of those between particles, the three particles of a triangle,
    int32, ascending, shape (K, 3), and their weights, shape (K, 3), 0 for the third one on an edge; and the area nearest to each
    corner, over h times the distance of rows [-], shape (N + K,), particles first."""
    place = np.zeros((len(layer.place), 3))
    place[:, : layer.place.shape[1]] = layer.place
    triangle = np.sort(layer.triangle, axis=1).astype(np.int64)
    of_triangle = areas(place, triangle) / (layer.h * layer.apart)
    step = np.array([(i, j, parts - i - j) for i in range(parts + 1) for j in range(parts + 1 - i)])
    own = np.array([_small_triangles(one) for one in step]) / (3.0 * parts**2)
    weight = np.broadcast_to(step, (len(triangle), *step.shape)).reshape(-1, 3)
    corner = np.repeat(triangle, len(step), axis=0)
    area = (of_triangle[:, None] * own).ravel()
    known = np.sort(np.where(weight > 0, corner * (parts + 1) + weight, -1), axis=1)  # equal of one corner in two triangles
    _, first, number = np.unique(known, axis=0, return_index=True, return_inverse=True)
    area, whole = np.bincount(number.ravel(), area), weight[first].max(axis=1) == parts
    particle = corner[first][whole][np.arange(whole.sum()), weight[first][whole].argmax(axis=1)]
    of_particle = np.zeros(len(place))
    of_particle[particle] = area[whole]
    between = first[~whole]
    return corner[between].astype(np.int32), weight[between] / parts, np.concatenate([of_particle, area[~whole]])


def _small_triangles(step: np.ndarray) -> int:
    """How many of the small triangles of one meet at a corner: one in a corner of it, three on a side, six inside."""
    return {2: 1, 1: 3, 0: 6}[int((step == 0).sum())]
