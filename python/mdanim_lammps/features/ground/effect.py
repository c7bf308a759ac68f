# SPDX-License-Identifier: GPL-2.0-only
"""A floor plane that pushes back whatever sinks below it."""

from __future__ import annotations

from ...effects.context import Verdict
from ...model.planes import Plane
from ...scene.formatting import say
from ..contact.forms import stiffness_told
from ..contact.planes import Sides
from ..contact.surface import touching_planes


class GroundSides(Sides):
    """A floor plane at a height z [m]."""

    name = "ground"
    order = 50
    if_off = "objects fall for ever"

    def called_for(self, scene):
        if scene.ground is None:
            return Verdict(self.name, False, "no ground in the scene")
        return Verdict(
            self.name, True, f"ground at z = {say(scene.ground, 'm', 6)}{stiffness_told(scene)}", scene.spans.get("ground")
        )

    def planes(self, scene):
        return () if scene.ground is None else (Plane(self.name, "the ground", 2, 1, scene.ground, "below the ground"),)

    def region(self, scene):
        return f"plane 0 0 {scene.ground!r} 0 0 1"


EFFECTS = (touching_planes(GroundSides()),)
