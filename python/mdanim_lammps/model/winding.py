# SPDX-License-Identifier: GPL-2.0-only
"""The winding number of a surface that need not be closed, on a grid, and the surface where it passes one half."""

from __future__ import annotations

import numpy as np

from .nearest import blocks
from .triangles import normals, spots, surface_of

CELLS = 96
"""Cells along the longest edge of the box about a surface: a body of 20 lattice cells has five of them in each."""
MARGIN = 3
"""Cells around it."""
SAMPLES = 4.0
"""Samples along the edge of a cell. With two the number beside a sheet reaches 0.52, with four 0.50."""
LEVEL = 0.51
"""Winding number on the new surface: that beside a sheet is one half, and it encloses nothing."""


def enclosing(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) and triangles (T, 3) of a closed surface around all that the given ones enclose; none where that is less than
    a cell thick. Neighbours must face one way; a part that faces inward as a whole encloses what it would outward.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    edge = float((high - low).max()) / CELLS
    size = np.ceil((high - low) / edge).astype(int) + 1 + 2 * MARGIN
    origin = 0.5 * (low + high - edge * (size - 1))
    winding = winding_number((points - origin) / edge, triangles, size)
    import pyvista

    grid = pyvista.ImageData(dimensions=size, spacing=(edge,) * 3, origin=origin)
    surface = grid.contour([LEVEL], scalars=abs(winding).ravel(order="F"), method="flying_edges")
    return surface_of(surface)


def winding_number(points: np.ndarray, triangles: np.ndarray, size: np.ndarray) -> np.ndarray:
    """At the nodes of a grid of these numbers of nodes, which are 1 apart from the origin on, shape size.

    That of a surface S with normals n,

        w(x) = 1/4pi ∫ n(y)·(y - x)/|y - x|³ dA,

    is 1 inside and 0 outside of a closed one, and takes all values between in a gap (Jacobson, Kavan and Sorkine-Hornung
    2013). It is a convolution of n dA with -x/4pi|x|³, here by fast Fourier transforms of n dA spread over the nodes.
    """
    from scipy.fft import irfftn, next_fast_len, rfftn

    room = [next_fast_len(2 * int(n), real=True) for n in size]
    x = np.meshgrid(*(np.where(np.arange(n) < n / 2, np.arange(n), np.arange(n) - n) for n in room), indexing="ij", sparse=True)
    cubed = sum(along.astype(float) ** 2 for along in x) ** 1.5
    cubed[0, 0, 0] = np.inf
    flux = _flux(points, triangles, size)
    total = sum(rfftn(part, room) * rfftn(-along / (4.0 * np.pi * cubed)) for part, along in zip(flux, x))
    return irfftn(total, room)[tuple(slice(n) for n in size)]


def _flux(points: np.ndarray, triangles: np.ndarray, size: np.ndarray) -> np.ndarray:
    """n dA, spread over the eight nodes around each sample of the surface by linear weights, shape (3, *size)."""
    corners = points[triangles]
    vector = 0.5 * normals(points, triangles)
    count = np.ceil(np.linalg.norm(vector, axis=1) * SAMPLES**2).clip(min=1).astype(np.int64)
    of = np.repeat(np.arange(len(count)), count)
    flux = np.zeros((3, size.prod()))
    for rows in blocks(len(of)):
        place = spots(corners[of[rows]], first=rows.start)
        part = vector[of[rows]] / count[of[rows], None]
        node = np.floor(place).astype(np.int64)
        beyond = place - node
        for step in np.ndindex(2, 2, 2):
            weight = np.where(step, beyond, 1.0 - beyond).prod(axis=1)
            at = np.ravel_multi_index(tuple((node + step).T), size)
            for axis in range(3):
                flux[axis] += np.bincount(at, weight * part[:, axis], minlength=flux.shape[1])
    return flux.reshape(3, *size)
