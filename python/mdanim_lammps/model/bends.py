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
_FIRST, _NEXT = slice(None, -1), slice(1, None)
"""Particles around a ring in turn at the beginnings and at the ends of sides."""


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


class BendRings(Sequence[BendRing]):
    """The rings of an object, with arrays of all their lines."""

    def __init__(self, rings: Sequence[BendRing]):
        self._rings = list(rings)
        lines = [(n, line) for n, ring in enumerate(self._rings) for line in ring.lines]
        self.first = np.append(0, np.cumsum([len(ring.lines) for ring in self._rings], dtype=np.int64))
        """Where the lines of each ring begin, and their number, shape (R + 1,)."""
        self.stiffness = np.array([line.stiffness for _, line in lines])
        """`BendLine.stiffness` of all lines, shape (L,)."""
        self.of = np.array([n for n, _ in lines], np.int64)
        """The ring of each line, shape (L,)."""
        self.middle = np.array([ring.middle for ring in self._rings], np.int64)
        self._blunt = np.array([BLUNT * 2.0 * ring.area for ring in self._rings])
        most = max((len(line.particle) for _, line in lines), default=0)
        self._particle, self._weight = np.zeros((len(lines), most), np.int64), np.zeros((len(lines), most))
        for row, (n, line) in enumerate(lines):
            self._particle[row] = self.middle[n]
            self._particle[row, : len(line.particle)], self._weight[row, : len(line.weight)] = line.particle, line.weight
        sides = [(np.append(ring.around, ring.around[0]) if ring.closed else ring.around) for ring in self._rings]
        self._one, self._other = (
            np.concatenate([side[part] for side in sides] or [[]]).astype(np.int64) for part in (_FIRST, _NEXT)
        )
        self._side_of = np.repeat(np.arange(len(sides)), [len(side) - 1 for side in sides])

    def __getitem__(self, n):
        return self._rings[n]

    def __len__(self) -> int:
        return len(self._rings)

    def curvatures(self, x: np.ndarray) -> np.ndarray:
        """Curvature along each line [1/m], shape (L,), of particles at x [m], shape (N, 3)."""
        middle = x[self.middle]
        of = middle[self._side_of]
        sides = np.cross(x[self._one] - of, x[self._other] - of)
        normal = np.column_stack([np.bincount(self._side_of, one, len(middle)) for one in sides.T])
        size = np.sqrt((normal**2).sum(axis=1) + self._blunt**2)
        normal *= (np.sqrt(1.0 + BLUNT**2) / size)[:, None]
        bend = (self._weight[:, :, None] * (x[self._particle] - middle[self.of][:, None])).sum(axis=1)
        return (bend * normal[self.of]).sum(axis=1)
