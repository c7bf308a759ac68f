# SPDX-License-Identifier: GPL-2.0-only
"""The law of fix mdanim/folds without lists: every feature against every element, nearest places by their definition."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

ONSET, MOST = 0.2, 0.25


@dataclass
class Layer:
    """Numbers of particles among all, places without load, triangles or segments of them, and weights."""

    particle: np.ndarray
    rest: np.ndarray
    element: np.ndarray
    weight: np.ndarray

    def text(self, molecule: int) -> str:
        """Its lines in the table of the fix."""
        rows = zip(self.rest.tolist(), self.weight.tolist())
        lines = [f"object {molecule}", *(f"particle {n + 1} {x!r} {y!r} {z!r} {w!r}" for n, ((x, y, z), w) in enumerate(rows))]
        word = {2: "segment", 3: "triangle"}[self.element.shape[1]]
        return "".join(
            f"{line}\n" for line in [*lines, *(f"{word} {' '.join(str(k + 1) for k in e)}" for e in self.element.tolist())]
        )


@dataclass
class Pair:
    """The law of two layers, or of one with itself."""

    first: Layer
    second: Layer
    reach: float
    stiffness: float
    friction: float = 0.0
    damping: float = 0.0
    apart: float = 0.0

    def text(self, i: int, j: int) -> str:
        end = f" {self.apart!r}" if self.first is self.second else ""
        return f"pair {i} {j} {self.reach!r} {self.stiffness!r} {self.friction!r} {self.damping!r}{end}\n"

    def ways(self):
        """Features and elements, each with the law's two sides."""
        lines = self.first.element.shape[1] == self.second.element.shape[1] == 2
        sides = [(self.first, self.second)]
        if self.first is not self.second and not lines:
            sides.append((self.second, self.first))
        for own, other in sides:
            yield own, other, own.element if lines else np.arange(len(own.particle))[:, None]

    def forces(self, x, v, mass, dt):
        """Forces of the potential, of friction and of dashpots, each of shape (N, 3), and the energy."""
        push, rub, damp = (np.zeros_like(x) for _ in range(3))
        energy = 0.0
        for own, other, features in self.ways():
            for feature in features:
                best = None
                for element in other.element:
                    if own is other and nearest(own.rest[feature], other.rest[element])[0] < self.apart:
                        continue
                    found = nearest(x[own.particle[feature]], x[other.particle[element]])
                    if found[0] < self.reach and (best is None or found[0] < best[0]):
                        best = (*found, element)
                if best is None or best[0] == 0.0:
                    continue
                distance, at, foot, element = best
                p, q = own.particle[feature], other.particle[element]
                scale = own.weight[feature].mean()
                n = (at @ x[p] - foot @ x[q]) / distance
                u, force = scale * self.energy(distance), scale * self.push(distance)
                energy += u
                moving = 1.0 / ((at**2 / mass[p]).sum() + (foot**2 / mass[q]).sum())
                w = at @ v[p] - foot @ v[q]
                along = w @ n
                c = min(2.0 * self.damping * np.sqrt(self.stiffness * moving), MOST * moving / dt)
                dashpot = max(-force, -c * min(1.0, (self.reach - distance) / (ONSET * self.reach)) * along)
                across = w - along * n
                speed = np.linalg.norm(across)
                drag = -min(self.friction * (force + dashpot) / speed, MOST * moving / dt) * across if speed > 0.0 else 0.0 * n
                for on, f in ((push, force * n), (damp, dashpot * n), (rub, drag)):
                    np.add.at(on, p, at[:, None] * f)
                    np.add.at(on, q, -foot[:, None] * f)
        return push, rub, damp, energy

    def push(self, distance):
        d, e = self.reach - distance, ONSET * self.reach
        return self.stiffness * (d * d / (2.0 * e) if d < e else d - 0.5 * e)

    def energy(self, distance):
        d, e = self.reach - distance, ONSET * self.reach
        return self.stiffness * (d**3 / (6.0 * e) if d < e else 0.5 * (d - 0.5 * e) ** 2 + e * e / 24.0)


def nearest(a, b):
    """Distance of a point or segment, shape (1..2, 3), from a segment or triangle, shape (2..3, 3), and weights of the corners of
    both: the best of all places at which both, or parts of them, are perpendicular to the line between."""
    best = None
    for i in range(1, len(a) + 1):
        for own in combinations(range(len(a)), i):
            for j in range(1, len(b) + 1):
                for other in combinations(range(len(b)), j):
                    if (found := _perpendicular(a[list(own)], b[list(other)])) is None:
                        continue
                    at, foot = np.zeros(len(a)), np.zeros(len(b))
                    at[list(own)], foot[list(other)] = found
                    distance = np.linalg.norm(at @ a - foot @ b)
                    if best is None or distance < best[0]:
                        best = distance, at, foot
    return best


def _perpendicular(a, b):
    ways = np.concatenate([a[1:] - a[0], -(b[1:] - b[0])])
    if not len(ways):
        return np.ones(1), np.ones(1)
    if np.linalg.matrix_rank(ways, tol=1e-9) < len(ways):
        return None
    part = np.linalg.lstsq(ways.T, b[0] - a[0], rcond=None)[0]
    s, t = part[: len(a) - 1], part[len(a) - 1 :]
    at, foot = np.concatenate([[1.0 - s.sum()], s]), np.concatenate([[1.0 - t.sum()], t])
    return (at, foot) if min(at.min(), foot.min()) >= -1e-12 else None
