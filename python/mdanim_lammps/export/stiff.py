# SPDX-License-Identifier: GPL-2.0-only
"""Objects that keep their shape in all frames: a place and a rotation a frame is all that a file needs of them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..records import dataclass

SAME = 1e-5
"""Largest distance of a particle from its place in a body that keeps its shape, over the size of the body."""
LINE = 1e-3
"""Width of particles over their length, below which they are on a line and tell no rotation about it."""


@dataclass(frozen=True)
class StiffMotion:
    """Motion of O objects in F frames from the first of these."""

    keeps: np.ndarray
    """Whether each keeps its shape in all frames, bool, shape (O,)."""
    centre: np.ndarray
    """Mean place of the particles [m], shape (F, O, 3)."""
    rotation: np.ndarray
    """From the first frame, about the centre, as quaternions x, y, z, w; of neighbouring frames the nearer one of both signs,
    shape (F, O, 4)."""


def stiff_motion(frames: Iterable[np.ndarray], first: np.ndarray) -> StiffMotion:
    """The best rotations by Kabsch (1976) from the first frame, and who keeps its shape.

    Args:
        frames: positions of particles [m], shape (N, 3) each, object by object.
        first: the first particle of each object, and N, shape (O + 1,).
    """
    begin, count = first[:-1], np.diff(first)
    owner = np.repeat(np.arange(len(count)), count)
    centres, rotations, own, start, size = [], [], None, None, None
    for x in frames:
        centre = np.add.reduceat(x, begin) / count[:, None]
        apart = x - centre[owner]
        if start is None:
            start = apart
            size = np.sqrt(np.maximum.reduceat((start**2).sum(axis=1), begin))
            spread = np.linalg.svd(np.add.reduceat(start[:, :, None] * start[:, None, :], begin), compute_uv=False)
            own = spread[:, 1] > LINE**2 * spread[:, 0]
        u, _, vt = np.linalg.svd(np.add.reduceat(start[:, :, None] * apart[:, None, :], begin))
        u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
        turn = np.swapaxes(u @ vt, 1, 2)
        off = np.abs(np.einsum("nij,nj->ni", turn[owner], start) - apart).max(axis=1)
        own &= np.maximum.reduceat(off, begin) <= SAME * size
        q = _quaternions(turn)
        if rotations:
            q *= np.where((q * rotations[-1]).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
        centres.append(centre)
        rotations.append(q)
    return StiffMotion(own, np.array(centres), np.array(rotations))


def _quaternions(r: np.ndarray) -> np.ndarray:
    """Quaternions x, y, z, w of rotation matrices of shape (O, 3, 3); shape (O, 4)."""
    # The eigenvector of the largest eigenvalue, 1, of this matrix (Bar-Itzhack 2000): no case is near a division by zero.
    k = np.zeros((len(r), 4, 4))
    for i in range(3):
        j, m = (i + 1) % 3, (i + 2) % 3
        k[:, i, i] = r[:, i, i] - r[:, j, j] - r[:, m, m]
        k[:, i, j] = k[:, j, i] = r[:, i, j] + r[:, j, i]
        k[:, i, 3] = k[:, 3, i] = r[:, m, j] - r[:, j, m]
    k[:, 3, 3] = np.trace(r, axis1=1, axis2=2)
    return np.linalg.eigh(k)[1][:, :, 3]
