# SPDX-License-Identifier: GPL-2.0-only
"""Elastic constants of lattices by sparse linear algebra."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.scene.scene import Box
from model_samples import model
from scipy.sparse import diags
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from twin import lattice as twin

NU = 0.25


def solve(body, fixed, force):
    """Displacements (N, 3) of a body with fixed coordinates, bool (N, 3), under forces (N, 3)."""
    free = np.flatnonzero(~fixed.ravel())
    k = twin.stiffness_matrix(body.position, body.spring, body.stiffness)[free][:, free]
    u = np.zeros(fixed.size)
    u[free] = splu(k, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(force.ravel()[free])
    return u.reshape(-1, 3)


def stretched(body):
    """Young's modulus and Poisson's ratio [Pa, -] of a cuboid under an even pull along x, both away from its ends.

    An even pull is not what the particles of an end bear in an even strain, since outer springs are weaker than
    inner ones; so the end itself gives way as if the bar were 0.1 to 0.24 cells longer, and what comes of it dies away inward.
    """
    x = body.position
    left, right = x[:, 0] < x[:, 0].min() + 1e-6, x[:, 0] > x[:, 0].max() - 1e-6
    _, width, height = np.ptp(x, axis=0)
    fixed = np.zeros(x.shape, bool)
    fixed[left, 0] = True
    corner = np.flatnonzero(left & (x[:, 1] < x[:, 1].min() + 1e-6) & (x[:, 2] < x[:, 2].min() + 1e-6))
    other = np.flatnonzero(left & (x[:, 1] > x[:, 1].max() - 1e-6) & (x[:, 2] < x[:, 2].min() + 1e-6))
    fixed[corner] = True
    fixed[other, 2] = True
    force = np.zeros(x.shape)
    # On a face a cell gives a quarter of its area to each particle; the stress is 1e-3.
    force[right, 0] = 1e-3 * body.share[right] / body.share[right].sum() * width * height
    u = solve(body, fixed, force)
    planes = np.unique(x[:, 0].round(6))
    middle, near, far = (np.abs(x[:, 0] - planes[n]) < 1e-6 for n in (len(planes) // 2, len(planes) // 3, -1 - len(planes) // 3))
    along = (u[far, 0] @ body.share[far] / body.share[far].sum() - u[near, 0] @ body.share[near] / body.share[near].sum()) / (
        x[far, 0].mean() - x[near, 0].mean()
    )
    across = np.polyfit(x[middle, 1], u[middle, 1], 1)[0]
    return 1e-3 / along, -across / along


def cantilever(cells):
    """Deflection of the tip and first frequency of a bar, L/t = 10, over those of Timoshenko's beam."""
    length, side = 10.0 * cells, float(cells)
    body = model(Box((length, side, side)), 1.0, mass=length * side**2)
    x = body.position[:, 0]
    free = np.flatnonzero(np.repeat(x > x.min() + 0.5, 3))
    matrix = twin.stiffness_matrix(body.position, body.spring, body.stiffness)[free][:, free].tocsc()
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    tip = x > x.max() - 0.5
    force = np.zeros((len(x), 3))
    force[tip, 2] = body.share[tip] / body.share[tip].sum() * 1e-3
    u = np.zeros(3 * len(x))
    u[free] = factors.solve(force.ravel()[free])
    deflection = u.reshape(-1, 3)[tip, 2].mean() / twin.tip_deflection(1e-3, length, side, 1.0, NU)

    # K u = w^2 M u as a symmetric problem in sqrt(M) u; the inverse is that of the factors above.
    root = np.sqrt(np.repeat(body.mass, 3)[free])
    inverse = LinearOperator(matrix.shape, lambda v: root * factors.solve(root * np.ravel(v)))
    scaled = diags(1 / root) @ matrix @ diags(1 / root)
    start = np.random.default_rng(1).standard_normal(len(root))
    w2 = eigsh(scaled, k=2, sigma=0.0, OPinv=inverse, v0=start, return_eigenvectors=False).min()
    return deflection, np.sqrt(w2) / twin.first_frequency(length, side, 1.0, NU, 1.0)
