# SPDX-License-Identifier: GPL-2.0-only
"""Shapes of streams: what comes in above the surface of a liquid falls on it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .measure import height_at

RINGS, AROUND = 14, 20
"""Rings of points along a stream, and points of each."""
FLAT = 2.5
"""Long over short side of an inflow from which on its stream is a curtain as wide as the long one."""
SLOWEST = 0.2
"""Speed at which a stream begins at least [m/s]."""


def stream_points(trajectory, inflow, gravity: float) -> Callable[[int], np.ndarray]:
    """Gives the points of the stream of an inflow in a frame [m], shape (RINGS AROUND + 2, 3); all in one place where the inflow
    is below the surface."""
    low, high = np.array(inflow.low), np.array(inflow.high)
    middle, sides = 0.5 * (low + high), (high - low)[:2]
    grid = trajectory.liquid.grid
    most = 0.45 * np.maximum(sides, grid.cell[:2])
    begin = max(SLOWEST, inflow.rate / float(np.pi * most.prod()))
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND

    def points(frame: int) -> np.ndarray:
        time, top = float(trajectory.times[frame]), middle[2]
        surface = height_at((middle[0], middle[1]), grid, trajectory.liquid_height(frame))
        bottom = max(surface, top - begin * time - 0.5 * gravity * time**2)
        if bottom >= top:
            return np.tile(middle, (RINGS * AROUND + 2, 1))
        z = np.linspace(top, bottom, RINGS)
        half = half_axes(inflow.rate / np.sqrt(begin**2 + 2.0 * gravity * (top - z)), most)
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        across = middle[:2] + half[:, None] * ring
        rings = np.concatenate([across, np.broadcast_to(z[:, None, None], (RINGS, AROUND, 1))], axis=2)
        ends = np.array([[*middle[:2], top], [*middle[:2], bottom]])
        return np.concatenate([rings.reshape(-1, 3), ends])

    return points


def half_axes(area: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Half axes along x and y of ellipses of these areas [m], shape (K, 2), that are not wider than an inflow with the half axes
    ``most``: a curtain keeps the long one."""
    radius = np.sqrt(area / np.pi)
    found = np.minimum(np.stack([radius, radius], axis=1), most)
    wide = int(most.argmax())
    if most[wide] > FLAT * most[1 - wide]:
        found[:, wide] = most[wide]
        found[:, 1 - wide] = np.minimum(area / (np.pi * most[wide]), most[1 - wide])
    return found


def stream_triangles() -> np.ndarray:
    """Numbers of points, outward, of rings from above, then the middles of the first and the last one."""
    j, after = np.arange(AROUND), np.roll(np.arange(AROUND), -1)
    found = []
    for ring in range(RINGS - 1):
        a, b = ring * AROUND, (ring + 1) * AROUND
        found += [np.stack([a + j, b + j, b + after], axis=1), np.stack([a + j, b + after, a + after], axis=1)]
    last = (RINGS - 1) * AROUND
    found.append(np.stack([np.full(AROUND, RINGS * AROUND), j, after], axis=1))
    found.append(np.stack([np.full(AROUND, RINGS * AROUND + 1), last + after, last + j], axis=1))
    return np.concatenate(found)
