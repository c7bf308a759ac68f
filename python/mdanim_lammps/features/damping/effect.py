# SPDX-License-Identifier: GPL-2.0-only
"""Internal damping: a dashpot along every spring of a solid with ``damping``; it needs no command of its own."""

from __future__ import annotations

import numpy as np

from ...bodies import all_held
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...model.springs import dashpots
from ..springs.effect import spring_norm, time_of_dashpots


class Damping(Effect):
    """A dashpot beside each spring: F = -c v along the line of two particles [N], c = 2 zeta sqrt(k m_ij) [N s/m], m_ij the
    reduced mass.

    ``damping`` zeta [-] is the fraction of critical damping of the two alone (docs/physics-solids.md, "Damping and drag").
    """

    name = "damping"
    order = 20
    needs = ("springs",)
    if_off = "damped objects ring for ever"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if solid.damping and not all_held(solid):
                return Verdict(self.name, True, f"damping of {solid.name}", solid.spans.get("damping"))
        return Verdict(self.name, False, "no object has damping")

    def damping_ratio(self, context):
        return np.array([solid.damping for solid in context.solids])

    def losses(self, scene):
        return ("damping_loss",)

    def lost(self, readings):
        return {"damping_loss": readings.damping_loss()}

    def clocks(self, readings):
        more = time_of_dashpots(readings.context)
        return {"springs": readings.bond_seconds() * more / (1.0 + more)}

    def drag_rate(self, context):
        c = dashpots(context.system, self.damping_ratio(context))
        return 2.0 * spring_norm(context.system, c) / context.system.mass if c.any() else None


EFFECTS = (Damping(),)
