# SPDX-License-Identifier: GPL-2.0-only
"""Objects that start within reach of each other's contact, or behind a plane: the energy of contact at the start, and the gap
with which there is none.

The laws are those of plugin/barrier/law.h and plugin/wall/law.h, on the initial positions.
"""

from __future__ import annotations

import numpy as np

from ...model.boxes import box_pairs
from ...model.model import Layer
from ...model.system import System
from ...records import dataclass

REACH = 1.6
"""Reach of the barrier over the spacing: the smoothest of the forms measured (docs/physics-contact.md)."""
THIN = 0.75
"""Reach of a thin object's own boundary over REACH: 1.2 spacings."""
WAYS = np.concatenate([np.eye(3), -np.eye(3)])
"""Directions in which an object may be moved away, shape (6, 3)."""
WAY_NAMES = ("to +x", "to +y", "up", "to -x", "to -y", "down")
MORE = 1.0 + 1e-6
"""Margin on distances: exactly at the reach the result would depend on rounding."""


@dataclass(frozen=True, slots=True)
class Touch:
    """Two objects that start within reach of each other, or one that starts behind a plane."""

    first: int
    """Number of the object that stays, -1 for a plane."""
    second: int
    """Number of the object to be moved."""
    energy: float
    """Energy of contact at the start [J]."""
    way: int
    """Row of WAYS along which the shortest move separates the two."""
    move: float
    """Length of this move, after which contact has no energy [m]."""
    gap: float
    """Gap between the two boxes along this row after the move [m]; 0 for a plane."""


def touching(system: System, k: np.ndarray) -> list[Touch]:
    """Pairs of objects whose contact has energy at the start, the largest energy first; ``k`` is the stiffness of each particle
    [N/m], shape (N,)."""
    one, other, reach, energy = touching_pairs(system, k)
    if not len(one):
        return []
    swap = system.object[one] > system.object[other]
    low, high = np.where(swap, other, one), np.where(swap, one, other)
    objects, pair = np.unique(np.stack([system.object[low], system.object[high]], axis=1), axis=0, return_inverse=True)
    pair = pair.reshape(-1)
    total = np.bincount(pair, energy, len(objects))
    moves = np.zeros((len(objects), len(WAYS)))
    np.maximum.at(moves, pair, ways_out(system.position[high] - system.position[low], reach))
    # Objects that never move are moved last: such objects are a scene's architecture.
    still = system.still[objects[:, 1]] & ~system.still[objects[:, 0]]
    moves[still] = np.roll(moves[still], 3, axis=1)
    first, second = np.where(still, objects[:, 1], objects[:, 0]), np.where(still, objects[:, 0], objects[:, 1])
    way = moves.argmin(axis=1)
    move = np.take_along_axis(moves, way[:, None], axis=1)[:, 0] * MORE
    low, high = system.bounds(system.position)
    apart = np.concatenate([low[second] - high[first], low[first] - high[second]], axis=1)
    gap = np.take_along_axis(apart, way[:, None], axis=1)[:, 0] + move
    columns = (a[np.argsort(-total, kind="stable")].tolist() for a in (first, second, total, way, move, gap))
    return [Touch(*row) for row in zip(*columns)]


def ways_out(apart: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Distance along WAYS after which the second particle of each pair is out of reach [m], shape (P, 6).

    ``apart`` is its place as seen from the first [m], shape (P, 3); ``reach`` [m], shape (P,).
    """
    along = apart @ WAYS.T
    aside = (apart**2).sum(axis=1)[:, None] - along**2
    return np.sqrt(np.maximum(0.0, reach[:, None] ** 2 - aside)) - along


def touching_pairs(system: System, k: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of particles of two objects within reach at the start, of which one can move: their numbers, reach [m] and
    energy [J], each of shape (P,)."""
    near = _near_others(system)
    inner, boundary = near & ~system.boundary, near & system.boundary
    thin = near & (system.layer == Layer.THIN)
    found = [_within_reach(system, boundary, inner, 1.0), _within_reach(system, thin, boundary, THIN)]
    one, other, reach = (np.concatenate(parts) for parts in zip(*found))
    q = 1.0 - np.linalg.norm(system.position[one] - system.position[other], axis=1) / reach
    return one, other, reach, 2.0 * k[one] * k[other] / (k[one] + k[other]) * reach**2 / 3.0 * q**3


def _near_others(system: System) -> np.ndarray:
    """Particles that lie within reach of the box of another object, bool, shape (N,)."""
    far = REACH * float(system.spacing.max())
    low, high = system.bounds(system.position)
    # The region of partners, for each object: the box around all boxes within reach of its own box.
    zone_low, zone_high = np.full_like(low, np.inf), np.full_like(high, -np.inf)
    for i, j in box_pairs(low - far, high):
        for a, b in ((i, j), (j, i)):
            np.minimum.at(zone_low, a, low[b] - far)
            np.maximum.at(zone_high, a, high[b] + far)
    return ((system.position >= zone_low[system.object]) & (system.position <= zone_high[system.object])).all(axis=1)


def _within_reach(system: System, seek: np.ndarray, guard: np.ndarray, factor: float) -> tuple[np.ndarray, ...]:
    """Pairs of a particle of ``seek`` and one of ``guard``, bool (N,), of two objects, within ``factor`` of the larger reach;
    a pair that is in both once."""
    seekers, guards = np.flatnonzero(seek), np.flatnonzero(guard)
    if not len(seekers) or not len(guards):
        return np.zeros(0, np.intp), np.zeros(0, np.intp), np.zeros(0)
    from scipy.spatial import cKDTree  # takes half a second

    x, owner = system.position, system.object
    farthest = factor * REACH * float(system.spacing.max())
    found = cKDTree(x[seekers]).sparse_distance_matrix(cKDTree(x[guards]), farthest, output_type="ndarray")
    one, other = seekers[found["i"]], guards[found["j"]]
    reach = factor * REACH * np.maximum(system.spacing[owner[one]], system.spacing[owner[other]])
    keep = (owner[one] != owner[other]) & (found["v"] * MORE < reach) & ~(system.held[one] & system.held[other])
    keep &= ~(seek[other] & guard[one] & (one > other))
    return one[keep], other[keep], reach[keep]


def behind_planes(system: System, k: np.ndarray, low: np.ndarray, high: np.ndarray) -> list[Touch]:
    """The same of objects with particles beyond the planes at ``low`` and ``high`` [m], each of shape (3,), infinite where none
    is."""
    beyond = np.concatenate([low - system.position, system.position - high], axis=1)
    beyond = np.where(system.held[:, None], 0.0, np.maximum(beyond, 0.0))
    energy = 0.5 * k * (beyond**2).sum(axis=1)
    total = np.add.reduceat(energy, system.first[:-1])
    deepest = np.maximum.reduceat(beyond, system.first[:-1])
    return [
        Touch(-1, int(m), float(total[m]), int(deepest[m].argmax()), float(deepest[m].max()) * MORE, 0.0)
        for m in np.argsort(-total, kind="stable")
        if total[m] > 0.0
    ]
