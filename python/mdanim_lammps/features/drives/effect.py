# SPDX-License-Identifier: GPL-2.0-only
"""Held parts go where functions of time say, by ``fix mdanim/drive`` (docs/physics-drives.md)."""

from __future__ import annotations

import math

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.fields import column
from ...reach import Throw
from . import motion
from .words import lets_go

HOME = column("home", "m", shape=(3,))
"""Places at the start."""
WORK = "work"
"""Column of the ledger: energy that drives have brought in."""
GUIDED = "guided"
"""Group of all that is driven at the start, also of what is released."""
MOTIONS = "motions"
"""Table of motions."""
IN_A_PERIOD = 40.0
"""Steps in a period of an oscillation, and in a turn; the time between two keys is half a period."""


class Drives(Effect):
    """x = to(t) + R(t) (x(0) - from) for what is held and driven [m]; its velocity is the mean of the step, and its work is
    -F dx with the mean of the forces before and after a step (docs/physics-drives.md).
    """

    styles = (("fix", "mdanim/drive"),)
    name = "drives"
    fix = guides = "drive"
    order = 4
    if_off = "what is driven stands still"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if motion.is_driven(solid):
                what = "driven" if solid.drive or solid.key_points else "released"
                return Verdict(self.name, True, f"{solid.name} is {what}", motion.place_of(solid))
        return Verdict(self.name, False, "nothing is driven")

    def acts_on(self, context):
        return any(map(motion.is_driven, context.solids))

    def drives(self, scene):
        return motion.ways(scene)

    def passes(self, scene):
        return motion.passing(scene)

    def throws(self, scene):
        return {
            m: Throw(speed := motion.ways(scene)[m].speed, 0.0, speed) for m, solid in enumerate(scene.solids) if lets_go(solid)
        }

    def columns(self, context):
        return {HOME: context.system.position}

    def commands(self, context):
        group, made, release = "driven", [], ""
        if context.system.pinned.any():
            group, made = GUIDED, [f"group {GUIDED} variable driven"]
            release = "release leapfrog leave driven "
        return [*made, f"fix {self.fix} {group} mdanim/drive home d2_{HOME.name} since 0 {release}motions table:{MOTIONS}"]

    def tables(self, context):
        lines = (f"{m + 1} {motion.words_of(s)}\n" for m, s in enumerate(context.solids) if motion.is_driven(s))
        return {MOTIONS: "# Motions of what is held, written by mdanim-lammps: molecule words\n" + "".join(lines)}

    def max_timestep(self, context):
        """A part of the shortest period."""
        time = context.scene.control.time
        quickest = max((motion.quickest(solid, time) for solid in filter(motion.is_driven, context.scene.solids)), default=0.0)
        return 1.0 / (IN_A_PERIOD * quickest) if quickest else math.inf

    def sources(self, scene):
        return (WORK,)

    def lost(self, readings):
        return {WORK: readings.fix_value(self.fix, WORK)}


EFFECTS = (Drives(),)
