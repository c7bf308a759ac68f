# SPDX-License-Identifier: GPL-2.0-only
"""Naive twins of the modelling: lattices cell by cell from the definitions, linear elasticity of any spring
network, and the beam of the textbook."""

from itertools import combinations, product
from math import cos, cosh

import numpy as np

CORNER = 16.0 * (2.0 / 15.0 * (1.0 - 54.0 / 256.0) ** 2 + 4.0 / 15.0 * (1.0 - 18.0 / 256.0) + 0.1)
"""Square of the frequency 2 / dt that the corner of a cube of four cells and more allows, over E/rho h^2.

An eighth of a cell hangs on edges of a quarter of 0.4 + 4/30, diagonals of half of 2 (0.2 - 2/30) and a brace of 0.1, which the
surface weakens but for the brace. Along the body diagonal that is edge + 2 diagonals + brace; twice that over the mass.
"""


def lattice(filled):
    """Everything by definition, in plain loops, for filled cells (z, y, x).

    Returns nodes {(z, y, x): filled cells around it} and springs {(node, node): filled cells that hold both}. A cell with
    a corner of its own has its body diagonals too. Where one side of a cell is free and the other is not, a diagonal of its
    free face counts 18/256 less and one of the other face more (27/256 or 20/256 if only two or three cells are in line), an edge
    three times that.
    """
    nodes, springs = {}, {}

    def is_filled(cell):
        return all(0 <= c < n for c, n in zip(cell, filled.shape)) and filled[cell]

    def part(cell, a, b):
        alike, count = [axis for axis in range(3) if a[axis] == b[axis]], 1.0
        for axis in alike:
            up = (axis == 0) * 1, (axis == 1) * 1, (axis == 2) * 1
            above, below = (tuple(c + s * u for c, u in zip(cell, up)) for s in (1, -1))
            if is_filled(above) == is_filled(below):
                continue
            side = -1 if is_filled(below) else 1
            line = [tuple(c + n * side * u for c, u in zip(cell, up)) for n in (2, 3)]
            third, fourth = (is_filled(c) for c in line)
            moved = (27.0 if not third else 18.0 if fourth else 20.0) / 256.0 * (3.0 if len(alike) == 2 else 1.0)
            count *= 1.0 - moved if (a[axis] > cell[axis]) == (side < 0) else 1.0 + moved
        return count

    for cell in zip(*np.nonzero(filled)):
        corners = [tuple(int(c) + d for c, d in zip(cell, step)) for step in product((0, 1), repeat=3)]
        for corner in corners:
            nodes[corner] = nodes.get(corner, 0) + 1
        for a, b in combinations(corners, 2):
            if sum(p != q for p, q in zip(a, b)) <= 2:
                springs[min(a, b), max(a, b)] = springs.get((min(a, b), max(a, b)), 0) + part(cell, a, b)
    for cell in zip(*np.nonzero(filled)):
        corners = [tuple(int(c) + d for c, d in zip(cell, step)) for step in product((0, 1), repeat=3)]
        if any(nodes[corner] == 1 for corner in corners):
            for a, b in combinations(corners, 2):
                if all(p != q for p, q in zip(a, b)):
                    springs[min(a, b), max(a, b)] = 1
    return nodes, springs


def layers(nodes, springs):
    """Wcislo 1999, sec. 3.3.2: {node: 'boundary' | 'thin' | 'sub' | 'inner'}."""
    boundary = {n for n, cells in nodes.items() if cells < 8}
    touching = {a for a, b in springs if b in boundary} | {b for a, b in springs if a in boundary}
    result = {}
    for n in nodes:
        around = [tuple(c + d for c, d in zip(n, step)) for step in product((-1, 0, 1), repeat=3)]
        guarded = any(m in nodes and m not in boundary for m in around)
        if n in boundary:
            result[n] = "boundary" if guarded else "thin"
        else:
            result[n] = "sub" if n in touching else "inner"
    return result


def stiffness_matrix(position, spring, k):
    """K of the linearised network, (3 N, 3 N) sparse: k n n^T for every spring, n its direction at rest."""
    from scipy.sparse import coo_matrix

    rows, columns, values = [], [], []
    d = position[spring[:, 1]] - position[spring[:, 0]]
    n = d / np.sqrt((d**2).sum(axis=1))[:, None]
    for a, b in product(range(3), repeat=2):
        block = k * n[:, a] * n[:, b]
        for p, q, sign in ((0, 0, 1), (1, 1, 1), (0, 1, -1), (1, 0, -1)):
            rows.append(3 * spring[:, p].astype(int) + a)
            columns.append(3 * spring[:, q].astype(int) + b)
            values.append(sign * block)
    size = 3 * len(position)
    where = np.concatenate(rows), np.concatenate(columns)
    return coo_matrix((np.concatenate(values), where), (size, size)).tocsc()


# --- Timoshenko's cantilever, square cross section ----------------------------------------------------------


def shear_coefficient(nu):
    """Cowper 1966, rectangle."""
    return 10 * (1 + nu) / (12 + 11 * nu)


def tip_deflection(force, length, side, young, nu):
    """Under a force at the tip: F L^3 / 3 E I + F L / kappa G A."""
    inertia, area, shear = side**4 / 12, side**2, young / (2 * (1 + nu))
    return force * length**3 / (3 * young * inertia) + force * length / (shear_coefficient(nu) * shear * area)


def first_frequency(length, side, young, nu, density):
    """First angular frequency, from the beam's four equations; clamped at 0, free at the length."""
    from scipy.linalg import expm
    from scipy.optimize import brentq

    inertia, area, shear = side**4 / 12, side**2, young / (2 * (1 + nu))
    bending, shearing = young * inertia, shear_coefficient(nu) * shear * area

    def free_end(omega):
        # State (w, phi, M, Q): w' = phi + Q/kGA, phi' = M/EI,
        # M' = -Q - rho I omega^2 phi, Q' = -rho A omega^2 w.
        a = np.array(
            [
                [0, 1, 0, 1 / shearing],
                [0, 0, 1 / bending, 0],
                [0, -density * inertia * omega**2, 0, -1],
                [-density * area * omega**2, 0, 0, 0],
            ]
        )
        # M and Q at the free end must vanish for some M and Q at the clamp.
        return np.linalg.det(expm(a * length)[2:, 2:])

    # The slender beam of Euler and Bernoulli is a few per cent higher.
    beta = brentq(lambda b: 1 + cosh(b) * cos(b), 1.5, 2.0)
    slender = beta**2 * np.sqrt(bending / (density * area * length**4))
    return brentq(free_end, 0.8 * slender, 1.05 * slender, xtol=1e-12 * slender)
