# SPDX-License-Identifier: GPL-2.0-only
"""The curve of a rope that hangs between two points: a catenary, with the exact length along it."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..records import dataclass
from .schema import Vector

STRAIGHT = 1e-12
"""A rope that is longer than its span by this share at most is straight."""
SAMPLES = 256
"""Points of a curve from which its middle is found."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A line between two points, straight or hanging along -z, by its length s from the first one."""

    start: Vector
    """[m]"""
    end: Vector
    """[m]"""
    length: float
    """[m]; of a straight one the distance of both points, however long the rope is."""
    a: float
    """Horizontal tension over weight per length [m]; 0 of a straight one."""
    first: float
    """Length from the lowest point to the first one, below 0 where that is ahead [m]."""

    def __call__(self, s: float) -> Vector:
        """The point a length s [m] along it."""
        (x, y, z), (x1, y1, z1) = self.start, self.end
        if not self.a:
            t = s / self.length
            return x + t * (x1 - x), y + t * (y1 - y), z + t * (z1 - z)
        at, span = self.first + s, math.hypot(x1 - x, y1 - y)
        way = self.a * (math.asinh(at / self.a) - math.asinh(self.first / self.a)) / span
        up = (at - self.first) * (at + self.first) / (math.hypot(self.a, at) + math.hypot(self.a, self.first))
        return x + way * (x1 - x), y + way * (y1 - y), z + up

    def middle(self) -> Vector:
        """Its centre of mass [m]."""
        return middle_of(self.points)

    def points(self, parts: int) -> list[Vector]:
        """The ends of so many equal parts, both ends of the curve exactly."""
        return [self.start, *(self(self.length * n / parts) for n in range(1, parts)), self.end]


def middle_of(points: Callable[[int], list[Vector]]) -> Vector:
    """The centre of mass [m] of a line, from the ends of so many equal parts of it, by the trapezoidal rule."""
    of, weight = points(SAMPLES), [0.5, *[1.0] * (SAMPLES - 1), 0.5]
    x, y, z = (sum(w * p[d] for w, p in zip(weight, of)) / SAMPLES for d in range(3))
    return x, y, z


def hanging(start: Vector, end: Vector, length: float) -> Curve:
    """The curve of a rope of this length [m] between two points [m], which are not above each other where it is longer than their
    distance.

    With the span D, the rise H and the length L: sinh(x)/x = sqrt(L^2 - H^2)/D, a = D/(2 x).
    """
    apart, span, rise = math.dist(start, end), math.dist(start[:2], end[:2]), end[2] - start[2]
    if length <= apart * (1.0 + STRAIGHT):
        return Curve(start, end, apart, 0.0, 0.0)
    x = _solve(math.sqrt((length - rise) * (length + rise)) / span)
    a = 0.5 * span / x
    return Curve(start, end, length, a, a * math.sinh(math.atanh(rise / length) - x))


def _solve(ratio: float) -> float:
    """x > 0 with sinh(x)/x = ratio > 1, by halves."""
    low, high = 0.0, 2.0
    while math.sinh(high) / high < ratio:
        low, high = high, 2.0 * high
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if math.sinh(middle) < ratio * middle else (low, middle)
    return 0.5 * (low + high)
