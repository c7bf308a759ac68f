# SPDX-License-Identifier: GPL-2.0-only
"""The formulas of the shape of a rope."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..scene.rollers import Taut
from ..scene.scene import Rope
from .nearest import blocks
from .segments import to_segments
from .tube import SIDES

PARTS = 64
"""Straight parts that stand for the curve of a rope where depths and moments are asked for."""
ARC, MOST_PARTS = 0.4, 4096
"""The same around a roller: parts l with l^2/8 r = d/20 at most, and so many."""


class RopeLaw:
    """Formulas of a rope; the body frame has the axes of the world, with the origin in its centre of mass."""

    rolls, end = False, "flat"

    @staticmethod
    def volume(s):
        return section(s) * s.length

    @staticmethod
    def area(s):
        return math.pi * s.thickness * s.length + 2.0 * section(s)

    @staticmethod
    def thickness(s):
        return s.thickness

    @staticmethod
    def moments(s):
        a, b = _line(s)[:-1], _line(s)[1:]
        middle, way = 0.5 * (a + b), b - a
        return (middle.T @ middle + way.T @ way / 12.0) / len(a) + s.thickness**2 / 16.0 * np.eye(3)

    @staticmethod
    def extent(s):
        line, r = _line(s), 0.5 * s.thickness
        return line.min(axis=0) - r, line.max(axis=0) + r

    @staticmethod
    def depth(s, x, y, z):
        x, y, z = np.broadcast_arrays(x, y, z)
        points, line = np.stack([x, y, z], axis=-1).reshape(-1, 3), _line(s)
        away = np.full(len(points), np.inf)
        for rows in blocks(len(points)):
            part = points[rows].T
            for a, b in pairwise(line):
                np.minimum(away[rows], to_segments(part, a[:, None], b[:, None]), out=away[rows])
        return (0.5 * s.thickness - away).reshape(x.shape)

    @staticmethod
    def surface(s, size):
        raise TypeError("the surface of a rope is that of its chain of particles")

    @staticmethod
    def radius(s):
        return s.length + 0.5 * s.thickness  # wherever its parts go

    @staticmethod
    def vertices(s, h):
        return 2.0 * SIDES * s.length / h


def section(rope: Rope) -> float:
    """Area of its section [m^2]."""
    return 0.25 * math.pi * rope.thickness**2


@lru_cache(maxsize=4096)
def _line(rope: Rope) -> np.ndarray:
    """Points of its curve from its centre of mass [m], shape (P, 3)."""
    curve = rope.curve
    if isinstance(curve, Taut):
        fine = math.sqrt(ARC * curve.sharpest * rope.thickness)
        return np.array(curve.points(min(max(PARTS, math.ceil(curve.length / fine)), MOST_PARTS))) - curve.middle()
    return np.array(curve.points(PARTS if curve.a else 1)) - curve.middle()
