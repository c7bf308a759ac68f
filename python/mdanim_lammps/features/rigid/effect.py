# SPDX-License-Identifier: GPL-2.0-only
"""The motion of rigid bodies, by ``fix mdanim/rigid``."""

from __future__ import annotations

import numpy as np

from ... import features
from ...bodies import all_held
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...errors import Problem
from ...model.inertia import components
from ..contact.surface import DAMPED, HEAT, LET_GO
from . import touching
from .words import Rigid

GROUP = "rigid"
"""Group of the particles of all rigid bodies that move."""
TOUCHING = "touching"
"""Group of the particles of all that touches by its features."""
INERTIA, SHAPES = "inertia", "shapes"
"""Tables of moments, and of shapes."""
TAKEN = {HEAT: "friction_heat", DAMPED: "damping_loss", LET_GO: "let_go"}
"""Columns of the ledger, and their entries of the fix's vector."""


class RigidMotion(Effect):
    """Six numbers of place and six of motion: m dv/dt = F, dL/dt = T about the centre of mass, with the sums of forces on the
    particles of a body and of their torques (docs/physics-rigid.md, "Motion").

    Mass, centre and moments of inertia are those of the shape (model/inertia.py).
    """

    styles = (("fix", "mdanim/rigid"),)
    name = fix = "rigid"
    ledger = "contact"
    at_surfaces = True
    order = 5
    if_off = "rigid objects fall apart into loose particles"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if isinstance(solid.elasticity, Rigid) and not all_held(solid):
                return Verdict(self.name, True, f"{solid.name} is rigid and can move", solid.spans.get("elasticity"))
        return Verdict(self.name, False, "no object that can move is rigid")

    def acts_on(self, context):
        return bool(context.system.rigid.any())

    def integrates(self, context):
        return context.system.rigid, GROUP

    def settles(self, context):
        return (touching.by_features(context), TOUCHING) if self.acts_on(context) and touching.is_on(context) else None

    def commands(self, context):
        groups = [f"group {GROUP} molecule {' '.join(molecule_ranges(context.system.rigid))}"]
        command = f"fix {self.fix} {GROUP} mdanim/rigid inertia table:{INERTIA}"
        if settled := self.settles(context):
            groups.append(f"group {TOUCHING} molecule {' '.join(molecule_ranges(settled[0]))}")
            command += f" {touching.words(context, f'table:{SHAPES}')}"
        return [*groups, command]

    def tables(self, context):
        found = {INERTIA: inertia_text(context.system.inertia, context.system.rigid)}
        return found | {SHAPES: touching.shapes_text(context)} if self.settles(context) else found

    def rate(self, context):
        """Of bodies that touch by their features (Omega/STEP)^2, an estimate: the bound for given contacts is dt^2 S/4 + dt D/2
        <= 1 with the sums S and D over the contacts of a body, whose number nothing knows before (docs/physics-rigid.md)."""
        if not (settled := self.settles(context)):
            return None
        own = (settled[0] & context.system.rigid)[context.system.object]
        return np.where(own, (touching.omega(context) / touching.STEP) ** 2, 0.0)

    def energy(self, readings):
        return readings.fix_value(self.fix, "contact")

    def losses(self, scene):
        return tuple(TAKEN) if _may_touch(scene) else ()

    def lost(self, readings):
        return {term: readings.fix_value(self.fix, TAKEN[term]) for term in self.losses(readings.context.scene)}

    def penetration(self, readings):
        return readings.fix_value(self.fix, "deepest")

    def problems(self, resolved, models, grid):
        """The drag of a liquid acts through the leap-frog, which does not move rigid bodies."""
        if not resolved.on("liquid-drag"):
            return []
        solid = next(s for s, m in zip(resolved.scene.solids, models) if m.inertia is not None)
        cause = f"{solid.name} is rigid: the drag of a liquid is not computed for rigid objects"
        return [Problem(solid.spans.get("elasticity"), cause, "write drag 0 in the liquid, or give the object an elasticity")]

    def kinetic(self, readings):
        return readings.fix_value(self.fix, "translation") + readings.fix_value(self.fix, "rotation")


def _may_touch(scene) -> bool:
    """Whether there is anything that a solid may touch."""
    return len(scene.solids) > 1 or any(e.of(scene).planes(scene) for e in features.effects())


def molecule_ranges(solids: np.ndarray) -> list[str]:
    """Molecule IDs of the chosen solids, bool, shape (M,), as LAMMPS's ranges ``a:b``."""
    chosen = np.flatnonzero(solids) + 1
    pieces = np.split(chosen, np.flatnonzero(np.diff(chosen) > 1) + 1)
    return [f"{p[0]}:{p[-1]}" if len(p) > 1 else f"{p[0]}" for p in pieces]


def inertia_text(tensors: np.ndarray, solids: np.ndarray) -> str:
    """The file of ``inertia``: tensors of the chosen solids [kg m^2], shape (M, 3, 3), in digits that keep every bit."""
    rows = components(tensors).tolist()
    lines = (f"{m + 1} {' '.join(map(repr, rows[m]))}\n" for m in np.flatnonzero(solids).tolist())
    return "# Moments of inertia, written by mdanim-lammps: molecule Ixx Iyy Izz Ixy Ixz Iyz\n" + "".join(lines)


EFFECTS = (RigidMotion(),)
