# SPDX-License-Identifier: GPL-2.0-only
"""The triangular lattice of a flat sheet and its springs (docs/physics-sheets.md): rods along three directions, of which each has
the stiffness of a strip of the sheet.
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from ...model.bends import BendLine, BendRing, runs_around
from ...model.rods import Rod, bends_of, springs_of
from ...model.triangles import areas
from ...records import dataclass
from ...scene.scene import Sheet

EVEN = 50.0
"""Weight of an error of the lattice's angle beside one of its spacing: stiffness is the same in every direction at 60 degrees."""
FINER, COARSER = 0.84, 1.19
"""Spacings that are tried, over the one that is asked for."""
LEAST_ROWS = 2
"""Rows of triangles across, at least; there are an even number of them, so that all corners have a particle."""
SIDE = 0.375
"""Section of the last, half link of every second row, over that of the row: at a free side it bears nothing where the sheet is
pulled, and with this section it sets no time step. The sheet is held there with all of the row's."""


@dataclass(frozen=True)
class Weave:
    """Rows of particles along x, of which every second one begins and ends with half a link."""

    lx: float
    """[m]"""
    ly: float
    """[m]"""
    along: int
    """Links of a row."""
    rows: int
    """Rows of triangles, even; there is one more of particles."""

    @property
    def h(self) -> float:
        """Link of a row [m]."""
        return self.lx / self.along

    @property
    def apart(self) -> float:
        """Distance of rows [m]."""
        return self.ly / self.rows

    @cached_property
    def _row(self) -> list[np.ndarray]:
        """Particles of each row, int64."""
        size = [self.along + 1 + j % 2 for j in range(self.rows + 1)]
        first = np.cumsum([0, *size])
        return [np.arange(a, b) for a, b in pairwise(first)]

    @cached_property
    def place(self) -> np.ndarray:
        """Particles in the plane of the sheet, about its middle [m], shape (N, 2); row by row, x fastest."""
        even = np.arange(self.along + 1) * self.h
        odd = np.concatenate([[0.0], even[:-1] + 0.5 * self.h, [self.lx]])
        rows = [np.stack([x, np.full(len(x), j * self.apart)], axis=1) for j, x in enumerate((even, odd) * (self.rows // 2))]
        rows.append(np.stack([even, np.full(len(even), self.ly)], axis=1))
        return np.concatenate(rows) - 0.5 * np.array([self.lx, self.ly])

    @cached_property
    def share(self) -> np.ndarray:
        """Area of the sheet nearest to each particle within its row, over h times the distance of rows [-], shape (N,)."""
        even, odd = np.ones(self.along + 1), np.ones(self.along + 2)
        even[[0, -1]], odd[[0, -1]], odd[[1, -2]] = 0.5, 0.25, 0.75
        if self.along == 1:
            odd[1] = 0.5
        rows = [even, odd] * (self.rows // 2) + [even]
        rows[0], rows[-1] = 0.5 * even, 0.5 * even
        return np.concatenate(rows)

    @cached_property
    def triangle(self) -> np.ndarray:
        """Triangles, counter-clockwise seen from +z, int32, shape (T, 3)."""
        found = []
        for j in range(self.rows):
            even, odd = (self._row[j], self._row[j + 1])[:: 1 - 2 * (j % 2)]
            wide = np.stack([even[:-1], even[1:], odd[1:-1]], axis=1)
            narrow = np.stack([even, odd[1:], odd[:-1]], axis=1)
            both = np.concatenate([wide, narrow])
            found.append(both[:, ::-1] if j % 2 else both)
        return np.concatenate(found).astype(np.int32)

    creases = None
    """Edges at which it is creased: none."""

    @cached_property
    def sides(self) -> dict[str, np.ndarray]:
        """Particles on each side, by its name."""
        ends = np.array([(row[0], row[-1]) for row in self._row])
        return {"-x": ends[:, 0], "+x": ends[:, 1], "-y": self._row[0], "+y": self._row[-1]}

    def rods(self, held: np.ndarray) -> list[Rod]:
        """Lines of particles with the width of the sheet that each link stands for [m].

        A link along x stands for a strip between rows. With the angle a of the others against it, c = cos a and s = sin a, theirs
        is h s/2(s^2 - c^2), the strip between two of them at 60 degrees, so that the sheet has E t along x and along y. A first
        link from a side to the second particle of a row has half of it, and a link along the side h/4: then nothing moves across
        the side where the sheet is pulled along it, and E t holds for its whole width. ``held``, bool, shape (N,): the half links
        of held particles are whole rods.
        """
        h, apart = self.h, self.apart
        d = math.hypot(0.5 * h, apart)
        c, s = 0.5 * h / d, apart / d
        found = []
        for j, row in enumerate(self._row):
            width = np.full(len(row) - 1, apart * (0.5 if j in (0, self.rows) else 1.0))
            length = np.full(len(row) - 1, h)
            if j % 2:
                for link, particle in ((0, row[0]), (-1, row[-1])):
                    width[link] *= 1.0 if held[particle] else SIDE
                    length[link] *= 0.5
            found.append(Rod(row, length, width, np.minimum(width[:-1], width[1:])))
        oblique = 0.5 * h * s / (s * s - c * c)
        for line in self._oblique():
            width = np.full(len(line) - 1, oblique)
            for link in {0, len(width) - 1}:
                width[link] *= 0.5 if self._at_side[line[[link, link + 1]]].any() else 1.0
            found.append(Rod(line, np.full(len(width), d), width, np.full(len(width) - 1, oblique)))
        border = np.full(self.rows, apart), np.full(self.rows, 0.25 * h), np.full(self.rows - 1, 0.25 * h)
        return [*found, Rod(self.sides["-x"], *border), Rod(self.sides["+x"], *border)]

    @cached_property
    def _at_side(self) -> np.ndarray:
        found = np.zeros(len(self.place), bool)
        found[self.sides["-x"]] = found[self.sides["+x"]] = True
        return found

    def _oblique(self) -> list[np.ndarray]:
        """Lines of particles across the rows, upwards, to the right and to the left."""
        found = []
        for to in (0, 1):  # half a link to the left, to the right
            # In halves of a link: even rows have particles at 0, 2, .., odd ones at 1, 3, ..
            for j, row in enumerate(self._row):
                inner = row if j % 2 == 0 else row[1:-1]
                for k in range(len(inner)):
                    at = 2 * k + j % 2
                    before = at - (2 * to - 1)
                    if j and 0 <= before <= 2 * self.along:
                        continue  # it begins further down
                    line, up = [], j
                    while up <= self.rows and 0 <= at <= 2 * self.along:
                        line.append(self._row[up][at // 2 + up % 2])
                        at, up = at + 2 * to - 1, up + 1
                    if len(line) > 1:
                        found.append(np.array(line))
        return found

    def springs(self, young: float, thickness: float, bending: float, held: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs i < j of particles, sorted, int32, shape (S, 2), and k [N/m], r0 [m] and length without load [m] of each, shape
        (S, 3), for Young's modulus [Pa] and the thickness [m]; ``bending`` scales the rigidity."""
        return springs_of(self.rods(held), young * thickness, bending * young * thickness**3 / 12.0)

    def rings_of(self, held: np.ndarray) -> list[BendRing]:
        """All particles with those around them, and the lines along which these springs resist bending."""
        place = np.column_stack([self.place, np.zeros(len(self.place))])
        lines: list[list[BendLine]] = [[] for _ in place]
        for middle, line in bends_of(self.rods(held), place):
            lines[middle].append(line)
        area = np.zeros(len(place))
        np.add.at(area, self.triangle, areas(place, self.triangle)[:, None])
        return [
            BendRing(v, np.array(run[: -1 if closed else None]), closed, float(area[v]), lines[v])
            for v, run, closed in runs_around(self.triangle, len(place))
            if lines[v]
        ]


@lru_cache(maxsize=256)
def weave(sheet: Sheet, h: float) -> Weave:
    """The lattice of a sheet whose spacing is about h [m]: of those near it the one whose links are most nearly at 60 degrees."""
    (lx, ly), best = sheet.size, None
    low, high = math.floor(lx / (h * COARSER)), math.ceil(lx / (h * FINER))
    for along in range(max(1, low), max(1, high) + 1):
        own = lx / along
        rows = max(LEAST_ROWS, 2 * round(0.5 * ly / (own * math.sqrt(0.75))))
        angle = abs(math.log(ly / rows / (own * math.sqrt(0.75))))
        worth = EVEN * angle + abs(math.log(own / h)), along, rows
        best = worth if best is None or worth < best else best
    assert best is not None
    return Weave(lx, ly, best[1], best[2])
