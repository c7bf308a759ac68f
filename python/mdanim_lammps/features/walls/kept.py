# SPDX-License-Identifier: GPL-2.0-only
"""The walls in a trajectory."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...effects.kept import KeptRecord
from ...scene.scene import Vector


@dataclass(frozen=True, slots=True)
class Room(KeptRecord):
    """The box that objects never leave."""

    low: Vector
    """Lower corner [m]."""
    high: Vector
    """Upper corner [m]."""

    @classmethod
    def of(cls, scene, grid):
        return cls(scene.walls.low, scene.walls.high) if scene.walls else None

    @classmethod
    def read(cls, attributes, shapes):
        return cls(*attributes["walls"]) if "walls" in attributes else None

    def write(self):
        return {"walls": (self.low, self.high)}

    def fault(self):
        box = np.array((self.low, self.high))
        return "" if box.shape == (2, 3) and np.isfinite(box).all() else "the walls are not a box"


KEPT = {"walls": Room}
