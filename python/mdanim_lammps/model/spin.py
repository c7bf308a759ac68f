# SPDX-License-Identifier: GPL-2.0-only
"""Spin and rotation of objects, from their particles."""

from __future__ import annotations

import numpy as np


def spin(mass: np.ndarray, first: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Angular velocity of each object [rad/s], shape (O, 3): its angular momentum about its centre of mass over its inertia.
    NaN where a damaged file has places or masses that are not finite, or too large for their squares.

    Args:
        mass: of N particles [kg], shape (N,).
        first: first particle of each object, shape (O,).
        position, velocity: [m], [m/s], shape (N, 3).
    """
    count = np.diff(first, append=len(mass))
    mean = lambda value: np.add.reduceat(mass[:, None] * value, first) / np.add.reduceat(mass, first)[:, None]
    arm, speed = position - np.repeat(mean(position), count, axis=0), velocity - np.repeat(mean(velocity), count, axis=0)
    momentum = np.add.reduceat(mass[:, None] * np.cross(arm, speed), first)
    square = np.einsum("nd,nd->n", arm, arm)
    inertia = np.add.reduceat(
        mass[:, None, None] * (square[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]), first
    )
    # A line of particles has no inertia about itself: there the spin is zero. Of numbers that are not finite there is none.
    finite = np.isfinite(inertia).all((1, 2))
    found = np.full(momentum.shape, np.nan)
    found[finite] = np.einsum("oij,oj->oi", np.linalg.pinv(inertia[finite], hermitian=True), momentum[finite])
    return found


def rotation(mass: np.ndarray, start: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Rotation from one place to another, of least squares over particles: a matrix, shape (3, 3).

    Args:
        mass: of N particles [kg], shape (N,).
        start, now: their places [m], shape (N, 3).
    """
    start, now = (x - np.average(x, axis=0, weights=mass) for x in (start, now))
    u, _, v = np.linalg.svd(np.einsum("n,ni,nj->ij", mass, now, start))
    return u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))]) @ v
