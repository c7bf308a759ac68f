# SPDX-License-Identifier: GPL-2.0-only
"""Thickness of the thinnest part of a mesh; tips and edges, which are as thin as one likes, do not count."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np

from .triangles import areas, spots, unit_normals
from .vtk_surface import depth_below, hits

RAYS, EACH = 300, 3
"""Rays, and every which of them is asked for its ball."""
SHARE = 10
"""Part of the surface above which a part is asked about at all [%]."""
TIP = 1.5
"""A ball that grows by this factor where it slides along the body did not lie in a part, but in a tip."""
SLOPE = 0.05
"""Growth of a ball's radius over its way that counts: half the angle of the most slender cone whose end is a tip, 3 degrees."""
STALLED = 2
"""Moves that gain less before a ball rests: the first one may only have led it into the middle."""
MOST_MOVES = 60
SMOOTH = 0.3
"""Reach of the differences that tell where a ball grows, over its radius: on a ridge both sides count."""
STRIDES = (0.1, 0.25, 0.5, 1.0)
"""Moves along that direction that are tried, over the radius."""
AROUND = np.array([np.array(way) / np.linalg.norm(way) for way in product((-1, 0, 1), repeat=3) if any(way)])
"""Directions that are tried, 0.2 and 0.6 radii far, where those moves gain nothing: in a corner the middle is a line."""


def thickness(points: np.ndarray, triangles: np.ndarray, volume: float) -> float:
    """Estimate the thickness [m] of the thinnest part of a closed surface, points [m] (V, 3), triangles (T, 3), volume [m^3].

    From points spread evenly over the surface a ray goes straight inward; its length is the thickness there: exact for balls,
    slabs, rods and rings. The length that 10 % of the surface falls below counts. Next to a tip or a sharp edge rays are as short
    as one likes: a ball in the middle of such a ray grows as it slides inward, where in a part it does not. Where most of the
    shortest rays lie in tips, the balls that have ceased to grow count instead of the rays. No body is thicker than 6 V / A,
    which a ball reaches.
    """
    bound = 6 * volume / float(areas(points, triangles).sum())
    length, middle = _rays(points, triangles)
    if not len(length):
        return bound
    depth = depth_below(points, triangles)
    found = float(np.percentile(length, SHARE))
    shortest = length <= found
    if 2 * np.count_nonzero(2 * _grown(middle[shortest], depth) > TIP * length[shortest]) > np.count_nonzero(shortest):
        found = float(np.percentile(2 * _grown(middle[::EACH], depth), SHARE))
    return min(found, bound)


def _rays(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lengths of the rays [m], shape (R,), and their middles [m], shape (R, 3)."""
    area = areas(points, triangles)
    chosen = np.searchsorted(area.cumsum(), (np.arange(RAYS) + 0.5) / RAYS * area.sum()).clip(max=len(area) - 1)
    start, inward = spots(points[triangles[chosen]]), -unit_normals(points, triangles)[chosen]
    size = np.linalg.norm(np.ptp(points, axis=0))
    ray, met = hits(points, triangles, start + 1e-6 * size * inward, start + size * inward)
    length = np.full(RAYS, np.inf)
    np.minimum.at(length, ray, np.linalg.norm(met - start[ray], axis=1))
    length[np.isinf(length)] = 0.0
    found = length > 0
    return length[found], (start + length[:, None] / 2 * inward)[found]


def _grown(centre: np.ndarray, depth: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Radii [m], shape (B,), of the largest balls inside that balls around these places [m], shape (B, 3), grow to.

    A ball slides the way in which it grows, as long as its radius grows by more than SLOPE of its way.
    """
    centre, radius = centre.copy(), depth(centre)
    stalled = np.zeros(len(centre), int)
    for _ in range(MOST_MOVES):
        going = np.flatnonzero((stalled < STALLED) & (radius > 0))
        if not len(going):
            break
        at, r = centre[going], radius[going]
        axes = SMOOTH * np.concatenate([np.eye(3), -np.eye(3)])
        around = depth(at[:, None] + r[:, None, None] * axes)
        slope = (around[:, :3] - around[:, 3:]) / (2 * SMOOTH * r[:, None])
        ahead = slope / np.linalg.norm(slope, axis=1, keepdims=True).clip(min=1e-300)
        ways = np.concatenate([SMOOTH * slope[:, None], np.multiply.outer(STRIDES, ahead).swapaxes(0, 1)], axis=1)
        move, reached = _best(at, r, ways, depth)
        least = (1 + 0.2 * SLOPE) * r
        stuck = np.flatnonzero(reached < least)
        if len(stuck):
            ways = np.broadcast_to(np.concatenate([0.2 * AROUND, 0.6 * AROUND]), (len(stuck), 2 * len(AROUND), 3))
            other, grown = _best(at[stuck], r[stuck], ways, depth)
            more = grown > reached[stuck]
            move[stuck[more]], reached[stuck[more]] = other[more], grown[more]
        better = reached > r
        centre[going[better]], radius[going[better]] = (at + move)[better], reached[better]
        stalled[going] = np.where(reached < least, stalled[going] + 1, 0)
    return radius


def _best(at: np.ndarray, r: np.ndarray, ways: np.ndarray, depth) -> tuple[np.ndarray, np.ndarray]:
    """The move with the largest depth among the moves r * ways [m], shape (B, W, 3), from these places, and that depth."""
    moves = r[:, None, None] * ways
    found = depth(at[:, None] + moves)
    best = found.argmax(axis=1)
    row = np.arange(len(best))
    return moves[row, best], found[row, best]
