# SPDX-License-Identifier: GPL-2.0-only
"""Forces of air on a surface, element by element."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

MOST = 0.25
"""Part of the motion relative to the air that it takes in a step at most."""


@dataclass
class Skin:
    """The surface of one object; particles and points count from 0."""

    points: Sequence[Sequence[tuple[int, float]]]
    triangles: Sequence[tuple[int, int, int]] = ()
    cylinders: Sequence[tuple[int, int, float]] = ()
    """Points, diameter and, where it may tear, the largest length."""
    balls: Sequence[tuple[int, float]] = ()
    frame: tuple[int, int, int, int] | None = None
    panels: Sequence[tuple[int, Sequence[float]]] = field(default_factory=list)
    both: bool = False

    def text(self, molecule: int) -> str:
        """As the fix reads it."""
        lines = [f"object {molecule} {'both' if self.both else 'outer'}"]
        lines += ["point " + " ".join(f"{i + 1} {w!r}" for i, w in point) for point in self.points]
        lines += ["triangle " + " ".join(str(p + 1) for p in t) for t in self.triangles]
        lines += [" ".join(["cylinder", str(a + 1), str(b + 1), *map(repr, more)]) for a, b, *more in self.cylinders]
        lines += [f"ball {p + 1} {d!r}" for p, d in self.balls]
        lines += ["frame " + " ".join(str(p + 1) for p in self.frame)] if self.frame else []
        lines += [f"panel {p + 1} " + " ".join(map(repr, map(float, part))) for p, part in self.panels]
        return "\n".join(lines) + "\n"

    def forces(self, x, v, mass, density, coefficient, wind, dt, above=-np.inf) -> np.ndarray:
        """On its particles, shape (N, 3): p = rho C/2 |u| u on each element, shared by its points and by their weights."""
        weight = np.zeros((len(self.points), len(x)))
        for p, point in enumerate(self.points):
            for i, w in point:
                weight[p, i] += w
        place, velocity = weight @ x, weight @ v
        elements = [*self._elements(place)]
        carried = np.zeros(len(place))
        for points, area, _ in elements:
            carried[points] += area / len(points)
        load = np.abs(weight).T @ carried / mass
        most = np.array([load[np.abs(row) > 0].max() if row.any() else 0.0 for row in weight])
        half, force = 0.5 * density * coefficient, np.zeros_like(place)
        for points, _, push in elements:
            if place[points][:, 2].mean() < above:
                continue
            u, of_speed = push(np.asarray(wind) - velocity[points].mean(axis=0))
            part = half * of_speed * dt * most[points].max()
            force[points] += half * of_speed * (MOST / part if part > MOST else 1.0) * u / len(points)
        return weight.T @ force

    def _elements(self, place):
        """Points of each element, its area, and its law: from the velocity of the air to A u n and |u|."""

        def surface(area):
            def law(past):
                size = np.linalg.norm(area)
                u = past @ area / size
                return (u * area if self.both or u < 0.0 else 0.0 * area), abs(u)

            return law

        def cylinder(way, diameter):
            def law(past):
                t = way / np.linalg.norm(way)
                u = past - t * (t @ past)
                return diameter * np.linalg.norm(way) * u, np.linalg.norm(u)

            return law

        for t in self.triangles:
            a, b, c = place[list(t)]
            area = 0.5 * np.cross(b - a, c - a)
            yield list(t), np.linalg.norm(area), surface(area)
        for a, b, d, *most in self.cylinders:
            way = place[b] - place[a]
            if most and np.linalg.norm(way) > most[0]:
                continue
            yield [a, b], d * np.linalg.norm(way), cylinder(way, d)
        for p, d in self.balls:
            face = 0.25 * np.pi * d**2
            yield [p], face, lambda past, face=face: (0.5 * face * past, np.linalg.norm(past))
        if self.frame:
            e = place[list(self.frame[1:])] - place[self.frame[0]]
            basis = np.stack([np.cross(e[1], e[2]), np.cross(e[2], e[0]), np.cross(e[0], e[1])])
            for p, part in self.panels:
                area = np.asarray(part) @ basis
                yield [p], np.linalg.norm(area), surface(area)
