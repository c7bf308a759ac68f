# SPDX-License-Identifier: GPL-2.0-only
"""The line of a rope that is pulled straight around rollers: tangents between circles, and arcs on them, in one plane."""

from __future__ import annotations

import math
from itertools import pairwise

from ..records import dataclass
from .curve import middle_of
from .schema import Vector

UPRIGHT = 1e-6
"""Part of a roller's axis across z below which none of its sides is the upper one."""
BESIDE = 1e-6
"""Distance from the plane of a line over its length, and difference of the directions of axes, that are rounding."""


@dataclass(frozen=True, slots=True)
class Roller:
    """A cylinder that a rope runs around."""

    name: str
    centre: Vector
    """[m]"""
    axis: Vector
    """Has length 1."""
    half: float
    """Half its height [m]."""
    radius: float
    """The radius of the rope's line around it [m]."""
    is_over: bool
    """Whether the rope is on its upper side, along z."""


@dataclass(frozen=True, slots=True)
class Bend:
    """One end of a rope, a circle of the radius 0, or its arc on a roller, in the plane of the line."""

    at: tuple[float, float]
    """Middle of the circle [m]."""
    radius: float
    """[m]"""
    sense: float
    """1 where the line turns to the left, -1 to the right."""
    before: float = 0.0
    """Direction of the line that comes to it [rad]."""
    turn: float = 0.0
    """[rad]"""

    def point(self, angle: float, parts: float = 0.0) -> tuple[float, float]:
        """Its point after this part of its turn [rad]. Where particles stand ``parts`` [rad] apart, so far out that they are as
        far from each other as along the arc: 2 R sin(parts/2) = r parts."""
        out = self.radius * (0.5 * parts / math.sin(0.5 * parts) if 0.0 < parts < math.pi else 1.0)
        way = self.before + self.sense * (angle - 0.5 * math.pi)
        return self.at[0] + out * math.cos(way), self.at[1] + out * math.sin(way)


@dataclass(frozen=True, slots=True)
class Taut:
    """A line around rollers, by its length s from its first point."""

    start: Vector
    """[m]"""
    end: Vector
    """[m]"""
    plane: tuple[Vector, Vector, Vector]
    """A point [m] and two directions of its plane, the second one upwards."""
    bends: tuple[Bend, ...]
    """Both ends, and what lies between."""

    @property
    def length(self) -> float:
        """[m]"""
        return sum(straight + b.radius * b.turn for b, straight in zip(self.bends, (*self._straight(), 0.0)))

    @property
    def sharpest(self) -> float:
        """The least radius of its arcs [m]."""
        return min(b.radius for b in self.bends[1:-1])

    def _straight(self) -> list[float]:
        """Lengths from bend to bend [m]."""
        return [math.dist(a.point(a.turn), b.point(0.0)) for a, b in zip(self.bends, self.bends[1:])]

    def points(self, parts: int) -> list[Vector]:
        """The ends of so many equal parts [m]; on arcs so far out that straight lines between them are as long as these parts."""
        step, found, passed, n = self.length / parts, [self.start], 0.0, 1
        for a, b, straight in zip(self.bends, self.bends[1:], self._straight()):
            (u, v), (u1, v1) = a.point(a.turn), b.point(0.0)
            while n < parts and n * step < passed + straight:
                t = (n * step - passed) / straight
                found.append(self._in_space(u + t * (u1 - u), v + t * (v1 - v)))
                n += 1
            passed += straight
            while n < parts and b.turn and n * step < passed + b.radius * b.turn:
                found.append(self._in_space(*b.point((n * step - passed) / b.radius, step / b.radius)))
                n += 1
            passed += b.radius * b.turn
        return [*found, self.end]

    def middle(self) -> Vector:
        """Its centre of mass [m]."""
        return middle_of(self.points)

    def _in_space(self, u: float, v: float) -> Vector:
        (x, y, z), (a, b, c), (d, e, f) = self.plane
        return x + u * a + v * d, y + u * b + v * e, z + u * c + v * f


def taut(start: Vector, end: Vector, rollers: tuple[Roller, ...]) -> Taut:
    """The line from one point [m] to another around rollers in turn. Raises ValueError(cause, way out)."""
    axis = rollers[0].axis
    flat = math.hypot(axis[0], axis[1])
    if flat <= UPRIGHT:
        raise ValueError(
            f"the axis of {rollers[0].name} stands upright, so it has no upper side",
            "turn it: orientation axis (1, 0, 0) angle 90 deg",
        )
    up = tuple((float(k == 2) - axis[2] * axis[k]) / flat for k in range(3))
    across = tuple(up[k - 2] * axis[k - 1] - up[k - 1] * axis[k - 2] for k in range(3))
    size = max(math.dist(start, p) for p in (end, *(r.centre for r in rollers)))

    def along(of: Vector, way: Vector) -> float:
        return sum((p - o) * w for p, o, w in zip(of, start, way))

    if abs(along(end, axis)) > BESIDE * size:
        raise ValueError(
            f"its ends are {abs(along(end, axis)):.4g} m apart along the axis of {rollers[0].name}", "write both across it"
        )
    for r in rollers:
        if abs(abs(sum(a * b for a, b in zip(r.axis, axis))) - 1.0) > BESIDE:
            raise ValueError(
                f"the axes of {rollers[0].name} and {r.name} are not parallel", "turn one of them, or take two ropes"
            )
        if abs(along(r.centre, axis)) > r.half + BESIDE * size:
            raise ValueError(f"it runs beside {r.name}, not around it", f"write ends across the axis of {r.name}, in its middle")
    circles = [(along(p, across), along(p, up)) for p in (start, *(r.centre for r in rollers), end)]
    bends = [Bend(circles[0], 0.0, 1.0)]
    for r, before, at, after in zip(rollers, circles, circles[1:], circles[2:]):
        if abs(after[0] - before[0]) <= BESIDE * size:
            raise ValueError(
                f"what it runs to before {r.name} and behind it is at one place across it", "put one of them beside the other"
            )
        bends.append(Bend(at, r.radius, -1.0 if (after[0] > before[0]) == r.is_over else 1.0))
    ways = [_tangent(a, b, names) for a, b, names in zip(bends, [*bends[1:], Bend(circles[-1], 0.0, 1.0)], _pairs(rollers))]
    for k, r in enumerate(rollers, 1):
        at_top = 0.0 if (bends[k].sense < 0.0) == r.is_over else math.pi
        turn, to_top = (bends[k].sense * (way - ways[k - 1]) % (2.0 * math.pi) for way in (ways[k], at_top))
        if turn > math.pi and max(to_top, turn - to_top) > math.pi:  # it would go around on the other side
            side = ("under", "over")[r.is_over]
            raise ValueError(
                f"a straight line passes {side} {r.name} and does not touch it", "put its ends, or the roller, elsewhere"
            )
        bends[k] = Bend(bends[k].at, r.radius, bends[k].sense, ways[k - 1], turn)
    return Taut(start, end, (start, across, up), (*bends, Bend(circles[-1], 0.0, 1.0)))


def _pairs(rollers: tuple[Roller, ...]) -> list[str]:
    """Both ends of each straight part, in words."""
    names = ["its start", *(r.name for r in rollers), "its end"]
    return [f"{a} and {b}" for a, b in pairwise(names)]


def _tangent(a: Bend, b: Bend, names: str) -> float:
    """Direction [rad] of the line from one circle to another: n (b - a) = s_b r_b - s_a r_a, n to its left."""
    apart, beyond = math.dist(a.at, b.at), b.sense * b.radius - a.sense * a.radius
    if abs(beyond) > apart:
        raise ValueError(f"{names} are in each other", "put them apart, by half of the rope's thickness besides")
    return math.atan2(b.at[1] - a.at[1], b.at[0] - a.at[0]) - math.asin(beyond / apart)
