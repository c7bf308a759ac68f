# SPDX-License-Identifier: GPL-2.0-only
"""A naive NumPy twin of a whole scene: every law written out from its formula, all pairs looked at, no plugin, no LAMMPS."""

import numpy as np


def spring_forces(x, pair, k, r0):
    """Wcislo 1999, eq. (3.5)-(3.7), with the sign that makes a stretched spring pull: force on every particle, and the energy."""
    d = x[pair[:, 0]] - x[pair[:, 1]]
    r = np.sqrt((d**2).sum(1))
    pull = (-k * (r - r0) / r)[:, None] * d
    f = np.zeros_like(x)
    np.add.at(f, pair[:, 0], pull)
    np.add.at(f, pair[:, 1], -pull)
    return f, float((0.5 * k * (r - r0) ** 2).sum())


def barrier_forces(x, solid, boundary, thin, s, reach):
    """The cubic barrier U = kc rc^2/3 (1 - r/rc)^3 between boundary and inner (or thin) particles of different solids."""
    f, energy = np.zeros_like(x), 0.0
    for i in range(len(x)):
        others = np.flatnonzero(solid > solid[i])
        apart = np.linalg.norm(x[i] - x[others], axis=1)
        for j in others[apart < np.maximum(reach[i], reach[others])]:  # none acts from farther
            rc = max(reach[i], reach[j])
            if boundary[i] and boundary[j]:
                if not (thin[i] or thin[j]):
                    continue
                rc *= 0.75
            elif not (boundary[i] or boundary[j]):
                continue
            d = x[i] - x[j]
            r = np.sqrt(d @ d)
            if r >= rc:
                continue
            kc = 2 * s[i] * s[j] / (s[i] + s[j])
            push = kc * rc * (1 - r / rc) ** 2 * d / r
            f[i] += push
            f[j] -= push
            energy += kc * rc**2 / 3 * (1 - r / rc) ** 3
    return f, energy


def ground_forces(x, z, s):
    """A one-sided spring of stiffness s below the plane."""
    f = np.zeros_like(x)
    depth = np.maximum(0.0, z - x[:, 2])
    f[:, 2] = s * depth
    return f, float((0.5 * s * depth**2).sum())


def leapfrog(x, v, force, mass, drag, dt, steps, free):
    """Wcislo 1999, eq. (3.12) as printed, started by half a step; returns positions and whole-step velocities (3.10)."""
    x, v = x.copy(), v.copy()
    m = mass[:, None]
    phi = drag[:, None] * dt / (2 * m)
    f = force(x)
    half = np.where(free[:, None], (1 - phi) * v + dt / (2 * m) * f, 0.0)
    for _ in range(steps):
        x = x + dt * half
        f = force(x)
        after = np.where(free[:, None], (1 - phi) / (1 + phi) * half + dt / m * f / (1 + phi), 0.0)
        v = (half + after) / 2
        half = after
    return x, v
