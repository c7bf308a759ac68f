# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of plugin/springs/law.h: Wcislo 1999, eq. (3.6), (3.7), one bond at a time."""

import numpy as np


def spring_forces(x, v, bond, k, r0, c=0.0):
    """Forces (N, 3) and energy of springs k/2 (r - r0)^2 with dashpots -c (v_ij . n) n; 0-based pairs."""
    force, energy = np.zeros_like(x), 0.0
    for (i, j), ks, rest in zip(bond, k, r0):
        r = np.linalg.norm(x[i] - x[j])
        n = (x[i] - x[j]) / r
        f = -ks * (r - rest) * n - c * np.dot(v[i] - v[j], n) * n
        force[i] += f
        force[j] -= f
        energy += 0.5 * ks * (r - rest) ** 2
    return force, energy
