# SPDX-License-Identifier: GPL-2.0-only
"""Hands that pull at points of objects, by ``fix mdanim/hand`` (docs/physics-drives.md, "Hands")."""

from __future__ import annotations

import math

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.steered import Steering
from ...errors import Problem
from ...model import shapes
from ...scene.formatting import in_full, number, vector
from . import strength

TABLE = "hands"
"""Table of hands."""
BESIDE = 1.5
"""Largest distance of the point that a hand holds from the object's position, over the radius of the object."""
WORK = "work"
"""Column of the ledger: energy that they have brought in."""


class Hands(Effect):
    """F = k (a - p) + c (u - v) at a material point p with the velocity v, with the place a and velocity u of the hand; no larger
    than three times the weight of the object (docs/physics-drives.md, "Hands").
    """

    styles = (("fix", "mdanim/hand"),)
    name = "hands"
    fix = "hand"
    order = 125
    if_off = "no hand pulls at anything"

    def called_for(self, scene, reach):
        if scene.held_by:
            hand = scene.held_by[0]
            return Verdict(self.name, True, f"a hand pulls at {hand.object}", hand.spans.get("hand"))
        if scene.steerable and strength.scales(scene):
            return Verdict(self.name, True, "objects may be pulled at while the run goes on", scene.spans.get("hands"))
        return Verdict(self.name, False, "no object can be pulled at" if scene.steerable else "no hand pulls at anything")

    def acts_on(self, context):
        pulled = {context.scene.solids[m].name for m in strength.scales(context.scene)}
        return any(name in pulled for name in context.system.names)

    def throws(self, scene):
        return strength.throws(scene)

    def untold(self, scene):
        return dict.fromkeys(strength.scales(scene), "a hand may pull at it, and frames do not tell that from contact")

    def commands(self, context):
        return [f"fix {self.fix} {context.pushed} mdanim/hand hands table:{TABLE}"]

    def tables(self, context):
        lines = (f"{_words(context, hand)}\n" for hand in context.scene.held_by if hand.object in context.system.names)
        return {TABLE: "# Hands, written by mdanim-lammps: strength, particles with weights, keys\n" + "".join(lines)}

    def rate(self, context):
        return strength.limits(context)[0][context.system.object]

    def drag_rate(self, context):
        return strength.limits(context)[1][context.system.object]

    def max_timestep(self, context):
        """A part of the time in which an object follows a hand."""
        quickest = max((scale.frequency for scale in strength.scales(context.scene).values()), default=0.0)
        return 1.0 / (strength.RESOLVED * quickest) if quickest else math.inf

    def steers(self, scene):
        return scene.steerable

    def steering(self, context, name, point):
        if not context.scene.steerable:
            return None
        m = next((m for m in strength.scales(context.scene) if context.scene.solids[m].name == name), None)
        if m is None:
            return None
        held = strength.grip(context, m, np.array(point))
        return Steering(
            begin=f"fix_modify {self.fix} hold {held.words}",
            key=lambda time, at: f"fix_modify {self.fix} key {time!r} {in_full(at)}",
            rows=held.rows,
            weights=held.weights,
            speed=strength.SLOWER * strength.scales(context.scene)[m].speed,
            head=f"hand {name} {{\n  at {_vector(point)} m\n",
            line=lambda time, at: f"  key {time!r} s at {_vector(at)} m\n",
            tail="}\n",
        )

    def steered(self, context, scene, after):
        more = (hand for hand in scene.held_by[len(context.scene.held_by) :] if hand.keys[-1].time >= after)
        return [(hand.keys[-1].time, f"fix_modify {self.fix} hold {_words(context, hand)}") for hand in more]

    def problems(self, resolved, models, grid):
        """Hands that would hold an object where it is not."""
        solids, found = {solid.name: solid for solid in resolved.scene.solids}, []
        for hand in resolved.scene.held_by:
            solid = solids[hand.object]
            away = math.dist(hand.at, solid.position)
            if away > BESIDE * shapes.radius(solid.shape):
                cause = f"the hand would hold {solid.name} at {vector(hand.at)} m, which is {number(away)} m from its position"
                way_out = f"write a point of the object as it is at the start, e.g. {vector(solid.position)} m"
                found.append(Problem(hand.spans.get("at"), cause, way_out))
        return found

    def sources(self, scene):
        return (WORK,)

    def lost(self, readings):
        return {WORK: readings.fix_value(self.fix, WORK)}


def _words(context, hand) -> str:
    """A hand of a scene in the words of the fix."""
    keys = "".join(f" key {key.time!r} {in_full(key.at)}" for key in hand.keys)
    return strength.grip(context, context.system.names.index(hand.object), np.array(hand.at)).words + keys


def _vector(at) -> str:
    return f"({', '.join(repr(float(x)) for x in at)})"


EFFECTS = (Hands(),)
