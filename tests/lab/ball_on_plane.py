# SPDX-License-Identifier: GPL-2.0-only
"""An elastic ball on a rigid plane, which Hertz took for a half-space: how near its centre comes, and how long a blow lasts.

The load is Hertz's pressure on a cap, and a body force that is even over the ball: its weight, or its inertia in a slow blow.
Displacements are a series of Legendre polynomials of which each is a closed form after A. E. H. Love, A treatise on the
mathematical theory of elasticity, without a half-space. Radius and Young's modulus are 1.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from scipy.special import eval_legendre

TERMS = 600
POISSON = 0.25


def approach(force: float, poisson: float = POISSON) -> tuple[float, float]:
    """How much nearer the mean of the ball comes to the plane by a force, and the same by Hertz.

    The mean of displacements over the pressure is that of least energy: an error of the pressure counts in second order.
    """
    stiff = 1.0 / (1.0 - poisson**2)
    radius = (0.75 * force / stiff) ** (1.0 / 3.0)
    node, weight = np.polynomial.legendre.leggauss(200)
    turn = 0.25 * math.pi * (node + 1.0)  # r = a sin turn
    r = radius * np.sin(turn)
    ring = weight * 0.25 * math.pi * radius * np.cos(turn) * 2.0 * math.pi * r  # dr 2 pi r
    pressure = 1.5 * force / (math.pi * radius**2) * np.cos(turn)
    cosine = np.sqrt(1.0 - r * r)  # of the angle from the pole
    lame, mu = poisson / (1.0 + poisson) / (1.0 - 2.0 * poisson), 0.5 / (1.0 + poisson)
    inwards = np.zeros_like(r)
    for n in range(TERMS):
        value = eval_legendre(n, cosine)
        load = (2 * n + 1) / (4.0 * math.pi) * float((ring * pressure * value).sum())  # p_n; the traction is -p_n P_n
        if n == 0:
            inwards += load / (3.0 * lame + 2.0 * mu)
        elif n == 1:
            even = force / (4.0 / 3.0 * math.pi) / (4.0 * mu + 6.0 * lame)  # A of u = A (r^2 e - 2 z x), without shear at r = 1
            inwards += even * cosine + even / 5.0  # radial displacement, and the mean of the ball
        else:
            a = -2.0 * (n * lame + (3 * n + 1) * mu) / ((n + 3) * lame + (n + 5) * mu)
            # u = C grad w + D (r^2 grad w + a x w), w = r^n P_n: rows are shear and normal traction at r = 1.
            matrix = np.array(
                [
                    [2.0 * (n - 1), 2.0 * n + a],
                    [2.0 * mu * n * (n - 1), lame * (2 * n + a * (n + 3)) + 2.0 * mu * (n + a) * (n + 1)],
                ]
            )
            c, d = np.linalg.solve(matrix, [0.0, load])
            inwards += (c * n + d * (n + a)) * value
    share = ring * pressure / force
    return float((share * (inwards + 0.5 * r * r)).sum()), radius**2


def force(way: float) -> float:
    """The force at which the mean of the ball has come nearer by `way`, up to 0.15."""
    return way**1.5 * float(np.interp(way, *_over_hertz()))


@lru_cache(maxsize=1)
def _over_hertz() -> tuple[np.ndarray, np.ndarray]:
    """Ways, and forces over way^1.5 there, which changes slowly."""
    forces = np.concatenate([[0.0], np.geomspace(1e-4, 6e-2, 12)])
    ways = np.array([approach(one)[0] for one in forces[1:]])
    return np.concatenate([[0.0], ways]), np.concatenate([[4.0 / 3.0 / (1.0 - POISSON**2)], forces[1:] / ways**1.5])


def contact_time(speed: float) -> float:
    """How long a ball of density 1 touches the plane in a slow blow: while its force turns it back, m w'' = -P(w)."""
    mass, way = 4.0 / 3.0 * math.pi, np.linspace(0.0, 0.14, 2001)
    pushes = np.array([force(one) for one in way])
    stored = np.concatenate([[0.0], np.cumsum(0.5 * way[1] * (pushes[1:] + pushes[:-1]))])
    most = float(np.interp(0.5 * mass * speed**2, stored, way))
    # w = most (1 - q^2) takes the root at the turn away.
    node, weight = np.polynomial.legendre.leggauss(60)
    q = 0.5 * (node + 1.0)
    left = speed**2 - 2.0 * np.interp(most * (1.0 - q * q), way, stored) / mass
    return float((weight * 2.0 * most * q / np.sqrt(left)).sum())
