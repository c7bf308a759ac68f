# SPDX-License-Identifier: GPL-2.0-only
"""Layers of particles as what they bend by: rings, a particle with those around it, and lines across them
(docs/physics-sheets.md)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field

import numpy as np

from ..records import dataclass

BLUNT = 0.3
"""As in `plugin/tearing/bend_law.h`."""


@dataclass(frozen=True, eq=False)
class BendLine:
    """Particles across a ring, and a sum of their heights that is the curvature along the line."""

    particle: tuple[int, ...]
    """Three or four of the ring."""
    weight: tuple[float, ...]
    """The part of the height of each in the curvature [1/m^2]; their sum is 0."""
    stiffness: float
    """c of the energy c k^2/2 of a curvature k, over E t^3 and the factor of its bending [m^2]."""
    direction: np.ndarray
    """From its first particle on in the body without load, shape (3,)."""
    sharpest: float
    """Its curvature where it is folded [1/m]: sum |w| l with the distances l of particles from the middle."""


@dataclass(frozen=True, eq=False)
class BendRing:
    """A particle with those around it."""

    middle: int
    around: np.ndarray
    """In turn, counter-clockwise seen along the normal, int64, shape (n,)."""
    closed: bool
    """Whether the first one is beside the last one, too."""
    area: float
    """The area of its triangles, laid flat [m^2]."""
    lines: list[BendLine] = field(default_factory=list)


def runs_around(triangle: np.ndarray, count: int, cut: Sequence[set[int]] | None = None) -> Iterator[tuple[int, list[int], bool]]:
    """Each of ``count`` particles with those around it in turn, and whether these close; in several runs where some triangles of
    it, shape (T, 3), have no edge in common but with particles of ``cut``."""
    following: list[dict[int, int]] = [{} for _ in range(count)]
    for a, b, c in triangle.tolist():
        following[a][b], following[b][c], following[c][a] = c, a, b
    for v, after in enumerate(following):
        ends = cut[v] if cut else set(after) - set(after.values())
        starts, left = sorted(b for b in after if b in ends), dict(after)
        while left:
            run = [next((s for s in starts if s in left), min(left))]
            while run[-1] in left and (len(run) == 1 or run[-1] not in ends):
                run.append(left.pop(run[-1]))
            closed = run[0] == run[-1] and run[0] not in ends
            yield v, run, closed


def curvatures(ring: BendRing, x: np.ndarray) -> np.ndarray:
    """Curvature along each line of a ring [1/m], of particles at x [m], shape (N, 3)."""
    arm = x[ring.around] - x[ring.middle]
    beside = np.roll(arm, -1, axis=0)
    normal = np.cross(arm, beside)[: None if ring.closed else -1].sum(axis=0)
    size = np.sqrt(normal @ normal + (BLUNT * 2.0 * ring.area) ** 2)
    normal *= np.sqrt(1.0 + BLUNT**2) / size
    return np.array([np.array(line.weight) @ (x[list(line.particle)] - x[ring.middle]) @ normal for line in ring.lines])
