# SPDX-License-Identifier: GPL-2.0-only
"""A floor plane that pushes back whatever sinks below it."""

from __future__ import annotations

from ...effects.context import Verdict
from ...effects.effect import stiffness_told
from ...model.planes import Plane
from ...scene.formatting import say
from ..contact.planes import Boundary
from ..contact.surface import SurfacePlanes


class GroundPlane(Boundary):
    """A floor plane at a height z [m], by the law of `Boundary` (docs/physics-contact.md)."""

    name = fix = "ground"
    order = 50
    if_off = "objects fall for ever"

    def called_for(self, scene, reach):
        if scene.ground is None:
            return Verdict(self.name, False, "no ground in the scene")
        return Verdict(
            self.name, True, f"ground at z = {say(scene.ground, 'm', 6)}{stiffness_told(scene)}", scene.spans.get("ground")
        )

    def planes(self, scene):
        return () if scene.ground is None else (Plane(self.name, "the ground", 2, 1, scene.ground, "below the ground"),)

    def region(self, scene):
        return f"plane 0 0 {scene.ground!r} 0 0 1"


class SurfaceGround(SurfacePlanes, GroundPlane):
    """The same by the law of `SurfacePlanes` (docs/physics-contact.md)."""


EFFECTS = (GroundPlane(SurfaceGround()),)
