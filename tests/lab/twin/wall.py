# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of plugin/wall/law.h: nearest surface points by formulas of our own, one function per shape."""

import numpy as np


def below_plane(x, point, normal):
    """Vectors (N, 3) from the plane to particles on the far side of it; zero for the others."""
    n = np.asarray(normal, float) / np.linalg.norm(normal)
    return np.minimum(0.0, (x - point) @ n)[:, None] * n


def outside_box(x, low, high):
    """Vectors from the nearest point of a box to particles outside it."""
    return x - np.clip(x, low, high)


def outside_sphere(x, centre, radius):
    """Vectors from a sphere to particles outside it."""
    d = x - centre
    r = np.linalg.norm(d, axis=1)[:, None]
    return np.where(r > radius, (1.0 - radius / r) * d, 0.0)


def inside_sphere(x, centre, radius):
    """Vectors from a sphere to particles inside it."""
    d = x - centre
    r = np.linalg.norm(d, axis=1)[:, None]
    return np.where(r < radius, (1.0 - radius / r) * d, 0.0)


def outside_tube(x, centre, radius, low, high):
    """Vectors from a cylinder along z, closed at low and high, to particles outside it."""
    d = np.zeros_like(x)
    d[:, :2] = outside_sphere(x[:, :2], centre, radius)
    d[:, 2] = x[:, 2] - np.clip(x[:, 2], low, high)
    return d
