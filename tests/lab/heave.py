# SPDX-License-Identifier: GPL-2.0-only
"""Reference for a box that bobs: linear potential flow round it, with a free surface, by finite volumes.

Where ``waves.h`` has columns, this has cells in the height as well, so that liquid under the box has its vertical inertia. The
cell of the waves, g and the density of the liquid are 1.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu


def bobbing(side: float, draft: float, width: float, depth: float, *, flat=False, fine=2, time=24.0, dt=0.1) -> np.ndarray:
    """Height over its rest of a box let go from 1, after each `dt`: (time/dt,).

    The box of square outline is in the middle of a square basin of `width`; where `flat`, box and basin are endless along y. A
    quarter is computed (a half), with `fine` cells to a length of 1, of which all lengths are multiples.
    """
    h = 1.0 / fine
    nx, nz, half, deep = (round(length * fine) for length in (width / 2, depth, side / 2, draft))
    ny, half_y = (1, 1) if flat else (nx, half)
    wet = np.ones((nz, ny, nx), bool)
    wet[nz - deep :, :half_y, :half] = False
    number = np.full(wet.shape, -1)
    number[wet] = np.arange(wet.sum())
    pairs = []
    for axis in range(3):
        along = np.moveaxis(number, axis, 0)
        pair = np.stack([along[:-1].ravel(), along[1:].ravel()])
        pairs.append(pair[:, (pair >= 0).all(0)])
    a, b = np.concatenate(pairs, axis=1)
    top, bottom = number[-1][wet[-1]], number[nz - deep - 1, :half_y, :half].ravel()
    one = np.ones(len(a))
    rows, columns = np.concatenate([a, b, a, b, top]), np.concatenate([a, b, b, a, top])
    solve = splu(coo_matrix((np.concatenate([one, one, -one, -one, np.full(len(top), 2.0)]), (rows, columns))).tocsc()).solve

    def potential(at_surface, speed):
        """In all cells, from that at the surface and from the velocity of the box."""
        rhs = np.zeros(wet.sum())
        rhs[top] = 2 * at_surface
        rhs[bottom] += speed * h
        return solve(rhs)

    def below(phi, speed):
        """Integral over the bottom of the whole box."""
        return (phi[bottom] + speed * h / 2).sum() * (2 * h if flat else 4 * h * h)

    area = side if flat else side * side
    along = below(potential(np.zeros(len(top)), 1.0), 1.0)  # mass of the liquid that moves at once
    z, v, height, at_surface = 1.0, 0.0, np.zeros(len(top)), np.zeros(len(top))
    path = []
    for _ in range(round(time / dt)):
        v += dt * (-below(potential(-height, 0.0), 0.0) - area * z) / (area * draft + along)
        at_surface -= dt * height
        height += dt * 2 * (at_surface - potential(at_surface, v)[top]) / h
        z += dt * v
        path.append(z)
    return np.array(path)
