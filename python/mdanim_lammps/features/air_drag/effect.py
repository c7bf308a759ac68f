# SPDX-License-Identifier: GPL-2.0-only
"""Air drag: -lambda v on every particle, taken implicitly by the leap-frog, Wcislo 1999, eq. (3.9)-(3.13)."""

from __future__ import annotations

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.fields import column
from ...effects.readings import LEAPFROG, Readings
from ..springs.effect import all_held

LAMBDA = column("lambda", "N s/m")
"""The coefficient that the leap-frog takes as drag, of air and liquid together."""
DRAG_LOSS = "drag_loss"
"""Column of the ledger; the leap-frog counts what air and liquid take together."""
SLOWING = 0.3
"""Part of the leap-frog's time for a particle that goes to its drag, of air or liquid (bench/effects.py shares)."""


def slowed_share(readings: Readings) -> float:
    """Part of the leap-frog's time that goes to drag: of the particles that feel any now, after a run mostly at rest."""
    free = ~readings.system.held
    more = SLOWING / (1.0 - SLOWING) * np.count_nonzero(readings.array("d_lambda")[free]) / max(1, np.count_nonzero(free))
    return more / (1.0 + more)


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

    def columns(self, context):
        return {LAMBDA: context.system.drag}

    def friction(self, context):
        return context.system.drag

    def clocks(self, readings):
        return {LEAPFROG: slowed_share(readings) * readings.fix_seconds("leapfrog")}

    def losses(self, scene):
        return (DRAG_LOSS,)

    def lost(self, readings):
        return {DRAG_LOSS: readings.fix_scalar("leapfrog")}


EFFECTS = (AirDrag(),)
