# SPDX-License-Identifier: GPL-2.0-only
"""Glue between the pieces of rigid objects, by ``fix mdanim/rigid``."""

from __future__ import annotations

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...effects.fields import Field
from ...errors import Problem
from ...scene.formatting import number, say
from ...scene.scene import PieceShape
from ..contact.words import CONTACT_STIFFNESS
from ..rigid.touching import FIXES, OF_WHOLE, STRESS, told_of_bodies
from .glue import EFFECT, is_glued, wholes

TORN = "torn"
"""Column of the ledger: energy that was lost where glue broke."""
WHOLE = "whole"
"""Field of objects: number of the first piece that one hangs together with, from 1; 0 of what is none."""
HARDER = 1.5
"""Stress over the strength that a harder contact is to give: loads of a blow rise with the root of the stiffness."""
BORE = "stress"
"""Field of objects: largest stress that the glue of a piece bore so far [Pa]; 0 of what is none."""


class Glue(StandardSteps, Effect):
    """Pieces move as one rigid body until the stress in a face is above its strength (docs/physics-pieces.md)."""

    styles = (("fix", "mdanim/rigid"),)
    name = EFFECT
    order = 6
    needs = ("rigid",)
    if_off = "objects with pieces fall apart from the start"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if isinstance(solid.shape, PieceShape):
                return Verdict(self.name, True, f"{solid.shape.whole.name} has pieces", solid.spans.get("pieces"))
        return Verdict(self.name, False, "no object has pieces")

    def joins(self, scene):
        return tuple((m, m + 1) for first, end in wholes(scene) for m in range(first, end - 1))

    def untold(self, scene):
        return dict.fromkeys(self.mutual(scene), "glue holds its pieces together, and frames do not tell that from contact")

    def mutual(self, scene):
        return {m for begin, end in wholes(scene) for m in range(begin, end)}

    def acts_on(self, context):
        return is_glued(context)

    def losses(self, scene):
        return (TORN,)

    def lost(self, readings):
        return {TORN: readings.fix_value(FIXES[0], TORN)}

    def fields(self, scene):
        return (whole_field(scene), Field(BORE, "Pa", per="object", counts=(len(scene.solids),)))

    def tell(self, readings):
        system, solids = readings.system, readings.context.solids
        number = {solid.name: m + 1.0 for m, solid in enumerate(readings.context.scene.solids)}
        whole, bore = np.zeros((2, len(system.names)))  # others than pieces may be elsewhere, where nothing tells of them
        for m, row in told_of_bodies(readings).items():
            if isinstance(solids[m].shape, PieceShape):
                whole[m] = number[solids[int(row[OF_WHOLE]) - 1].name]
                bore[m] = row[STRESS]
        return {WHOLE: whole, BORE: bore}

    def doubts(self, context, run):
        """Notes on objects that did not break, with the stress that they bore."""
        found = []
        hangs, stress = (run.trajectory.field(name, len(run.times) - 1) for name in (WHOLE, BORE))
        for begin, end in wholes(context.scene):
            solid = context.scene.solids[begin]
            if len(np.unique(hangs[begin:end])) > 1:
                continue
            bore, whole = float(stress[begin:end].max()), solid.shape.whole
            cause = f"{whole.name} bore up to {say(bore, 'Pa')} of {say(solid.strength, 'Pa')} and did not break"
            ways = [f"write strength {say(float(number(0.5 * bore, 2)), 'Pa')}"] if bore > 0.0 else []
            ways += ["let it fall from higher"]
            if bore > 0.0 and (harder := (HARDER * solid.strength / bore) ** 2) <= CONTACT_STIFFNESS.most:
                ways += [f"write contact-stiffness {number(harder, 2)} in control"]
            way_out = f"if it should, {', or '.join(ways)}"
            found.append(Problem(whole.spans["pieces"], cause, way_out, severity="note"))
        return found


def whole_field(scene) -> Field:
    """The field of a scene that says which objects hang together."""
    return Field(WHOLE, "1", per="object", counts=(len(scene.solids),), whole=True)


EFFECTS = (Glue(),)
