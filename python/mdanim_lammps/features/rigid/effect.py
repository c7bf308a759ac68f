# SPDX-License-Identifier: GPL-2.0-only
"""The motion of rigid bodies, by ``fix mdanim/rigid``."""

from __future__ import annotations

import numpy as np

from ...bodies import all_held
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...errors import Problem
from ...model.inertia import components
from .words import Rigid

GROUP = "rigid"
"""Group of the particles of all rigid bodies that move."""
INERTIA = "inertia"
"""Table of their moments."""


class RigidMotion(Effect):
    """Six numbers of place and six of motion: m dv/dt = F, dL/dt = T about the centre of mass, with the sums of forces on the
    particles of a body and of their torques (docs/physics-rigid.md, "Motion").

    Mass, centre and moments of inertia are those of the shape (model/inertia.py).
    """

    styles = (("fix", "mdanim/rigid"),)
    name = fix = "rigid"
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

    def commands(self, context):
        molecules = " ".join(molecule_ranges(context.system.rigid))
        return [f"group {GROUP} molecule {molecules}", f"fix {self.fix} {GROUP} mdanim/rigid inertia table:{INERTIA}"]

    def tables(self, context):
        return {INERTIA: inertia_text(context.system.inertia, context.system.rigid)}

    def problems(self, resolved, models, grid):
        """The drag of a liquid acts through the leap-frog, which does not move rigid bodies."""
        if not resolved.on("liquid-drag"):
            return []
        solid = next(s for s, m in zip(resolved.scene.solids, models) if m.inertia is not None)
        cause = f"{solid.name} is rigid: the drag of a liquid is not computed for rigid objects"
        return [Problem(solid.spans.get("elasticity"), cause, "write drag 0 in the liquid, or give the object an elasticity")]

    def kinetic(self, readings):
        return readings.fix_value(self.fix, "translation") + readings.fix_value(self.fix, "rotation")


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
