# SPDX-License-Identifier: GPL-2.0-only
"""Springs that break, by ``fix mdanim/tear`` (docs/physics-tearing.md)."""

from __future__ import annotations

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...effects.fields import column
from ...errors import Problem
from ...scene.formatting import say
from ..springs.effect import spring_norm
from .gone import EFFECT, FIX, NAME, acts
from .rules import beyond, over_two_of, rules_text, strain_of
from .words import fills, tears, word_of

TORN = column(NAME, "1", per="bond", dtype="uint8", state=True)
"""1 for a spring that is gone."""
RULES = "tear"
"""Table of what breaks."""
LOST = "torn"
"""Column of the ledger: energy of springs that broke."""


class Tearing(StandardSteps, Effect):
    """A spring is gone from the step on in which r^2 > (1 + e)^2 r0^2 (docs/physics-tearing.md)."""

    styles = (("fix", "mdanim/tear"),)
    name, fix = EFFECT, FIX
    order = 11
    needs = ("springs",)
    if_off = "nothing ever tears"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if tears(solid):
                word = word_of(solid)
                return Verdict(self.name, True, f"{solid.name} has a {word}", solid.spans.get(word))
        return Verdict(self.name, False, "no object has a tear-strain or a toughness")

    def acts_on(self, context):
        return acts(context)

    def columns(self, context):
        return {TORN: np.zeros(len(context.system.spring), np.uint8)}

    def rate(self, context):
        """2 lambda_max/m of what springs over two links leave along one of them, at its far end, beyond their own:
        k2 (L1 + L2)/L1 - k2 with L1 > (L1 + L2)/3, counted as 2 k2; of curved sheets with their shortest L1."""
        system = context.system
        more = np.zeros(len(system.spring))
        for m, (model, solid) in enumerate(zip(context.system_models, context.solids)):
            if tears(solid):
                own, over = system.springs_of(m), over_two_of(system, m, model)
                more[own] = beyond(system, m, over) * system.stiffness[own] * over
        return 2.0 * spring_norm(system, more) / system.mass if more.any() else np.zeros(system.particles)

    def tables(self, context):
        seed, system = context.scene.control.seed, context.system
        lines = ["# What breaks, written by mdanim-lammps: object MOLECULE STRAIN, links and springs over two of them\n"]
        lines += [
            rules_text(system, m, model, one, seed, strain_of(system, m, one))
            for m, (model, one) in enumerate(zip(context.system_models, context.solids))
            if tears(one)
        ]
        return {RULES: "".join(lines)}

    def commands(self, context):
        return [f"fix {self.fix} mobile mdanim/tear torn {TORN.name} objects table:{RULES}"]

    def notes(self, envelope):
        """Solids whose cells no longer push at others once they are torn: their particles alone do."""
        swept, system = envelope.reach.region, envelope.system
        for m, solid in enumerate(envelope.context.solids):
            if not (tears(solid) and fills(solid)):
                continue
            near = ((swept.low[m] < swept.high) & (swept.low < swept.high[m])).all(axis=1)
            solids = envelope.context.solids
            others = [
                k
                for k in np.flatnonzero(near).tolist()
                if k != m and fills(solids[k]) and not tears(solids[k]) and (min(k, m), max(k, m)) not in swept.passing
            ]
            if not others:
                continue
            word = word_of(solid)
            it, more = system.names[others[0]], f" and {len(others) - 1} more" if others[1:] else ""
            apart = say(float(system.spacing[m]), "m")
            cause = (
                f"{solid.name} may meet {it}{more}: where it is torn it bears others by its particles alone, {apart} apart, "
                "and what is narrower sinks in"
            )
            way = f"write a larger {word} or a finer resolution in {solid.name} if it is to bear {it}"
            return [Problem(solid.spans.get(word), cause, way, severity="note")]
        return []

    def losses(self, scene):
        return (LOST,)

    def lost(self, readings):
        return {LOST: readings.fix_value(self.fix, "energy")}

    def clocks(self, readings):
        return {self.name: readings.fix_seconds(self.fix)}


EFFECTS = (Tearing(),)
