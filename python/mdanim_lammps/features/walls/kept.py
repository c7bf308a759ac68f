# SPDX-License-Identifier: GPL-2.0-only
"""The walls in a trajectory."""

from __future__ import annotations

import numpy as np

from ...effects.kept import KeptRecord
from ...records import dataclass
from ...scene.scene import Vector


@dataclass(frozen=True, slots=True)
class Room(KeptRecord):
    """The box that objects never leave."""

    walls: tuple[Vector, Vector]
    """Its lower and upper corner [m]."""

    @classmethod
    def of(cls, scene, grid):
        return cls((scene.walls.low, scene.walls.high)) if scene.walls else None

    def fault(self):
        box = np.array(self.walls)
        return "" if box.shape == (2, 3) and np.isfinite(box).all() else "the walls are not a box"


KEPT = {"walls": Room}
