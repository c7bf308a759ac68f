# SPDX-License-Identifier: GPL-2.0-only
"""Rigid bodies, and what tests of their motion and of their contact by features share."""

from __future__ import annotations

import numpy as np
import rigid_lab as lab

G = 9.81

CUBE, DOMINO, BALL = lab.box((0.1, 0.1, 0.1)), lab.box((0.06, 0.2, 0.4)), lab.ball(0.05)
WEDGE = CUBE.put(shape=lab.prism(3, 0.07, 0.1), thin=0.1)
"""With the mass of the cube: what is conserved does not depend on it."""
COIN = CUBE.put(shape=lab.prism(12, 0.07, 0.04), thin=0.04)
"""Its twelve sides meet at blunt edges."""


CAN, CONE, EGG = lab.cylinder(0.05, 0.12), lab.cone(0.06, 0.15), lab.ellipsoid((0.04, 0.05, 0.08))


def tilted(tangent):
    """Gravity on a slope that falls along x, and its sine and cosine."""
    cosine = 1.0 / np.hypot(1.0, tangent)
    return (G * tangent * cosine, 0.0, -G * cosine), tangent * cosine, cosine


def rolled(world):
    """Acceleration along x of the first body over the second half of one second, and its row then."""
    half = round(0.5 / world.dt)
    world.run(half)
    first = world.rows()[0]
    world.run(half)
    last = world.rows()[0]
    return (last[3] - first[3]) / (half * world.dt), last


def meeting(random, two):
    """Two bodies that meet at 2 m/s, turned and spinning at random."""
    found = []
    for body, place in zip(two, ((0, 0, 0), (0.6, *(0.03 * random.uniform(-1, 1, 2))))):
        q = lab.about(random.uniform(-1, 1, 3), 3.0 * random.uniform(-1, 1))
        found.append(body.put(at=place, q=q, spin=2.0 * random.uniform(-1, 1, 3), beta=0.0))
    return found[0], found[1].put(v=(-2, 0, 0))


def momenta(bodies, rows):
    """Momentum, angular momentum and kinetic energy of all bodies."""
    p = np.array([b.mass for b in bodies])[:, None] * rows[:, 3:6]
    turned = [lab.matrix(r[6:10]) for r in rows]
    own = np.array([t @ (np.sort(b.moments) * (t.T @ r[10:])) for t, b, r in zip(turned, bodies, rows)])
    return p.sum(0), (np.cross(rows[:, :3], p) + own).sum(0), 0.5 * (p * rows[:, 3:6] + own * rows[:, 10:]).sum()
