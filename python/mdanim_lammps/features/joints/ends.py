# SPDX-License-Identifier: GPL-2.0-only
"""The ends of joints: how a body moves when it is pushed there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ...records import dataclass
from .links import Link
from .patches import Patch

ALIKE = 1e-9
"""Part of the mobilities of both directions across an axis, by which they differ at least where one is taken."""

THIN = 1e-12
"""Mobility of a direction over the largest one, up to which an end does not have it."""


@dataclass(frozen=True)
class JointEnd:
    """One end of a joint in something that moves: the motion that a push there gives."""

    object: int
    """Number in the scene, from 0."""
    d: np.ndarray
    """The point of the joint from the centre of the body, or of the patch [m], shape (3,)."""
    patch: Patch | None
    """None of what is rigid."""
    root: np.ndarray
    """M^-1/2 of the six motions of a rigid body, shape (6, 6); of all else nothing, shape (0, 0)."""
    tensor: np.ndarray
    """Moments of inertia of a rigid body [kg m^2], shape (3, 3)."""
    members: tuple[int, ...]
    """Objects that move as one with it, welded together, ascending; itself is one of them."""

    @property
    def body(self) -> int:
        """Number of the body that it belongs to: its first object."""
        return self.members[0]

    @property
    def rigid(self) -> bool:
        return self.patch is None

    @cached_property
    def mobility(self) -> float:
        """Largest one of its point [1/kg]."""
        return self.mobility_at(self.d)

    def mobility_at(self, d: np.ndarray) -> float:
        """Largest one of a point that is at d [m] [1/kg]."""
        if self.patch is not None:
            return float(1.0 / self.patch.total + d @ self.patch.inverse @ d)
        return self._largest(lever(d))

    def turning(self, directions: np.ndarray) -> float:
        """Largest mobility of directions that go with it, shape (n, 3) [1/(kg m^2)]."""
        if self.patch is not None:
            return float(np.einsum("ni,ij,nj->n", directions, self.patch.inverse, directions).max(initial=0.0))
        return self._largest(spin(directions)) if len(directions) else 0.0

    def about(self, axis: np.ndarray, across: np.ndarray) -> float:
        """Mobility of the angle about an axis [1/(kg m^2)]: of what deforms, that of the direction across it which a servo
        turns."""
        if self.patch is None:
            return self._largest(np.concatenate([np.zeros(3), axis])[None])
        return float(across @ self.patch.inverse @ across)

    def _largest(self, rows: np.ndarray) -> float:
        return float(np.linalg.eigvalsh(rows @ self.root @ self.root @ rows.T)[-1])


def lever(d: np.ndarray) -> np.ndarray:
    """Velocity of a point at d [m] by the six motions of a rigid body, shape (3, 6)."""
    return np.hstack([np.eye(3), -skew(d)])


def spin(directions: np.ndarray) -> np.ndarray:
    """Velocities of directions, shape (n, 3), by the six motions of a rigid body, shape (3 n, 6)."""
    return np.vstack([np.hstack([np.zeros((3, 3)), -skew(e)]) for e in directions])


def skew(v: np.ndarray) -> np.ndarray:
    """The matrix of v x."""
    x, y, z = v.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def unit(v) -> np.ndarray:
    """A direction as a unit vector."""
    return np.array(v, float) / np.linalg.norm(v)


def directions_of(link: Link) -> np.ndarray:
    """Directions that a joint holds, shape (n, 3)."""
    if link.joint.kind == "hinge":
        return unit(link.axis)[None]
    return np.eye(3) if link.joint.kind in ("weld", "slider") else np.zeros((0, 3))


def both_across(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two directions across an axis and each other."""
    first = unit(np.cross(axis, np.eye(3)[np.abs(axis).argmin()]))
    return first, np.cross(axis, first)


def across(axis: np.ndarray, inverses: Sequence[np.ndarray]) -> np.ndarray:
    """The direction across an axis that is hardest to turn in all ends, or the one that a flat end has, on which the servo of a
    hinge acts; ``inverses`` are their S^-1 [1/(kg m^2)], each of shape (3, 3)."""
    for inverse in inverses:
        values, vectors = np.linalg.eigh(inverse)
        if (values > THIN * values[-1]).tolist() == [False, True, True]:
            along = np.cross(vectors[:, 0], axis)
            if np.linalg.norm(along) > 0.5:
                return unit(along)
    u, v = both_across(axis)
    net = sum(inverses, np.zeros((3, 3)))
    uu, vv, uv = (float(a @ net @ b) for a, b in ((u, u), (v, v), (u, v)))
    least = 0.5 * (uu + vv) - math.hypot(0.5 * (uu - vv), uv)
    found = -uv * u + (uu - least) * v if abs(uu - least) > abs(vv - least) else (vv - least) * u - uv * v
    return unit(found) if np.linalg.norm(found) > ALIKE * (uu + vv) else u
