# SPDX-License-Identifier: GPL-2.0-only
"""How much contact at surfaces will have to do: which objects are near each other and near planes, while each flies alone."""

from __future__ import annotations

import numpy as np

from ..effects import Meeting
from ..effects.contact_surface import OnSurfaces
from ..engine.commands import SKIN
from ..model.boxes import box_pairs
from ..model.planes import Plane
from ..run.prepare import Prepared
from ..scene.scene import Box, Cone, Cylinder
from .flight import Flight

AHEAD = 3.0
"""Seconds of the film that are looked at: beyond, flights through each other say no more than those before."""
MOMENTS = 12
"""Moments within them."""
NEAR = SKIN + 2.5
"""Spacings between boxes within which fix mdanim/contact watches points (STANDS_OUT in plugin/contact/contact_world.cpp)."""
HANDED = SKIN + 3.0
"""Spacings from a plane within which the fix is given the particles of an object (AROUND there)."""
TOUCHING = 0.05
"""Spacings between boxes that touch: rounding, and the depth of what lies there."""
SIDE, PATCH = 1.0 / 6.0, 1.0 / 40.0
"""Part of its points with which what has faces touches, and any other shape."""
FACED = (Box, Cylinder, Cone)
OFTEN = 0.2
"""Part of the time for which all but the largest object touch another one, and all a plane, in the mean of scenes/."""


def facing(gap: np.ndarray | float) -> np.ndarray | float:
    """Part that is watched of points of two bodies with a gap between them [spacings]: those farther off are fewer, and looked at
    less often."""
    return (1.0 - np.clip(gap, 0.0, NEAR) / NEAR) ** 2


def meetings(ready: Prepared) -> dict[str, Meeting]:
    """Of each effect that acts at surfaces: what is near in the mean of MOMENTS of the flights, and what touches at the start, or
    OFTEN where that is more."""
    effects = [e for e in ready.plan.effects if isinstance(e, OnSurfaces)]
    if not effects:
        return {}
    bodies, flight = _Bodies(ready), Flight(ready)
    planes = {e.name: e.planes(ready.scene) for e in effects}
    found: dict[str, list[tuple[float, float, float]]] = {name: [] for name in planes}
    for t in np.arange(MOMENTS) / MOMENTS * min(AHEAD, ready.scene.control.time):
        flight.to(float(t))
        low, high, _ = flight.boxes()
        for name, those in planes.items():
            found[name].append(bodies.near_planes(those, low, high) if those else bodies.near_others(low, high))
    told = {}
    for name, rows in found.items():
        near, handed, _ = np.mean(rows, axis=0)
        told[name] = Meeting(float(near), float(handed), max(rows[0][2], bodies.often(bool(planes[name]))))
    return told


class _Bodies:
    """Numbers of points and particles of each object, shape (M,)."""

    def __init__(self, ready: Prepared):
        system = ready.system
        kinds = [system.contact_bodies[k] for k in system.contact_kind.tolist()]
        self.spacing = float(system.spacing.max())
        self.points = np.array([len(body.at) for body in kinds])
        shapes = [system.frames[k].shape for k in system.contact_kind.tolist()]
        self.side = self.points * np.array([SIDE if isinstance(shape, FACED) else PATCH for shape in shapes])
        self.particles = np.diff(system.first)
        self.moves = ~system.still

    def often(self, on_plane: bool) -> float:
        """Points that touch, whatever is near: a plane has none itself, the other one of two objects has as many."""
        side = self.side[self.moves]
        return OFTEN * float(side.sum() if on_plane else 2.0 * (side.sum() - self.side.max() * self.moves.all()))

    def near_others(self, low: np.ndarray, high: np.ndarray) -> tuple[float, float, float]:
        """Of objects in boxes (M, 3) [m]: points that are watched, particles, points that touch, of both of each pair as many as
        of the smaller one."""
        near = touching = handed = 0.0
        given = np.zeros(len(low), bool)
        grown = 0.5 * NEAR * self.spacing
        for i, j in box_pairs(low - grown, high + grown):
            i, j = (these[self.moves[i] | self.moves[j]] for these in (i, j))
            given[i] = given[j] = True
            gap = np.maximum(low[i] - high[j], low[j] - high[i]).max(axis=1, initial=-np.inf) / self.spacing
            least, side, particles = (np.minimum(of[i], of[j]) for of in (self.points, self.side, self.particles))
            near += 2.0 * float((least * facing(gap)).sum())
            handed += 2.0 * float(particles.sum())
            touching += 2.0 * float(side[gap <= TOUCHING].sum())
        return near, min(handed, float(self.particles[given].sum())), touching

    def near_planes(self, planes: tuple[Plane, ...], low: np.ndarray, high: np.ndarray) -> tuple[float, float, float]:
        """The same of planes."""
        near = touching = handed = 0.0
        for plane in planes:
            gap = (low[:, plane.axis] - plane.at if plane.sign > 0 else plane.at - high[:, plane.axis]) / self.spacing
            there = self.moves & (gap <= NEAR)
            size = (high - low)[there, plane.axis] / self.spacing
            near += float((self.points[there] * facing(gap[there])).sum())
            handed += float((self.particles[there] * np.minimum(1.0, HANDED / size)).sum())
            touching += float(self.side[there & (gap <= TOUCHING)].sum())
        return near, handed, touching
