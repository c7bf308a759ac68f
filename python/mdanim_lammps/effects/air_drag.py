# SPDX-License-Identifier: GPL-2.0-only
"""Air drag: -lambda v on every particle, taken implicitly by the leap-frog, Wcislo 1999, eq. (3.9)-(3.13)."""

from __future__ import annotations

from .effect import Effect, Verdict
from .springs import all_held


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

    def energy(self, instance, scene, system):
        return instance.fix_scalar("leapfrog")
