# SPDX-License-Identifier: GPL-2.0-only
"""Held parts of objects shake; tethers join every second object with the next; what was before adds to forces."""

from __future__ import annotations

import math

import numpy as np
from mdanim_lammps.effects import Effect, Verdict
from mdanim_lammps.effects.fields import Field, column
from mdanim_lammps.effects.margin import Margin
from mdanim_lammps.reach import Drive

FREQUENCY = 12.0
"""[Hz]"""
TETHER = 400.0
"""Stiffness of a tether [N/m]; as it is at the start, it is free of stress."""
TAUT = Field("taut", "1", per="pair", counts=(8,))
"""Steps in which a tether was longer than at the start."""
HOME = column("home", "m", shape=(3,))
WAY = column("way", "m", shape=(3,), state=True)
PULL = column("pull", "N", shape=(3,))
MOST = column("most", "m", per="bond", state=True)
TURNS = column("turns", "1", per="object", state=True)


class Rig(Effect):
    """x = home + A sin(2 pi f t) for what is held and driven [m]; F = k (r - r0) in tethers [N]."""

    name = fix = "rig"
    ledger = "tethers"
    order = 60
    if_off = "nothing shakes"

    def called_for(self, scene, reach):
        return Verdict(self.name, any(scene.rig), f"the rig shakes by {scene.rig} m", scene.spans.get("rig"))

    def joins(self, scene):
        return [(m, m + 1) for m in range(0, len(scene.solids) - 1, 2)]

    def drives(self, scene):
        far = np.abs(scene.rig)
        speed = 2.0 * math.pi * FREQUENCY * float(np.linalg.norm(scene.rig))
        return {m: Drive(tuple(-far), tuple(far), speed) for m, solid in enumerate(scene.solids) if solid.hold}

    def columns(self, context):
        system = context.system
        i, j = system.spring.T
        nothing = np.zeros((system.particles, 3))
        return {
            HOME: system.position,
            WAY: nothing,
            PULL: nothing,
            MOST: np.linalg.norm(system.position[i] - system.position[j], axis=1),
            TURNS: np.zeros(len(system.names)),
        }

    def commands(self, context):
        scene, system = context.scene, context.system
        numbers = {name: m for m, name in enumerate(system.names)}
        words = [*map(float, scene.rig), FREQUENCY, scene.rig_memory]
        for pair in self.joins(scene):
            names = [scene.solids[m].name for m in pair]
            if all(name in numbers for name in names):
                ends = [int(system.first[numbers[name]]) for name in names]
                length = float(np.linalg.norm(system.position[ends[0]] - system.position[ends[1]]))
                tags = [word for name, end in zip(names, ends) for word in (end + 1, numbers[name] + 1)]
                words += ["tether", *tags, TETHER, length]
        return [f"fix rig {context.pushed} mdanim/test/rig {' '.join(map(str, words))}"]

    def rate(self, context):
        system, found = context.system, np.zeros(context.system.particles)
        found[system.first[:-1]] = 2.0 * TETHER / system.mass[system.first[:-1]]
        return found

    def margins(self, envelope):
        speed = float(envelope.reach.acting.driven_at.max())
        return [Margin("shaking", envelope.system.names[0], speed, 10.0, "m/s", "held parts shake", None, "ok")]

    def energy(self, readings):
        return readings.fix_scalar(self.fix)

    def sources(self, scene):
        return ("work",)

    def lost(self, readings):
        return {"work": readings.fix_value(self.fix, "work")}

    def fields(self, scene):
        return (TAUT, Field("reached", "m", per="object"))

    def tell(self, readings):
        x, system = readings.array("x"), readings.system
        return {TAUT.name: readings.pairs(self.fix, TAUT), "reached": system.bounds(x)[1][:, 2]}


EFFECTS = (Rig(),)
