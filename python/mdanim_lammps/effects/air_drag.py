# SPDX-License-Identifier: GPL-2.0-only
"""Air drag: -lambda v on every particle, taken implicitly by the leap-frog, Wcislo 1999, eq. (3.9)-(3.13)."""

from __future__ import annotations

import numpy as np

from ..scene.scene import Switch
from .effect import Effect, Verdict
from .readings import Readings
from .springs import all_held

LEAPFROG = "leap-frog"
"""Clock of the integrator; what effects take of it is not counted with the integrator's own time."""
DRAG_LOSS = "drag_loss"
"""Column of the ledger; the leap-frog counts what air and liquid take together."""
SLOWING = 0.3
"""Part of the leap-frog's time for a particle that goes to its drag, of air or liquid (bench/effects.py shares)."""


def felt(scene, system) -> np.ndarray | None:
    """lambda of each particle in air [N*s/m], shape (N,); None where air drag is off."""
    on = AirDrag().called_for(scene).on and scene.effects.get(AirDrag.name) is not Switch.OFF
    return system.drag if on else None


def slowed_share(readings: Readings) -> float:
    """Part of the leap-frog's time that goes to drag: of the particles that feel any now, after a run mostly at rest."""
    free = ~readings.system.held
    more = SLOWING / (1.0 - SLOWING) * np.count_nonzero(readings.array("d_lambda")[free]) / max(1, np.count_nonzero(free))
    return more / (1.0 + more)


class AirDrag(Effect):
    name = "air-drag"
    if_off = "nothing slows down in air"

    def called_for(self, scene, planes=None):
        for solid in scene.solids:
            if solid.drag and not all_held(solid):
                return Verdict(self.name, True, f"drag of {solid.name}", solid.spans.get("drag"))
        return Verdict(self.name, False, "no object has drag")

    def columns(self, scene, system):
        return {"lambda": system.drag}

    def friction(self, scene, system):
        return system.drag

    def clocks(self, readings):
        return {LEAPFROG: slowed_share(readings) * readings.fix_seconds("leapfrog")}

    def losses(self, scene):
        return (DRAG_LOSS,)

    def lost(self, readings):
        return {DRAG_LOSS: readings.fix_scalar("leapfrog")}
