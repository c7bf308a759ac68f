# SPDX-License-Identifier: GPL-2.0-only
"""Spring constants of a cuboid lattice that is elastic and isotropic, with Poisson's ratio 1/4.

Wcislo 1999, eq. (3.6) gives the law of one spring; the constants are derived in docs/physics-solids.md.
"""

from __future__ import annotations

import numpy as np

from ..scene.scene import SpringConstant, Young
from .lattice import OFFSETS

MAX_ASPECT = 1.2
"""Longest over shortest cell edge; an edge spring would pull the wrong way beyond sqrt(3/2) = 1.22."""

FULL = np.where(np.count_nonzero(OFFSETS, axis=1) == 1, 4, 2)
"""Cells that hold a spring inside a body: 4 at an edge, 2 at a face diagonal, shape (9,)."""


def rest_lengths(cell: np.ndarray) -> np.ndarray:
    """Length of each row of OFFSETS [m], shape (9,), for cell edges [m], shape (3,)."""
    return np.linalg.norm(OFFSETS * cell, axis=1)


def spring_constants(cell: np.ndarray, young: float) -> np.ndarray:
    """Spring constant of each row of OFFSETS inside a body [N/m], shape (9,).

    For edges a, b, c, V = abc and Young's modulus E:
    face diagonal  k_ab = 0.2 E V (a^2 + b^2) / (a^2 b^2),
    edge           k_a  = 0.4 E V (3 - a^2/b^2 - a^2/c^2) / a^2;
    all are 0.4 E h for a cube. They make C11 = 1.2 E and C12 = C44 = 0.4 E along every axis.
    """
    a2 = np.asarray(cell, float) ** 2
    volume = float(np.prod(cell))
    edge = 0.4 * young * volume * (4.0 - a2 * (1.0 / a2).sum()) / a2
    along = OFFSETS != 0
    both = np.where(along, a2, 1.0).prod(axis=1)
    diagonal = 0.2 * young * volume * np.where(along, a2, 0.0).sum(axis=1) / both
    return np.where(FULL == 4, along @ edge, diagonal)


def stiffness(kind: np.ndarray, holders: np.ndarray, cell: np.ndarray, elasticity: Young | SpringConstant):
    """k of each spring [N/m], shape (S,).

    With ``Young`` a spring on the surface has the part of k that its filled cells own (``holders / FULL``),
    so a body is as stiff as its volume says however thin it is. ``SpringConstant`` is the paper's k for every
    spring.
    """
    if isinstance(elasticity, SpringConstant):
        return np.full(len(kind), elasticity.k)
    table = spring_constants(cell, elasticity.modulus)[:, None] * np.arange(5) / FULL[:, None]
    return table[kind, holders]


def equivalent_modulus(cell: np.ndarray, elasticity: Young | SpringConstant) -> float:
    """Young's modulus [Pa]; for one k it is that of an endless cubic lattice, k / (0.4 h)."""
    if isinstance(elasticity, SpringConstant):
        return elasticity.k / (0.4 * float(np.prod(cell)) ** (1.0 / 3.0))
    return elasticity.modulus


def dashpots(zeta: float, k: np.ndarray, mass: np.ndarray, spring: np.ndarray) -> np.ndarray:
    """Dashpot of each spring [N*s/m], shape (S,): c = 2 zeta sqrt(k m_ij), m_ij = m_i m_j / (m_i + m_j)."""
    mi, mj = mass[spring[:, 0]], mass[spring[:, 1]]
    return 2.0 * zeta * np.sqrt(k * (mi * mj / (mi + mj)))
