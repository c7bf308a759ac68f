# SPDX-License-Identifier: GPL-2.0-only
"""Masses of particles with which a lattice turns as its shape does (docs/physics-solids.md, Masses).

The particles on faces stand for matter that lies further inside, so with masses in proportion to the filled cells around a
particle the moments of inertia are too large: 1 + 2/n^2 times for a cube of n cells. Here masses m_i = w_i share_i M / sum share
are fitted to the ten moments of the shape: mass, centre and second moments.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..records import dataclass
from ..scene.scene import Young
from .lattice import OFFSETS, Lattice
from .model import Layer
from .springs import distinct_rows, rest_lengths, stiffness
from .tensors import largest_eigenvalue, solve

HEAVIEST = 3.0
"""Largest w."""
STEPS = 1.0 - 0.02 * np.arange(11)
"""Parts of the stable time step that are tried, from the whole on, until the moments can be reached."""
CLOSE = 1e-3
"""Error of moments of inertia at which a fit is good; and gain for which no part of the time step is given up."""
YIELD = 1e-4
"""Weight of an error of second moments, over the trace, against the change of masses: an error that cannot be removed remains."""
ITERATIONS = 50
"""Largest number of steps of Newton's method; 3 to 25 are usual."""
SPARE = 1e-3
"""Added to limits, as eigenvalues are not exact: what has set the time step goes on to set it."""
HALVINGS = 40
"""Largest number of halvings of a step of Newton's method."""
ENOUGH = 1e-14
"""Sum of the remaining errors at which it ends."""
CAUTION = 1e-3
"""Part of the remaining errors that is added to slopes: far from the limits' right places a step would be endless."""
SIX = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
"""Places of the components of a symmetric matrix."""
BLOCK = 16384
"""Particles whose sums are taken together: ten rows of them, twice, lie in a cache."""
FAR = 0.5
"""Part of what was left with which a step counts as good where the function no longer shows it."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Factors of masses, and what is left."""

    weight: np.ndarray
    """w of each particle [-], shape (N,)."""
    error: float
    """Largest error of a moment of inertia about an axis through the centre, over its true value [-]."""


def fit_masses(lattice: Lattice, moments: np.ndarray) -> Fit:
    """Fit masses to a shape whose second moments over its mass, about its centre, are ``moments`` [m^2], shape (3, 3).

    The change sum share_i (w_i - 1)^2 is the least that fits with lower_i <= w_i <= HEAVIEST. The lower limits keep as much of
    the stable time step as the moments allow, see `lower_limits`.
    """
    problem, least = _Problem(lattice, moments), lower_limits(lattice)
    even = problem.even()
    tried = {}

    def at(n: int) -> Fit:
        if n not in tried:
            fitted = problem.fit(np.minimum(1.0, STEPS[n] ** 2 * least))
            tried[n] = fitted if fitted.error <= even.error else even
        return tried[n]

    if at(0).error <= CLOSE:
        return at(0)
    below, above = 0, len(STEPS) - 1
    enough = at(above).error + CLOSE
    if at(0).error <= enough:
        return at(0)
    while above - below > 1:
        middle = (below + above) // 2
        below, above = (below, middle) if at(middle).error <= enough else (middle, above)
    return at(above)


def lower_limits(lattice: Lattice) -> np.ndarray:
    """w of each particle down to which it bears the time step of the whole body with masses by shares [-], shape (N,).

    A particle's rate is its stiffness over its mass, 2 lambda_max(D_i)/m_i: of springs alone, and of springs with usual contact.
    Corners and edges of the lattice set the step; faces and the inside have room. The limit is w_i >= rate_i / max rate, of both.
    """
    edge = lattice.cells.edge
    near = lattice.layer != Layer.INNER
    springs = np.zeros(len(near))
    springs[near] = _spring_rates(lattice, near)
    springs[~near] = springs[near].min()
    # kappa = E/h on the area that a particle carries and on what it may bear; an estimate, as contact depends on the scene.
    carried = exposed(lattice.cells.filled)[_number(lattice)] / 4.0
    contact = (3.0 * carried + 2.0 * np.minimum(1.0, 2.0 * lattice.share)) * np.cbrt(edge.prod())
    rates = [stiff / lattice.share for stiff in (springs, springs + contact)]
    return (1.0 + SPARE) * np.maximum.reduce([rate / rate.max() for rate in rates])


def _number(lattice: Lattice) -> tuple[np.ndarray, ...]:
    """Places (z, y, x) of the particles among the corners of the grid, each of shape (N,)."""
    return tuple(np.rint((lattice.position - lattice.cells.low) / lattice.cells.edge).astype(np.int64).T[::-1])


def exposed(filled: np.ndarray) -> np.ndarray:
    """Outer faces of filled cells that meet at each corner of the grid, uint8, shape (nz + 1, ny + 1, nx + 1)."""
    padded = np.pad(filled, 1)
    total = np.zeros(np.array(filled.shape) + 1, np.uint8)
    for axis in range(3):
        faces = np.diff(padded, axis=axis).astype(np.uint8)
        for other in {0, 1, 2} - {axis}:
            rows = np.moveaxis(faces, other, 0)
            faces = np.moveaxis(rows[:-1] + rows[1:], 0, other)
        total += faces
    return total


def _spring_rates(lattice: Lattice, near: np.ndarray) -> np.ndarray:
    """2 lambda_max(D_i) of these particles, bool, shape (N,), for E = 1 [m]; shape (count,)."""
    edge = lattice.cells.edge
    direction = OFFSETS * edge / rest_lengths(edge)[:, None]
    touched = near[lattice.spring].any(axis=1)
    pair, kind, k = lattice.spring[touched], lattice.kind[touched], stiffness(lattice, Young(1.0))[touched]
    block = np.empty((np.count_nonzero(near), 6))
    for column, (a, b) in enumerate(SIX):
        term = k * (direction[:, a] * direction[:, b])[kind]
        block[:, column] = sum(np.bincount(end, term, len(near)) for end in pair.T)[near]
    first, which = distinct_rows(block)  # few: most particles have as many springs as others
    return 2.0 * largest_eigenvalue(_matrix(block[first].T).transpose(2, 0, 1), squarings=10)[which]


@dataclass(frozen=True, slots=True, eq=False)
class _Trial:
    """A lambda, its w and r, the value of the convex function, and sum |r|."""

    factor: np.ndarray
    weight: np.ndarray
    left: np.ndarray
    height: float
    far: float


class _Problem:
    """Least change of masses with given moments: w = clip(1 + sum lambda_k f_k, lower, HEAVIEST), f_k polynomials of the place.

    f are 1, x, y, z and the six products of two of them less their means. What is asked of their moments less what there is, r_k,
    vanishes for the right lambda; of the products it may stay at YIELD lambda. So -r is the gradient of a convex function,
    quadratic where no limit is passed, and Newton's method finds its minimum.
    """

    def __init__(self, lattice: Lattice, moments: np.ndarray):
        self.share = lattice.share / lattice.share.sum()
        scale = np.sqrt(np.diag(moments))  # each axis its own, so that a slender body is fitted across too
        self.moments, self.scale = moments / np.outer(scale, scale), scale
        x, y, z = np.ascontiguousarray(lattice.position.T) / scale[:, None]
        products = np.stack([x * x, y * y, z * z, y * z, x * z, x * y])
        self.means = (self.share * products).sum(axis=1)
        self.basis = np.concatenate([np.ones((1, len(x))), [x, y, z], products - self.means[:, None]])
        self.asked = np.concatenate([[1.0, 0.0, 0.0, 0.0], _six(self.moments) - self.means])
        self.give = np.array([0.0] * 4 + [YIELD] * 6)
        self.whole = self._products()
        # Across a single cell the squares of the places are all one: nothing to fit.
        self.asked[np.diag(self.whole) < 1e-20] = 0.0

    def fit(self, lower: np.ndarray) -> Fit:
        factor = np.zeros(len(self.basis))
        now = self._at(factor, lower)
        for _ in range(ITERATIONS):
            if now.far < ENOUGH:
                break
            step = solve(self._slope(now.weight, lower) + np.eye(len(factor)) * CAUTION * now.far, now.left)
            trials = (self._at(factor + shorter * step, lower) for shorter in 0.5 ** np.arange(0, HALVINGS))
            better = next((t for t in trials if t.height < now.height or t.far < FAR * now.far), None)
            if better is None:
                break
            now, factor = better, better.factor
        if np.abs(now.left[:4]).max() > 1e-12:  # not seen: masses by shares have the right mass and centre
            now = self._at(np.zeros(len(self.basis)), lower)
        return Fit(now.weight, self._error(now.weight))

    def even(self) -> Fit:
        """Masses by shares."""
        ones = np.ones_like(self.share)
        return Fit(ones, self._error(ones))

    def _at(self, factor: np.ndarray, lower: np.ndarray) -> _Trial:
        weight = np.empty_like(lower)

        def part(rows: slice) -> np.ndarray:
            """Sums over some particles: the moments, shape (10,), and the integral of the clipped line from 0 to the change."""
            change, basis, share, w = np.zeros(rows.stop - rows.start), self.basis[:, rows], self.share[rows], weight[rows]
            for f, row in zip(factor, basis):
                change += f * row
            np.clip(1.0 + change, lower[rows], HEAVIEST, out=w)
            area = (share * (w * (change + 1.0 - 0.5 * w) - 0.5)).sum()
            return np.append((share * w * basis).sum(axis=1), area)

        *sums, area = pairwise(part, 0, len(lower))
        left = self.asked - sums - self.give * factor
        height = area - (self.asked * factor).sum() + 0.5 * (self.give * factor**2).sum()
        return _Trial(factor, weight, left, float(height), float(np.abs(left).sum()))

    def _sums(self, mass: np.ndarray) -> np.ndarray:
        return pairwise(lambda rows: (mass[rows] * self.basis[:, rows]).sum(axis=1), 0, len(mass))

    def _slope(self, weight: np.ndarray, lower: np.ndarray) -> np.ndarray:
        """-dr/dlambda, shape (10, 10): of all particles less those at a limit, or of the free ones where they are fewer."""
        stopped = (weight <= lower) | (weight >= HEAVIEST)
        at_limit = np.flatnonzero(stopped)
        if len(at_limit) > max(BLOCK, len(weight) // 2):
            free = self._products(np.flatnonzero(~stopped))
        else:
            free = self.whole - self._products(at_limit)
        return free + np.diag(self.give + 1e-12)

    def _products(self, some: np.ndarray | None = None) -> np.ndarray:
        """Sums of share f_k f_l over all particles or some, shape (10, 10)."""

        def part(rows: slice) -> np.ndarray:
            chosen = rows if some is None else some[rows]
            # Rows side by side in memory are summed five times as fast. A body of one stretch keeps the order that it always had.
            basis = self.basis[:, chosen] if one else np.take(self.basis, chosen, axis=1)
            found = np.empty((len(basis), len(basis)))
            for k, row in enumerate(self.share[chosen] * basis):
                found[k, k:] = found[k:, k] = (row * basis[k:]).sum(axis=1)
            return found

        count = len(self.share) if some is None else len(some)
        one = some is None or count <= BLOCK
        return pairwise(part, 0, count)

    def _error(self, weight: np.ndarray) -> float:
        """Largest eigenvalue of I^(-1/2) (J - I) I^(-1/2) for the moments of inertia I of the shape and J of the particles."""
        found = self._sums(self.share * weight)[4:] + self.means
        scale = np.outer(self.scale, self.scale)
        true, off = inertia(scale * self.moments), inertia(scale * (_matrix(found) - self.moments))
        return float(np.abs(np.linalg.eigvals(np.linalg.solve(true, off))).max())


def pairwise(part: Callable[[slice], np.ndarray], first: int, last: int) -> np.ndarray:
    """Sum of ``part`` over stretches of at most BLOCK rows, which stay in cache. Stretches are halved and added as numpy's sum
    of a whole row does it: the bits are the same."""
    if last - first <= BLOCK:
        return part(slice(first, last))
    half = (last - first) // 2
    middle = first + half - half % 8
    return pairwise(part, first, middle) + pairwise(part, middle, last)


def inertia(moments: np.ndarray) -> np.ndarray:
    """Tensor of inertia over the mass from second moments [m^2], both of shape (3, 3): tr(S) 1 - S."""
    return np.trace(moments) * np.eye(3) - moments


def _six(matrix: np.ndarray) -> np.ndarray:
    """xx, yy, zz, yz, xz, xy of a symmetric matrix."""
    return matrix[tuple(np.transpose(SIX))]


def _matrix(six: np.ndarray) -> np.ndarray:
    """The symmetric matrix, shape (3, 3, ...), of the six components, shape (6, ...)."""
    return six[[[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
