# SPDX-License-Identifier: GPL-2.0-only
"""The closed form behind scenes/cantilever.txt: a clamped Timoshenko beam that is let go under its own weight.

Ritz's method with Legendre polynomials converges to all digits that matter with a dozen of them; static mean deflection
q L^4 / 20 E I + q L^2 / 3 kappa G A to 1e-12.
"""

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh

POISSON = 0.25
"""Poisson's ratio of the lattice, docs/physics-solids.md."""
SHEAR = 10.0 * (1.0 + POISSON) / (12.0 + 11.0 * POISSON)
"""Cowper's coefficient of a rectangular cross section."""


def mean_sag(
    times, *, length: float, thickness: float, young: float, density: float, gravity: float = 9.81, functions: int = 14
) -> np.ndarray:
    """How far the centre of mass of a square bar hangs below where it was let go [m], shape of ``times`` [s].

    T = 1/2 int rho A w_t^2 + rho I th_t^2,  U = 1/2 int E I th_x^2 + kappa G A (w_x - th)^2, both zero at the clamp, x = 0.
    """
    area, inertia = thickness**2, thickness**4 / 12.0
    node, weight = legendre.leggauss(2 * functions)
    x, weight = 0.5 * length * (node + 1.0), 0.5 * length * weight
    shape = np.array([x * legendre.legval(node, unit) for unit in np.eye(functions)])
    slope = np.array(
        [
            legendre.legval(node, unit) + x * (2.0 / length) * legendre.legval(node, legendre.legder(unit))
            for unit in np.eye(functions)
        ]
    )

    def product(a, b):
        return (a * weight) @ b.T

    bend, shear = young * inertia, SHEAR * young / (2.0 * (1.0 + POISSON)) * area
    stiff = np.block(
        [
            [shear * product(slope, slope), -shear * product(slope, shape)],
            [-shear * product(shape, slope), bend * product(slope, slope) + shear * product(shape, shape)],
        ]
    )
    zero = np.zeros((functions, functions))
    mass = density * np.block([[area * product(shape, shape), zero], [zero, inertia * product(shape, shape)]])
    square, mode = eigh(stiff, mass)
    volume = np.concatenate([shape @ weight, np.zeros(functions)])
    share = (mode.T @ volume) ** 2 * density * area * gravity / square / length
    return (share * (1.0 - np.cos(np.sqrt(square) * np.asarray(times)[..., None]))).sum(-1)
