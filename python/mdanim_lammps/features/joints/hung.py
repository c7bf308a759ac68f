# SPDX-License-Identifier: GPL-2.0-only
"""Groups of objects that hang together by joints that do not break, and the energy that each may get in its group."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from ...bodies import kind_of
from ...model import shapes
from ...reach import Hung
from ...records import dataclass
from ...scene import units
from ...scene.schema import Vector
from .ends import unit
from .links import Link, Links, parts, play

UP = np.array([0.0, 0.0, 1.0])
PARALLEL = 1e-6
"""Largest cross product of unit vectors along one line."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a body may come down to, and how it may be turned then."""

    at: Vector
    """A point of it at the start [m]."""
    lowest: float
    """The height that this point may come down to [m]."""
    axis: np.ndarray | None
    """About which it turns, of length 1; None where it may be turned anyhow."""
    angles: tuple[float, float]
    """How far it turns about that axis from the start [rad]."""

    def low(self, point: Vector) -> float:
        """The height that a point of it may come down to [m]: never too large."""
        return self.lowest + self.hangs(np.subtract(point, self.at))

    def hangs(self, arm: np.ndarray) -> float:
        """The least height of the end of an arm, fixed in the body, over its begin [m]."""
        if self.axis is None:
            return -float(np.linalg.norm(arm))
        along = (arm @ self.axis) * self.axis
        level, side = (arm - along)[2], np.cross(self.axis, arm)[2]
        low, high = self.angles
        turned = [level * math.cos(angle) + side * math.sin(angle) for angle in self.angles]
        lowest = math.atan2(-side, -level)
        if lowest + math.tau * math.ceil((low - lowest) / math.tau) <= high:
            turned.append(-math.hypot(level, side))
        return float(along[2] + min(turned))

    def beyond(self, link: Link, is_first: bool) -> Place:
        """The place of what a joint holds at it; ``is_first`` where that is the first of the joint."""
        foot, top = (link.end, link.begin) if is_first else (link.begin, link.end)
        lowest, kind, axis = self.low(foot), link.joint.kind, unit(link.axis) if link.axis is not None else None
        if kind == "weld":
            return self
        if kind == "slider" and axis is not None:
            way = play(link) * axis
            return Place(self.at, self.lowest + min(self.hangs(way), self.hangs(-way)), self.axis, self.angles)
        if kind != "hinge" or axis is None:
            return Place(top, lowest - play(link), None, (-math.pi, math.pi))
        angles = (-math.pi, math.pi) if link.joint.limits is None else tuple(units.magnitude(x) for x in link.joint.limits)
        along = 1.0 if is_first else -1.0
        if self.angles != (0.0, 0.0):  # about the same axis as the last joint it turns by both angles, about another one anyhow
            if self.axis is None or np.abs(np.cross(self.axis, axis)).max() > PARALLEL:
                return Place(top, lowest, None, self.angles)
            along, axis = along * float(np.sign(axis @ self.axis)), self.axis
        turned = sorted(along * angle for angle in angles)
        return Place(top, lowest, axis, (self.angles[0] + turned[0], self.angles[1] + turned[1]))


def hung(links: Links) -> list[Hung]:
    """The groups of rigid objects that can move."""
    held = [link for link in links.all if _holds(links, link)]
    groups = parts(link.ends for link in held)
    return [_group(links, part, [link for link in held if link.first in part]) for part in groups]


def _holds(links: Links, link: Link) -> bool:
    """Whether a joint keeps two rigid objects that can move at each other for good."""
    if len(link.ends) < 2 or link.joint.breaks is not None or play(link) == math.inf:
        return False
    return not any(kind_of(links.solids[m]).deforms or links.solids[m].hold for m in link.ends)


def _group(links: Links, part: list[int], held: Iterable[Link]) -> Hung:
    """From its heaviest object on, which stays upright, joint by joint.

    Each other one may get the energy that all of them lose where each hangs at its lowest: 1/2 m v^2 <= g sum of m_i d_i.
    """
    solids = links.solids
    ways: dict[int, list[tuple[int, Link, bool]]] = {m: [] for m in part}
    for link in held:
        ways[link.first].append((link.second, link, False))
        ways[link.second].append((link.first, link, True))
    mass = {m: shapes.mass(solids[m]) for m in part}
    first = max(part, key=mass.__getitem__)
    place = {first: Place(solids[first].position, solids[first].position[2], UP, (0.0, 0.0))}
    body = {first: first}
    waiting = [first]
    for m in waiting:
        for other, link, is_first in ways[m]:
            if other not in place:
                place[other] = place[m].beyond(link, is_first)
                body[other] = body[m] if link.joint.kind == "weld" else other
                waiting.append(other)
    drop = {m: max(0.0, solids[m].position[2] - place[m].low(solids[m].position)) for m in part}
    lost = sum(mass[m] * drop[m] for m in part)
    whole = {of: sum(mass[m] for m in part if body[m] == of) for of in set(body.values())}
    return Hung(first, {m: max(drop[m], lost / whole[body[m]]) for m in part})
