# SPDX-License-Identifier: GPL-2.0-only
"""A box that objects never leave."""

from __future__ import annotations

from ...effects.context import Verdict
from ...model.planes import box_sides
from ..contact.forms import stiffness_told
from ..contact.planes import Sides
from ..contact.surface import touching_planes
from ..drives.shift import motion_of


class WallSides(Sides):
    """The six sides of a box [m]."""

    name = "walls"
    order = 60
    if_off = "objects leave the scene"

    def called_for(self, scene):
        if scene.walls is None:
            return Verdict(self.name, False, "no walls in the scene")
        return Verdict(self.name, True, f"walls around the scene{stiffness_told(scene)}", scene.spans.get("walls"))

    def planes(self, scene):
        if scene.walls is None:
            return ()
        motion = motion_of(self.name, scene.walls_drive, scene.walls_keys, scene.control.time)
        return box_sides(self.name, scene.walls, 3, "the space between the walls", motion)

    def region(self, scene):
        low, high = scene.walls.low, scene.walls.high
        return "block " + " ".join(f"{a!r} {b!r}" for a, b in zip(low, high))


EFFECTS = (touching_planes(WallSides()),)
