# SPDX-License-Identifier: GPL-2.0-only
"""Held parts go where functions of time say, by ``fix mdanim/drive`` (docs/physics-drives.md)."""

from __future__ import annotations

import math

from ... import features
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...effects.fields import column
from ...model.planes import Plane
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


class Drives(StandardSteps, Effect):
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
        if (moving := next(iter(shifts(scene)), None)) is not None:
            return Verdict(self.name, True, f"{moving.name} moves", scene.spans.get(moving.effect))
        return Verdict(self.name, False, "nothing is driven")

    def acts_on(self, context):
        return self._drives_objects(context) or bool(shifts(context.scene))

    def belts(self, scene):
        return {m: tuple(u.tolist()) for m, solid in enumerate(scene.solids) if (u := motion.belt_of(solid)).any()}

    def drives(self, scene):
        return motion.ways(scene)

    def passes(self, scene):
        return motion.passing(scene)

    def throws(self, scene):
        return {
            m: Throw(speed := motion.ways(scene)[m].speed, 0.0, speed) for m, solid in enumerate(scene.solids) if lets_go(solid)
        }

    def columns(self, context):
        return {HOME: context.system.position} if self._drives_objects(context) else {}

    def commands(self, context):
        moving = {p.motion.fix: p.motion.words for p in shifts(context.scene)}
        alone = [f"fix {fix} all mdanim/drive home none since 0 {words}" for fix, words in moving.items()]
        return [*self._of_objects(context), *alone]

    def _of_objects(self, context):
        if not self._drives_objects(context):
            return []
        group, made, release = "driven", [], ""
        if context.system.pinned.any():
            group, made = GUIDED, [f"group {GUIDED} variable driven"]
            release = "release leapfrog leave driven "
        return [*made, f"fix {self.fix} {group} mdanim/drive home d2_{HOME.name} since 0 {release}motions table:{MOTIONS}"]

    def tables(self, context):
        lines = [f"{m + 1} {motion.words_of(s)}\n" for m, s in enumerate(context.solids) if motion.is_driven(s)]
        if not lines:
            return {}
        return {MOTIONS: "# Motions of what is held, written by mdanim-lammps: molecule words\n" + "".join(lines)}

    def max_timestep(self, context):
        """A part of the shortest period."""
        time = context.scene.control.time
        driven = filter(motion.is_driven, context.scene.solids)
        moving = (plane.motion.quickest for plane in shifts(context.scene))
        quickest = max((*(motion.quickest(solid, time) for solid in driven), *moving), default=0.0)
        return 1.0 / (IN_A_PERIOD * quickest) if quickest else math.inf

    def sources(self, scene):
        return (WORK,)

    def lost(self, readings):
        return {WORK: readings.fix_value(self.fix, WORK) if self._drives_objects(readings.context) else 0.0}

    def clocks(self, readings):
        return super().clocks(readings) if self._drives_objects(readings.context) else {}

    @staticmethod
    def _drives_objects(context):
        return any(map(motion.is_driven, context.solids))


def shifts(scene) -> list[Plane]:
    """Planes of a scene that move."""
    return [p for effect in features.effects() for p in effect.of(scene).planes(scene) if p.motion]


EFFECTS = (Drives(),)
