# SPDX-License-Identifier: GPL-2.0-only
"""Where a group of objects is placed, how it is turned and how it moves; the same for an object in it."""

from __future__ import annotations

from dataclasses import fields, replace

from ..records import dataclass
from .formatting import say
from .limits import LIMITS
from .rotation import IDENTITY, product
from .scene import Orientation, Solid
from .schema import Vector, setting
from .shapes import HoldWithin

RIGHT = 1e-9
"""Largest part across of an axis that is turned by right angles; a rotation by 90 deg leaves 1e-16."""


@dataclass(frozen=True, slots=True)
class Placement:
    """A rigid motion from the frame of a group into that of its surroundings: r = position + rotation r'."""

    name: str
    position: Vector = setting(
        "<(x, y, z):m>", "Where the origin of the group goes; all that is in it is moved along.",
        "(1, 0, 0) m", default=(0.0, 0.0, 0.0))  # fmt: skip
    """[m]"""
    rotation: tuple[Vector, Vector, Vector] = setting(
        "axis <(x, y, z)> angle <a:rad> | euler <(rx, ry, rz):rad> | matrix <(xx, xy, xz)> <(yx, yy, yz)> <(zx, zy, zz)>",
        "Rotation about the origin of the group: positions, orientations, velocities and spins in it are turned.",
        "axis (0, 0, 1) angle 90 deg", name="orientation", default=IDENTITY, codec=Orientation())  # fmt: skip
    """Rotation matrix, rows."""
    velocity: Vector = setting(
        "<(vx, vy, vz):m/s>", "Velocity of the origin at the start; it is added to that of each object in the group.",
        "(1, 0, 0) m/s", default=(0.0, 0.0, 0.0))  # fmt: skip
    """[m/s]"""
    spin: Vector = setting(
        "<(wx, wy, wz):rad/s>",
        "Angular velocity of the whole group at the start, about its origin and the axes of the world: objects in it get the "
        "spin, and the velocity of their place.",
        "(0, 0, 2) rad/s", default=(0.0, 0.0, 0.0))  # fmt: skip
    """[rad/s]"""

    def moved(self, what: Solid | Placement) -> Solid | Placement:
        """An object, or a group within this one, in the surroundings.

        r = p + R r', v = V + R v' + W x (R r'), w = W + R w'. Raises ValueError(cause, way out, word) for a held box that is
        turned by other than right angles, and for a shape that cannot be turned so.
        """
        arm = turned(self.rotation, what.position)
        turn = product(self.rotation, what.rotation) if self.rotation != IDENTITY else what.rotation
        more = {"position": _sum(self.position, arm), "rotation": turn}
        if isinstance(what, Solid):
            more["hold"] = tuple(map(self.held, what.hold))
            if hasattr(what.shape, "moved"):  # it says itself where the object is
                shape = what.shape.moved(self)
                more |= {"shape": shape, "rotation": what.rotation, **shape.brings()}
                arm = _sum(more["position"], tuple(-x for x in self.position))
        for name in (f.name for f in fields(what)):  # records of features that know how to be moved
            value = getattr(what, name)
            if isinstance(value, tuple) and any(hasattr(one, "moved") for one in value):
                more[name] = tuple(one.moved(self) for one in value)
        return replace(
            what,
            **more,
            velocity=_sum(self.velocity, turned(self.rotation, what.velocity), _cross(self.spin, arm)),
            spin=_sum(self.spin, turned(self.rotation, what.spin)),
        )

    def turn(self, v: Vector) -> Vector:
        """A direction of the group in the surroundings."""
        return turned(self.rotation, v)

    def point(self, at: Vector) -> Vector:
        """A point of the group in the surroundings [m]."""
        return _sum(self.position, turned(self.rotation, at))

    def held(self, hold):
        """Particles that are held, of an object in the group: a box is moved along, faces are those of the object."""
        if not isinstance(hold, HoldWithin):
            return hold
        if (box := self.box(hold.low, hold.high)) is None:
            way_out = "write hold face or hold all, or turn the group by 90 deg or 180 deg"
            raise ValueError("a held box lies along the axes of the world, and its group is turned", way_out, "hold")
        return HoldWithin(*box)

    def box(self, low: Vector, high: Vector) -> tuple[Vector, Vector] | None:
        """Corners of a box in the surroundings; None where it is turned by other than right angles."""
        if any(RIGHT < abs(x) < 1.0 - RIGHT for row in self.rotation for x in row):
            return None
        right = tuple(tuple(float(round(x)) for x in row) for row in self.rotation)
        a, b = (_sum(self.position, turned(right, corner)) for corner in (low, high))
        return tuple(map(min, a, b)), tuple(map(max, a, b))


def beyond_limits(what: Solid | Placement) -> tuple[str, str] | None:
    """Cause and way out where the sum of all motions is more than a scene may have; None where it is not."""
    for word, unit in (("position", "m"), ("velocity", "m/s"), ("spin", "rad/s")):
        limit, most = LIMITS[unit], max(map(abs, getattr(what, word)))
        if most > limit.most:
            return (
                f"the {word} of {what.name} is too large: {say(most, unit)}, the most is {say(limit.most, unit)}",
                limit.way_out,
            )
    return None


def turned(rotation: tuple[Vector, Vector, Vector], v: Vector) -> Vector:
    """R v; the same bits where nothing is turned."""
    return v if rotation == IDENTITY else tuple(sum(a * b for a, b in zip(row, v)) for row in rotation)


def _sum(*vectors: Vector) -> Vector:
    return tuple(sum(parts) for parts in zip(*vectors))


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
