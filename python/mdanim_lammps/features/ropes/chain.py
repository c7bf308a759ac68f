# SPDX-License-Identifier: GPL-2.0-only
"""The chain of particles that a rope becomes, its springs, and how contact sees it (docs/physics-ropes.md)."""

from __future__ import annotations

import math
from functools import cached_property, lru_cache

import numpy as np

from ...model.bare import BareFrame
from ...model.lattice import Cells
from ...model.rods import Rod, springs_of
from ...model.rope import section
from ...scene.curve import Curve
from ...scene.scene import Rope

NEWTON = 30
"""Steps at most."""
EXACT = 1e-13
"""Distance of the last particle from its place, over the length, at which they end."""


def links_of(rope: Rope, h: float) -> int:
    """Number of links that are about h [m] long."""
    return max(2, round(rope.length / h))


def places(rope: Rope, links: int) -> np.ndarray:
    """Particles at the start [m], shape (links + 1, 3): with links of equal lengths, in balance where they hang."""
    curve = rope.curve
    if not isinstance(curve, Curve) or not curve.a:
        return np.array(curve.points(links))
    return np.array([rope.start]) + _hang(curve, links)


@lru_cache(maxsize=4096)
def _hang(curve: Curve, links: int) -> np.ndarray:
    """Particles of a hanging chain from its first one [m], shape (links + 1, 3).

    Of links of the length h the slopes grow evenly, tan theta_k = p + k c, where all particles between the ends have one weight;
    p and c follow from the span and the rise of its ends. Newton's method begins with those of the catenary.
    """
    start, end = np.array(curve.start), np.array(curve.end)
    span, rise, h = float(np.linalg.norm((end - start)[:2])), float((end - start)[2]), curve.length / links
    k = np.arange(links)
    found = np.array([(curve.first + 0.5 * h) / curve.a, h / curve.a])
    best, least = found, np.inf
    for _ in range(NEWTON):
        slope = found[0] + k * found[1]
        cosine = 1.0 / np.sqrt(1.0 + slope**2)
        off = np.array([h * cosine.sum() - span, h * (slope * cosine).sum() - rise])
        size = float(np.abs(off).max())
        if size < least:
            best, least = found, size
        if size <= EXACT * curve.length:
            break
        by = -slope * cosine**3, cosine**3
        matrix = h * np.array([[b.sum(), (k * b).sum()] for b in by])
        step = np.linalg.solve(matrix, off)
        found = found - step * min(1.0, 0.5 * (1.0 + np.abs(found[0])) / max(np.abs(step).max(), 1e-300))
    slope = best[0] + k * best[1]
    cosine = 1.0 / np.sqrt(1.0 + slope**2)
    along = (end - start)[:2] / span
    step = h * np.stack([cosine * along[0], cosine * along[1], slope * cosine], axis=1)
    x = np.concatenate([np.zeros((1, 3)), np.cumsum(step, axis=0)])
    x += np.linspace(0.0, 1.0, links + 1)[:, None] * ((end - start) - x[-1])  # what is left of both errors
    x.setflags(write=False)
    return x


def springs(rope: Rope, young: float, links: int) -> tuple[np.ndarray, np.ndarray]:
    """Pairs i < j of particles, int32, shape (S, 2), and k [N/m], r0 [m] and length without load [m] of each, shape (S, 3).

    A section crosses one link and two springs over two links, at its ends one, which together bear E A. Each of the latter pushes
    with P = 2 E I/h^2, so that a bend by an angle theta has the energy (E I/h) theta^2/2, and the links hold them.
    """
    line = Rod(np.arange(links + 1), np.full(links, rope.length / links), np.ones(links), np.ones(links - 1))
    inertia = math.pi * rope.thickness**4 / 64.0 if rope.bends else 0.0
    return springs_of([line], young * section(rope), young * inertia)


class LineFrame(BareFrame):
    """A chain of particles as contact sees it."""

    dimensions = 1

    @cached_property
    def points(self) -> tuple[np.ndarray, float]:
        """The surface of half of both links, and the half thickness."""
        rope, n = self.shape, int(self.cells.count[0])
        length = np.full(n, rope.length / (n - 1))
        length[[0, -1]] *= 0.5
        return rope.thickness * length, 0.5 * rope.thickness


def line_frame(rope: Rope, links: int) -> LineFrame:
    """The frame of a rope of so many links: cells of the volume of a link in one row."""
    h, edge = rope.length / links, math.sqrt(section(rope))
    low = -0.5 * np.array([(links + 1) * h, edge, edge])
    return LineFrame(rope, Cells(np.ones((1, 1, links + 1), bool), low, -low))
