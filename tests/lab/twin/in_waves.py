# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of what level, still liquid with momentum does to lattices of particles (plugin/lammps/buoyancy.cpp).

docs/physics-liquid.md, "Volume by parts of lattice cells", "Drag" and "Solids are calmed". Cells of the liquid are cubes.
"""

import numpy as np


def forces(x, v, cells, volume, mass, level, edge, g, rho, quadratic):
    """Force of the liquid on each particle, without the part of drag that the leap-frog takes, shape (N, 3).

    Args:
        x, v: positions from the floor and corner of the basin, and velocities, shape (N, 3).
        cells: corners of lattice cells, shape (C, 8).
        volume, mass: shape (N,).
        level, edge: height of the surface, and edge of a cell of liquid.
        g, rho: gravity and density of the liquid.
        quadratic: drag is -(gamma + quadratic |v|) rho V s v, of which the leap-frog takes the part of gamma.
    """
    found = np.zeros_like(x)
    rising = upward(x, v, mass, edge)
    for n in range(len(x)):
        below = []
        for cell in cells[(cells == n).any(axis=1)]:
            # The middle of the part nearest to a corner, half way to it; a part is half as high as a cell.
            z = 0.5 * (x[cell, 2].mean() + x[n, 2]) / edge
            below.append(np.clip(2.0 * (level / edge - z) + 0.5, 0.0, 1.0))
        s = np.mean(below)
        found[n, 2] += rho * volume[n] * s * g
        found[n] -= quadratic[n] * np.linalg.norm(v[n]) * rho * volume[n] * s * v[n]
        found[n, 2] -= min(mass[n], rho * volume[n]) * s * np.sqrt(g / edge) * (v[n, 2] - rising[n])
    return found


def upward(x, v, mass, edge):
    """Mean upward velocity of the columns of solids around each particle: mass goes to the four columns around, linearly."""
    shape = np.floor(x[:, :2].max(axis=0) / edge).astype(int) + 2
    total, momentum = np.zeros(shape), np.zeros(shape)
    around = []
    for place in x[:, :2] / edge - 0.5:
        i, j = np.floor(place).astype(int)
        u, w = place - (i, j)
        around.append([(i, j, (1 - u) * (1 - w)), (i + 1, j, u * (1 - w)), (i, j + 1, (1 - u) * w), (i + 1, j + 1, u * w)])
    for n, columns in enumerate(around):
        for i, j, share in columns:
            total[i, j] += share * mass[n]
            momentum[i, j] += share * mass[n] * v[n, 2]
    mean = [[(momentum[i, j] / total[i, j], share) for i, j, share in columns if total[i, j] > 0] for columns in around]
    return np.array([np.average([value for value, _ in row], weights=[share for _, share in row]) for row in mean])
