# SPDX-License-Identifier: GPL-2.0-only
"""Spring constants of a cuboid lattice that is elastic and isotropic, with Poisson's ratio 1/4.

Wcislo 1999, eq. (3.6) gives the law of one spring; the constants are derived in docs/physics-solids.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..scene.scene import Elasticity, SpringConstant, Young
from .lattice import AXES, OFFSETS, Lattice

if TYPE_CHECKING:
    from .system import System

MAX_ASPECT = 1.2
"""Longest over shortest cell edge; an edge spring would have a negative constant beyond sqrt(3/2) = 1.22."""

BRACE = 0.1
"""Constant of the body diagonals of a braced cell over E h: the least value with which a corner has no second equilibrium."""

FULL = np.array([0, 4, 2, 1])[AXES]
"""Cells around a spring inside a body: 4 at an edge, 2 at a face diagonal, 1 at a body diagonal, shape (13,)."""


def rest_lengths(cell: np.ndarray) -> np.ndarray:
    """Length of each row of OFFSETS [m], shape (13,), for cell edges [m], shape (3,)."""
    return np.linalg.norm(OFFSETS * cell, axis=1)


def spring_constants(cell: np.ndarray, young: float, brace: float = 0.0) -> np.ndarray:
    """Spring constant of each row of OFFSETS inside a body of such cells [N/m], shape (13,).

    For edges a, b, c, V = abc, L^2 = a^2 + b^2 + c^2, Young's modulus E and k_3 = brace * E V^(1/3):
    body diagonal  k_3,
    face diagonal  k_ab = (a^2 + b^2) (0.2 E V / (a^2 b^2) - 2 k_3 / L^2),
    edge           k_a  = 0.4 E V (3 - a^2/b^2 - a^2/c^2) / a^2 + 4 k_3 a^2 / L^2;
    without brace all are 0.4 E h for a cube. They make C11 = 1.2 E and C12 = C44 = 0.4 E along every axis,
    whatever the brace.
    """
    a2 = np.asarray(cell, float) ** 2
    volume = float(np.prod(cell))
    body = brace * young * volume ** (1.0 / 3.0)
    edge = 0.4 * young * volume * (4.0 - a2 * (1.0 / a2).sum()) / a2 + 4.0 * body * a2 / a2.sum()
    along = OFFSETS != 0
    both = np.where(along, a2, 1.0).prod(axis=1)
    face = np.where(along, a2, 0.0).sum(axis=1) * (0.2 * young * volume / both - 2.0 * body / a2.sum())
    return np.select([AXES == 1, AXES == 2], [along @ edge, face], body)


def stiffness(lattice: Lattice, elasticity: Young | SpringConstant) -> np.ndarray:
    """k of each spring [N/m], shape (S,).

    With ``Young`` a spring has the part of k that each of its filled cells gives, about a quarter of an edge, half a face
    diagonal, so a body is as stiff as its volume says however thin it is; cells on a surface give a little less outside and
    more inside, for bending. ``SpringConstant`` is the paper's k for every spring; braces are not the paper's and get 0.
    """
    if isinstance(elasticity, SpringConstant):
        return np.where(AXES[lattice.kind] == 3, 0.0, elasticity.k)
    cell = lattice.cells.edge
    plain, braced = (spring_constants(cell, elasticity.modulus, f) / FULL for f in (0.0, BRACE))
    return plain[lattice.kind] * (lattice.holders - lattice.braced) + braced[lattice.kind] * lattice.braced


def equivalent_modulus(cell: np.ndarray, elasticity: Elasticity) -> float:
    """Young's modulus [Pa]; for one k it is that of an endless cubic lattice, k / (0.4 h)."""
    if isinstance(elasticity, SpringConstant):
        return elasticity.k / (0.4 * float(np.prod(cell)) ** (1.0 / 3.0))
    return elasticity.modulus


ROWS = 1 << 16
"""Rows that are sorted together."""


def types(constants: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Type of each spring (from 1, the smallest unsigned integers that do, shape (S,)) and the
    constants of each type, shape (T, K).

    Springs with the constants (S, K) are of one type when all bits of them agree; types are numbered by first appearance, so that
    they do not depend on a sort of floating-point numbers.
    """
    first, inverse = distinct_rows(constants)
    return (inverse + 1).astype(np.min_scalar_type(len(first))), constants[first]


def distinct_rows(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Number of the first row of each kind, ascending, shape (T,), and the kind of each row, int32, shape (S,), for float64 rows
    of shape (S, K). Rows are of one kind when all bits of them agree."""
    # Block by block, then among the first ones of all blocks: sorts of all rows would take several times their memory.
    starts = range(0, len(rows), ROWS)
    found = [_distinct(rows[start : start + ROWS]) for start in starts]
    if len(found) < 2:
        return found[0] if found else (np.zeros(0, np.intp), np.zeros(0, np.int32))
    firsts = np.concatenate([first + start for start, (first, _) in zip(starts, found)])
    among, which = _distinct(rows[firsts])
    kind, at = np.empty(len(rows), np.int32), 0
    for start, (first, inverse) in zip(starts, found):
        kind[start : start + len(inverse)] = which[at + inverse]
        at += len(first)
    return firsts[among], kind


def _distinct(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`distinct_rows` of rows that are few."""
    # A mixed key per row is enough to find equal rows quickly; equality itself is checked on all bits below.
    bits, key = rows.view(np.uint64), np.zeros(len(rows), np.uint64)
    with np.errstate(over="ignore"):
        for column in bits.T:
            key = (key ^ (key >> np.uint64(29))) * np.uint64(0x9E3779B97F4A7C15) + column * np.uint64(0xC2B2AE3D27D4EB4F)
    found = np.unique(key, return_index=True, return_inverse=True)
    if not np.array_equal(bits[found[1][found[2].reshape(-1)]], bits):  # two different rows with one key
        found = np.unique(bits, axis=0, return_index=True, return_inverse=True)
    first, inverse = found[1], found[2].reshape(-1)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    return first[order], rank[inverse]


def dashpots(system: System, ratio: np.ndarray) -> np.ndarray:
    """Dashpot of each spring [N*s/m], shape (S,): c = 2 zeta sqrt(k m_ij); zeta of each solid, shape (M,)."""
    k, _, reduced = system.constants[:, :3].T
    return (2.0 * ratio)[system.object[system.spring[:, 0]]] * np.sqrt(k * reduced)[system.spring_type - 1]


def reduced_mass(mass: np.ndarray, spring: np.ndarray) -> np.ndarray:
    """m_i m_j / (m_i + m_j) of the ends of each spring [kg], shape (S,), for masses [kg], shape (N,)."""
    mi, mj = mass[spring[:, 0]], mass[spring[:, 1]]
    return mi * mj / (mi + mj)
