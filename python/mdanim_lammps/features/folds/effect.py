# SPDX-License-Identifier: GPL-2.0-only
"""Contact of layers, by ``fix mdanim/folds``."""

from __future__ import annotations

from heapq import nlargest

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ..tearing.words import word_of
from .layers import coupled, folds, layers, meeting, pairs

TABLE = "folds"
ENERGY, HEAT, DAMPED = "contact", "friction_heat", "contact_damping_loss"
"""Columns of the ledger."""
SIDES = 2.0
"""Layers of one object that a particle may touch at once."""
AT_ONCE = 2
"""Objects that a particle may touch at once: one over it, and one below."""


class LayersTouch(StandardSteps, Effect):
    """The nearest points of a particle and of the triangles of another layer, or of two links, push each other with
    F = k g'(reach - d) at the distance d; friction and a dashpot (docs/physics-folds.md).
    """

    styles = (("fix", "mdanim/folds"),)
    name = fix = "folds"
    ledger = ENERGY
    touches = True
    order = 55
    if_off = "layers pass through each other"

    def called_for(self, scene, reach):
        if not (found := meeting(scene, reach.region)):
            return Verdict(self.name, False, "no sheets may meet, nothing tears, and nothing has touches-itself")
        one, other = (scene.solids[m] for m in found[0])
        if one is other and folds(one):
            return Verdict(self.name, True, f"{one.name} touches itself", one.spans.get("touches-itself"))
        if one is other:
            return Verdict(self.name, True, f"pieces of {one.name} touch each other", one.spans.get(word_of(one)))
        return Verdict(self.name, True, f"{one.name} may meet {other.name}", other.spans.get("shape"))

    def acts_on(self, context):
        return bool(pairs(context))

    def joins(self, scene):
        return coupled(scene)

    def commands(self, context):
        return [f"fix {self.fix} {context.pushed} mdanim/folds table:{TABLE}"]

    def tables(self, context):
        lines = [
            "# Layers that touch, written by mdanim-lammps: objects, and pairs with reach, stiffness, friction and damping\n"
        ]
        for m, layer in layers(context).items():
            lines += [f"object {m + 1}\n", layer.text()]
        for pair in pairs(context):
            apart = f" {pair.apart!r}" if pair.apart else ""
            values = f"{pair.reach!r} {pair.stiffness!r} {pair.friction!r} {pair.damping!r}"
            lines.append(f"pair {pair.first + 1} {pair.second + 1} {values}{apart}\n")
        return {TABLE: "".join(lines)}

    def rate(self, context):
        """2 SIDES k (1 + s) w/m of a particle: the point itself, with nodes of weights 2 in all, and the s points that it bears
        of the other layer, which are the more the finer that is. Of many objects that it may meet it has at most `AT_ONCE` on
        its two sides, the hardest ones at worst."""
        system, of = context.system, layers(context)
        hardness: dict[int, list[float]] = {}
        for pair in pairs(context):
            ends = (pair.first, pair.second)
            for own, other in {ends, ends[::-1]}:
                one, far = of[own], of[other]
                borne = max(1.0, (one.spacing / far.spacing) ** (1 if one.element.shape[1] == 2 else 2))
                hardness.setdefault(own, []).append(pair.stiffness * (1.0 + borne))
        found = np.zeros(system.particles)
        for own, all_of in hardness.items():
            rows = system.first[own] + of[own].particle
            found[rows] = 2.0 * SIDES * sum(nlargest(AT_ONCE, all_of)) * of[own].weight / system.mass[rows]
        return found

    def energy(self, readings):
        return readings.fix_scalar(self.fix)

    def losses(self, scene):
        return (HEAT, DAMPED)

    def lost(self, readings):
        return {term: readings.fix_value(self.fix, term) for term in self.losses(readings.context.scene)}


EFFECTS = (LayersTouch(),)
