# SPDX-License-Identifier: GPL-2.0-only
"""Planes that push solids back, and the law of the paper for them: in proportion to depth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...effects.context import Context, Verdict
from ...effects.fields import column
from ...errors import Problem
from ...model.planes import AXES, Plane, innermost
from ...scene.formatting import at_least, say, whole
from ...scene.scene import SceneRecord
from .forms import Form, particle_stiffness
from .touching import WAY_NAMES, Touch, behind_planes

OR_ON_SURFACES = "or write contact-model surface in control, where what touches holds no energy"
"""The other way out of a start within the reach of the paper's contact."""


STIFFNESS = column("stiffness", "N/m")
"""Stiffness with which particles push back."""
DEEPEST = "deepest"
"""In the vector of fix mdanim/wall: the deepest particle behind the region in this run [m]."""


def word_of(plane: Plane) -> str:
    """Words for a plane in commands of fixes."""
    place = f"{AXES[plane.axis]} {'lo' if plane.sign > 0 else 'hi'} {float(plane.at)!r}"
    return f"moving {place} {plane.motion.fix}" if plane.motion else f"plane {place}"


def others(found: Sequence[Touch], what: str) -> str:
    """Addition to a warning about the first of these starts, about all others."""
    if len(found) < 2:
        return ""
    return f"; {whole(len(found))} {what} start so, with {say(sum(t.energy for t in found), 'J')} in all"


class Sides:
    """Planes of a feature that objects touch, and what calls for them: an effect of either contact model is made of them."""

    name = ""
    """Name of the effect, and the ID of its fix."""
    order = 1000
    """As `Effect.order`."""
    if_off = ""
    presses = True
    """As `Effect.presses`."""

    def called_for(self, scene: SceneRecord) -> Verdict:
        """Whether the scene calls for them."""
        raise NotImplementedError

    def planes(self, scene: SceneRecord) -> tuple[Plane, ...]:
        """The planes; none of a scene without them."""
        raise NotImplementedError

    def region(self, scene: SceneRecord) -> str:
        """The style and arguments of LAMMPS's region between them."""
        raise NotImplementedError


class Planes(Form):
    """Sides that push solids back; subclasses have the laws of the two contact models (docs/physics-contact.md)."""

    ledger = "wall"

    def __init__(self, sides: Sides, on_surfaces: Form | None = None):
        super().__init__(on_surfaces)
        self.sides, self.name, self.fix, self.order = sides, sides.name, sides.name, sides.order
        self.if_off, self.presses = sides.if_off, sides.presses

    def called_for(self, scene, reach):
        return self.sides.called_for(scene)

    def planes(self, scene):
        return self.sides.planes(scene)

    def margins(self, envelope):
        return envelope.own_step("wall", envelope.rates[self.name])

    def energy(self, readings):
        return readings.fix_scalar(self.fix)


class BarrierPlanes(Planes):
    """A plane pushes a particle back that is a depth d beyond it [m], F = s d [N], U = s d^2/2 [J].

    s = E h min(1, 2 n/8) [N/m], with n filled cells among the 8 around the particle (docs/physics-contact.md, "The barrier of
    the paper").
    """

    styles = (("fix", "mdanim/wall"),)

    def columns(self, context):
        return {STIFFNESS: particle_stiffness(context.scene, context.system)}

    def commands(self, context):
        region = f"region {self.fix} {self.sides.region(context.scene)}"
        groups, pushed = yielding(context, context.pushed)
        return [region, *groups, f"fix {self.fix} {pushed} mdanim/wall {self.fix} d_stiffness"]

    def warnings(self, context):
        scene = context.scene
        planes = self.planes(scene)
        found = behind_planes(context.system, particle_stiffness(scene, context.system), *innermost(planes))
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

    def penetration(self, readings):
        return readings.fix_value(self.fix, DEEPEST)

    def rate(self, context):
        # A wall does not move, so D_i alone bounds it, without the factor 2 of a pair.
        system = context.system
        return np.where(system.held, 0.0, particle_stiffness(context.scene, system) / system.mass)


def yielding(context: Context, of: str) -> tuple[list[str], str]:
    """Commands that make the group of what planes push on, and its name: those of the group ``of``, but for objects that are held
    as a whole and driven. Neither these nor planes give way, so they go through each other."""
    stubborn = np.flatnonzero(context.system.held_whole & context.system.driven) + 1
    if not len(stubborn):
        return [], of
    return [f"group through molecule {' '.join(map(str, stubborn))}", f"group yielding subtract {of} through"], "yielding"
