# SPDX-License-Identifier: GPL-2.0-only
"""Bodies that have folded through themselves: contact acts between objects, so nothing keeps parts of one body apart."""

from __future__ import annotations

import numpy as np

from ..model.system import System

SLENDER = 0.25
"""Cells of a body over the cube of its longest side in cells, below which it may bend back on itself; of a ball it is 0.52."""
BIN = 0.7
"""Edge of the bins in which particles are counted as in one place, over the spacing."""
APART = 3.0
"""Spacings between them at the start, at least."""
FEW, PART = 3, 0.01
"""Particles, and part of all of the body, that may be where others are: skins that graze each other."""

NONE = np.zeros(0, np.int64)
"""No objects."""


class Folds:
    """Looks for particles of one body that lie among others of it that were far away at the start, one of the two inside.

    Of a body one cell thin, which has nothing inside, nothing is found.
    """

    def __init__(self, system: System):
        self.system = system
        kind = np.array([f.cells.filled.sum() < SLENDER * float(f.cells.count.max()) ** 3 for f in system.frames], bool)
        self.may = kind[system.contact_kind] & ~system.still
        """Bodies that may fold, bool, shape (M,)."""

    def find(self, objects: np.ndarray, x: np.ndarray, torn: np.ndarray = NONE) -> tuple[np.ndarray, np.ndarray]:
        """How many particles of each of these objects, ascending, shape (m,), lie so, int64, shape (m,), and their mean place
        [m], shape (m, 3); x is [m], shape (N, 3). Nothing is told of those that are ``torn``, whose pieces touch anywhere."""
        count, place = np.zeros(len(objects), np.int64), np.zeros((len(objects), 3))
        for n in np.flatnonzero(self.may[objects] & ~np.isin(objects, torn)).tolist():
            mine = slice(*self.system.first[objects[n] : objects[n] + 2])
            here, h = x[mine], float(self.system.spacing[objects[n]])
            bins = np.floor((here - here.min(0)) / (BIN * h)).astype(np.int64)
            size = bins.max(0) + 1
            key = (bins[:, 0] * size[1] + bins[:, 1]) * size[2] + bins[:, 2]
            order = np.argsort(key, kind="stable")
            one, other = order[:-1], order[1:]
            same = key[one] == key[other]
            one, other = one[same], other[same]
            start, skin = self.system.position[mine], self.system.boundary[mine]
            far = ((start[one] - start[other]) ** 2).sum(1) > (APART * h) ** 2
            far &= ~(skin[one] & skin[other])  # skins may lie on each other
            if np.count_nonzero(far) > max(FEW, PART * len(here)):
                count[n], place[n] = np.count_nonzero(far), here[one[far]].mean(0)
        return count, place
