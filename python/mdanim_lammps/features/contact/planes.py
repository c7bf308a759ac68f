# SPDX-License-Identifier: GPL-2.0-only
"""Ground and walls: what leaves them is pushed back in proportion to its depth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...effects.effect import Effect
from ...effects.fields import column
from ...errors import Problem
from ...model.planes import innermost
from ...model.touching import WAY_NAMES, Touch, behind_planes
from ...scene.formatting import at_least, say, whole

OR_ON_SURFACES = "or write contact-model surface in control, where what touches holds no energy"
"""The other way out of a start within the reach of the paper's contact."""


STIFFNESS = column("stiffness", "N/m")
"""Stiffness with which particles push back."""
DEEPEST = "deepest"
"""In the vector of fix mdanim/wall: the deepest particle behind the region in this run [m]."""


def others(found: Sequence[Touch], what: str) -> str:
    """Addition to a warning about the first of these starts, about all others."""
    if len(found) < 2:
        return ""
    return f"; {whole(len(found))} {what} start so, with {say(sum(t.energy for t in found), 'J')} in all"


class Boundary(Effect):
    """The common base of ground, walls and basins: a plane pushes a particle back that is a depth d beyond it [m],
    F = s d [N], U = s d^2/2 [J].

    s = E h min(1, 2 n/8) [N/m], with n filled cells among the 8 around the particle (docs/physics-contact.md, "The barrier of
    the paper").
    """

    styles = (("fix", "mdanim/wall"),)
    ledger = "wall"
    touches = presses = at_surfaces = True

    def columns(self, context):
        return {STIFFNESS: context.system.contact_stiffness}

    def region(self, scene) -> str:
        """The region command's style and arguments."""
        raise NotImplementedError

    def commands(self, context):
        return [
            f"region {self.fix} {self.region(context.scene)}",
            f"fix {self.fix} {context.pushed} mdanim/wall {self.fix} d_stiffness",
        ]

    def margins(self, envelope):
        return envelope.own_step("wall", envelope.rates[self.name])

    def warnings(self, context):
        scene = context.scene
        planes = self.planes(scene)
        found = behind_planes(context.system, *innermost(planes))
        if not found:
            return []
        t = found[0]
        solid, name = scene.solids[t.second], planes[0].name
        return [
            Problem(
                solid.spans.get("position") or solid.spans.get("object"),
                f"{solid.name} starts with particles beyond {name}, which holds {say(t.energy, 'J')} at the start and pushes "
                f"them back{others(found, 'objects')}",
                f"move {solid.name} {WAY_NAMES[t.way]} by {say(at_least(t.move, 3), 'm')}; {OR_ON_SURFACES}",
                severity="warning",
            )
        ]

    def energy(self, readings):
        return readings.fix_scalar(self.fix)

    def penetration(self, readings):
        return readings.fix_value(self.fix, DEEPEST)

    def rate(self, context):
        # A wall does not move, so D_i alone bounds it, without the factor 2 of a pair.
        system = context.system
        return np.where(system.held, 0.0, system.contact_stiffness / system.mass)
