# SPDX-License-Identifier: GPL-2.0-only
"""Air drag: -lambda v on every particle, taken implicitly by the leap-frog, Wcislo 1999, eq. (3.9)-(3.13)."""

from __future__ import annotations

import numpy as np

from ...bodies import all_held
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.leapfrog import DRAG_LOSS, LAMBDA, drag_loss, drag_seconds
from ...model.shapes import mass


class AirDrag(Effect):
    """Drag of air at rest: F = -lambda v on every particle [N], Wcislo 1999, eq. (3.9), taken implicitly by the leap-frog, eq.
    (3.13).

    ``drag`` lambda [N s/m] of an object is shared among its particles by their masses, so that it neither turns nor bends
    (docs/physics-solids.md, "Damping and drag").
    """

    styles = (("fix", "mdanim/leapfrog"),)
    name = "air-drag"
    order = 80
    if_off = "nothing slows down in air"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if solid.drag and not all_held(solid):
                return Verdict(self.name, True, f"drag of {solid.name}", solid.spans.get("drag"))
        return Verdict(self.name, False, "no object has drag")

    def slows(self, scene):
        return np.array([solid.drag > 0.0 for solid in scene.solids], bool)

    def impulses(self, scene, mass, times, center):
        # -lambda v has given -lambda (x - x0), whatever the motion: the leap-frog takes the mean of the velocities around a step.
        return -np.array([solid.drag for solid in scene.solids])[:, None] * (center - center[0])

    def drag(self, context):
        rate = np.array([solid.drag / mass(solid) if solid.drag else 0.0 for solid in context.solids])
        return context.system.mass * rate[context.system.object]

    def friction(self, context):
        return self.drag(context)

    def columns(self, context):
        return {LAMBDA: context.drag}

    def clocks(self, readings):
        return drag_seconds(self, readings)

    def losses(self, scene):
        return (DRAG_LOSS,)

    def lost(self, readings):
        return drag_loss(self, readings)


EFFECTS = (AirDrag(),)
