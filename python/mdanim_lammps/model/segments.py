# SPDX-License-Identifier: GPL-2.0-only
"""Distances of points to segments and triangles; the first axis of all arrays is that of components."""

from __future__ import annotations

import numpy as np


def to_segments(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance of points to segments from a to b."""
    along, out = b - a, p - a
    t = ((out * along).sum(axis=0) / (along**2).sum(axis=0)).clip(0, 1)
    return np.sqrt(((out - t * along) ** 2).sum(axis=0))


def to_triangles(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Distance of points to triangles."""
    cross = lambda u, v: np.cross(u, v, axis=0)
    normal = cross(b - a, c - a)
    sides = [(cross(v - u, p - u) * normal).sum(axis=0) for u, v in ((a, b), (b, c), (c, a))]
    edge = np.minimum(np.minimum(to_segments(p, a, b), to_segments(p, b, c)), to_segments(p, c, a))
    length = np.sqrt((normal**2).sum(axis=0))
    # A triangle without area is its edges.
    over = (np.minimum.reduce(sides) >= 0) & (length > 0)
    height = abs(((p - a) * normal).sum(axis=0)) / np.where(over, length, 1)
    return np.where(over, height, edge)
