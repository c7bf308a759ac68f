# SPDX-License-Identifier: GPL-2.0-only
"""Air drag: -lambda v on every particle, taken implicitly by the leap-frog, Wcislo 1999, eq. (3.9)-(3.13)."""

from __future__ import annotations

import numpy as np

from ..scene.scene import Switch
from .effect import Effect, Verdict
from .springs import all_held


def felt(scene, system) -> np.ndarray | None:
    """lambda of each particle in air [N*s/m], shape (N,); None where air drag is off."""
    on = AirDrag().called_for(scene).on and scene.effects.get(AirDrag.name) is not Switch.OFF
    return system.drag if on else None


class AirDrag(Effect):
    name = "air-drag"
    ledger = "drag_loss"
    lost = "nothing slows down in air"

    def called_for(self, scene):
        for solid in scene.solids:
            if solid.drag and not all_held(solid):
                return Verdict(self.name, True, f"drag of {solid.name}", solid.spans.get("drag"))
        return Verdict(self.name, False, "no object has drag")

    def columns(self, scene, system):
        return {"lambda": system.drag}

    def friction(self, scene, system):
        return system.drag

    def energy(self, instance, scene, system):
        return instance.fix_scalar("leapfrog")
