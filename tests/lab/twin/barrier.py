# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of plugin/barrier/law.h: every pair of particles, one at a time, no boxes."""

import numpy as np


def barrier_forces(x, molecule, boundary, inner, stiffness, reach, thin=None, ratio=0.0):
    """Forces (N, 3), energy; ``boundary``, ``inner``, ``thin`` bool (N,); ``stiffness``, ``reach`` (N,)."""
    thin = np.zeros(len(x), bool) if thin is None else thin
    force, energy = np.zeros_like(x), 0.0
    for i in range(len(x)):
        for j in range(i + 1, len(x)):
            if molecule[i] == molecule[j]:
                continue
            rc = max(reach[i], reach[j])
            if boundary[i] and boundary[j]:
                if not (thin[i] or thin[j]):
                    continue
                rc *= ratio
            elif not ((boundary[i] and inner[j]) or (inner[i] and boundary[j])):
                continue
            r = np.linalg.norm(x[i] - x[j])
            if r >= rc:
                continue
            k = 2.0 * stiffness[i] * stiffness[j] / (stiffness[i] + stiffness[j])
            n = (x[i] - x[j]) / r
            f, u = k * rc * (1.0 - r / rc) ** 2, k * rc**2 / 3.0 * (1.0 - r / rc) ** 3
            force[i] += f * n
            force[j] -= f * n
            energy += u
    return force, energy


def boxes(x, molecule):
    """Lower and upper corners of every object's box, eq. (3.14), each (M, 3)."""
    objects = np.unique(molecule)
    return (np.array([x[molecule == m].min(0) for m in objects]), np.array([x[molecule == m].max(0) for m in objects]))


def meeting(low, high, gap):
    """Number of pairs of boxes at most ``gap`` apart along each axis, eq. (3.15), by trying all pairs."""
    return sum(
        bool((low[a] - high[b] <= gap).all() and (low[b] - high[a] <= gap).all())
        for a in range(len(low))
        for b in range(a + 1, len(low))
    )
