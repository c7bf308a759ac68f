# SPDX-License-Identifier: GPL-2.0-only
"""The particles of a body that a joint holds on to, and how far the body yields there (docs/physics-joints.md, "Patches").

A patch is a body that deforms alike everywhere: p = c + F d, with F = (sum m x r') S^-1, S = sum m r r'. A push on its point d
moves that by the mobility 1/M + d S^-1 d. Of a rigid body the patch is all of it, and what counts is how the body moves.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from ...model.system import System
from ...records import dataclass

NEAR, MORE = 1.01, 0.75
"""Radius of a patch around a particle, and beyond the nearest one, over the spacing: seven particles around one, and those of a
cell."""
WIDER = 1.5
"""Factor of the radius until the patch has three dimensions."""
FLAT = 1e-9
"""Second moment over the largest one, that is none."""
ALL = math.inf
"""Radius of a patch that is the whole body."""


@dataclass(frozen=True)
class Patch:
    """The part of an object that deforms, which one end of a joint holds on to."""

    radius: float
    """Particles of the object within this distance of the point belong to it [m]; ALL for the whole object."""
    rows: np.ndarray
    """Particles of the system, int64, shape (P,)."""
    mass: np.ndarray
    """Their masses [kg], shape (P,)."""
    arm: np.ndarray
    """Their places from the centre of the patch [m], shape (P, 3)."""
    centre: np.ndarray
    """[m], shape (3,)."""

    @cached_property
    def total(self) -> float:
        return float(self.mass.sum())

    @cached_property
    def inverse(self) -> np.ndarray:
        """S^-1 in the span of the patch [1/(kg m^2)], shape (3, 3)."""
        return np.linalg.pinv(np.einsum("p,pi,pj->ij", self.mass, self.arm, self.arm), rcond=FLAT, hermitian=True)

    @cached_property
    def size(self) -> float:
        """Root of the mean square of the distances from the centre [m]."""
        return math.sqrt(float((self.mass * (self.arm**2).sum(1)).sum()) / self.total)

    def of_point(self, point: np.ndarray) -> np.ndarray:
        """Weight of each particle in the place of a material point, shape (P,)."""
        return self.mass * (1.0 / self.total + self.arm @ self.inverse @ (point - self.centre))

    def of_direction(self, along: np.ndarray) -> np.ndarray:
        """Weight of each particle in a direction that goes with the patch [1/m], shape (P,)."""
        return self.mass * (self.arm @ self.inverse @ along)


def patch_of(system: System, m: int, point: np.ndarray, least: float = 0.0) -> Patch:
    """The patch of an object around a point: as small as has the dimensions of the object and a radius of `least` [m], or all of
    the object; of a line of particles the two nearest ones, and a third one that is as near as the second."""
    rows = np.arange(system.first[m], system.first[m + 1])
    place, mass = system.position[rows], system.mass[rows]
    away, h = np.linalg.norm(place - point, axis=1), float(system.spacing[m])
    dimensions = system.frames[system.contact_kind[m]].spans
    if dimensions == 1:
        radius = float(np.sort(away)[1]) + 0.1 * h
        return _patch(rows, mass, place, away <= radius, radius)
    radius = max(NEAR * h, float(away.min()) + MORE * h, least)
    while radius < away.max():
        near = away <= radius
        if _dimensions(place[near]) >= dimensions:
            break
        radius *= WIDER
    else:
        near, radius = np.ones(len(rows), bool), ALL
    return _patch(rows, mass, place, near, radius)


def whole(system: System, m: int) -> Patch:
    """All of an object."""
    rows = np.arange(system.first[m], system.first[m + 1])
    return _patch(rows, system.mass[rows], system.position[rows], np.ones(len(rows), bool), ALL)


def _patch(rows: np.ndarray, mass: np.ndarray, place: np.ndarray, near: np.ndarray, radius: float) -> Patch:
    centre = (mass[near, None] * place[near]).sum(0) / mass[near].sum()
    return Patch(radius, rows[near], mass[near], place[near] - centre, centre)


def _dimensions(place: np.ndarray) -> int:
    spread = place - place.mean(axis=0)
    values = np.linalg.eigvalsh(spread.T @ spread)
    return int((values > FLAT * values[-1]).sum()) if len(place) > 1 else 0
