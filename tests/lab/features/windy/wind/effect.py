# SPDX-License-Identifier: GPL-2.0-only
"""The wind w gives everything the acceleration w / TAU, and has the potential -m x w / TAU."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.effects import Effect, Verdict
from mdanim_lammps.effects.fields import Field, column
from mdanim_lammps.effects.margin import Margin
from mdanim_lammps.errors import Problem
from mdanim_lammps.model.planes import Plane

TAU = 1.0
"""[s]"""
FAR = -5.0
"""Where the fence stands [m]."""
TEARS = 2.0
"""[m/s]"""


class Wind(Effect):
    """A uniform field along the wind."""

    name = fix = ledger = "wind"
    has_potential = True
    if_off = "sails hang down"

    def called_for(self, scene, reach):
        return Verdict(self.name, any(scene.wind), f"the wind is {scene.wind} m/s", scene.spans.get("wind"))

    def acceleration(self, scene):
        return np.array(scene.wind) / TAU

    def planes(self, scene):
        return (Plane(self.name, "the fence", 0, 1, FAR, "beyond the fence"),) if any(scene.wind) else ()

    def columns(self, context):
        own = np.array([solid.sail for solid in context.scene.solids])[context.system.object]
        return {column("sail", "m^2"): own * np.linspace(1.0, 2.0, context.system.particles)}

    def commands(self, context):
        return ["fix wind mobile mdanim/gravity " + " ".join(repr(float(a)) for a in self.acceleration(context.scene))]

    def potential(self, scene, mass, x):
        return -float((mass * (x @ self.acceleration(scene))).sum())

    def rate(self, context):
        return np.full(context.system.particles, 1e8)

    def max_timestep(self, context):
        return 1e-4

    def margins(self, envelope):
        speed = float(np.linalg.norm(envelope.scene.wind))
        return [Margin("gust", envelope.system.names[0], speed, TEARS, "m/s", "a gust", None, "warning", hint="wait")]

    def warnings(self, context):
        return [Problem(None, "sails are up", "haul them down", severity="warning")]

    def fields(self, scene):
        return (Field("wind_force", "N", per="object", shape=(3,)),)

    def tell(self, readings):
        return {"wind_force": readings.system.mass_of[:, None] * self.acceleration(readings.context.scene)}


EFFECTS = (Wind(),)
