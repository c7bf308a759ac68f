# SPDX-License-Identifier: GPL-2.0-only
"""The motion of rigid bodies, by ``fix mdanim/rigid``."""

from __future__ import annotations

import math

import numpy as np

from ... import features
from ...bodies import all_held
from ...effects.context import Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...effects.fields import Field
from ...errors import Problem
from ...model.inertia import components
from ...scene.formatting import number
from ..contact.surface import DAMPED, HEAT, LET_GO
from . import cradle, points, spinning, touching
from .words import Rigid, Sleep

GROUP = "bodies"
"""Group of the particles of all rigid bodies that move."""
TOUCHING, ON_PLANES = "touching", "on_planes"
"""Groups of the particles of all that touches objects by its features, and planes."""
INERTIA, SHAPES, GLUE = "inertia", "shapes", "glue"
"""Tables of moments, and of shapes, with the fix; and of what is glued together."""
PROOF = "contact_bound"
"""Column of the ledger: largest dt^2 S/4 + dt D/2 of a body since the start (docs/physics-rigid.md)."""
AT_REST = 12.0
"""Sum up to which scenes have come to rest: a row of dominoes had 1.9, a heap of 30 balls and cubes 4.8, a wall of bricks 9.8.
The sum takes all contacts of a body for one, but they act at places of their own."""
TAKEN = {HEAT: "friction_heat", DAMPED: "damping_loss", LET_GO: "let_go"}
"""Columns of the ledger, and their entries of the fix's vector."""
STILLED = "stilled"
"""Column of the ledger, and entry of the vector: energy of motion of what was put to rest."""
WORK = "work"
"""The same of what driven objects that are held give to rigid ones."""


class RigidMotion(StandardSteps, Effect):
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

    @property
    def fixes(self):
        return touching.FIXES

    def settles(self, context, *, planes=False):
        if planes:
            chosen, group = touching.meets_planes(context), ON_PLANES
        else:
            chosen, group = touching.meets_objects(context), TOUCHING
        return (chosen, group) if chosen.any() else None

    def outline(self, scene, m):
        return touching.outline(scene.solids[m])

    def commands(self, context):
        groups = {GROUP: context.system.rigid}
        groups |= {found[1]: found[0] for planes in (False, True) if (found := self.settles(context, planes=planes))}
        fixes = []
        for part in touching.parts(context):
            groups[part.fix] = part.bodies
            words = "".join(f" {word}" for word in touching.guides(context)) if touching.released(context, part) else ""
            words += f" {touching.words(context, part, f'table:{SHAPES}-{part.fix}')}" if part.shapes.any() else ""
            words = f" glue table:{GLUE}{words}" if _glue(context, part) else words
            fixes.append(f"fix {part.fix} {part.fix} mdanim/rigid inertia table:{INERTIA}-{part.fix}{words}")
        return [*(f"group {name} molecule {molecule_ranges(solids)}" for name, solids in groups.items()), *fixes]

    def tables(self, context):
        found = {}
        for part in touching.parts(context):
            found[f"{INERTIA}-{part.fix}"] = inertia_text(context.system.inertia, part.bodies)
            if part.shapes.any():
                found[f"{SHAPES}-{part.fix}"] = touching.shapes_text(context, part)
            if lines := _glue(context, part):
                found[GLUE] = "# Glue, written by mdanim-lammps: faces between pieces, and welds\n" + "".join(lines)
        return found

    def rate(self, context):
        """(Omega/STEP)^2 for bodies that touch by their features, an estimate: the bound for given contacts is dt^2 S/4 + dt D/2
        <= 1 with the sums S and D over the contacts of a body, whose number nothing knows before (docs/physics-rigid.md)."""
        own = context.system.rigid & (touching.meets_objects(context) | touching.meets_planes(context))
        if not own.any():
            return None
        return np.where(own[context.system.object], (touching.omega(context) / touching.STEP) ** 2, 0.0)

    def warnings(self, context):
        """Restitutions and rolling resistances that do not act, because the shape of an object touches at its surface."""
        found = {}
        for where, chosen in (("other objects", touching.meets_objects(context)), ("planes", touching.meets_planes(context))):
            for solid, acts, rigid in zip(context.scene.solids, chosen.tolist(), context.system.rigid.tolist()):
                for word in ("restitution", "rolling"):
                    if getattr(solid, word) is not None and rigid and not acts and touching.may_meet(context, where):
                        found.setdefault((id(solid), word), (solid, []))[1].append(where)
        return [
            Problem(
                solid.spans[word],
                f"{word} of {solid.name} does not act on {' and '.join(where)}: such shapes touch there at their surfaces",
                "write contact-damping in control, or make it of convex shapes"
                if word == "restitution"
                else "leave it out, or make it of convex shapes",
                severity="warning",
            )
            for (_, word), (solid, where) in found.items()
        ]

    def energy(self, readings):
        return self._sum(readings, "contact")

    def losses(self, scene):
        if not _may_touch(scene):
            return ()
        return (*TAKEN, STILLED) if scene.control.sleep is Sleep.ON else tuple(TAKEN)

    def sources(self, scene):
        effects = [e.of(scene) for e in features.effects()]
        moves = any((e.guides and e.drives(scene)) or any(p.motion for p in e.planes(scene)) for e in effects)
        return (WORK,) if moves else ()

    def lost(self, readings):
        scene = readings.context.scene
        return {term: self._sum(readings, TAKEN.get(term, term)) for term in (*self.losses(scene), *self.sources(scene))}

    def penetration(self, readings):
        return max(readings.fix_value(part.fix, "deepest") for part in touching.parts(readings.context))

    def fields(self, scene):
        return (Field(PROOF, "1", ledger=True, largest=True),) if _may_touch(scene) else ()

    def tell(self, readings):
        return {PROOF: max(readings.fix_value(part.fix, "worst_bound") for part in touching.parts(readings.context))}

    def doubts(self, context, run):
        """The largest sum that proves a step, where it is above all with which things are known to have come to rest."""
        most = float(run.ledger(PROOF).max()) if _may_touch(context.scene) else 0.0
        if most <= AT_REST:
            return []
        factor = number(min(0.9, math.sqrt(AT_REST / most)), 2)
        return [
            Problem(
                None,
                f"contacts of rigid objects: the {PROOF} has been {number(most, 3)}, where many touched one object at once; "
                f"up to 1 proves that the step is stable, and with up to {number(AT_REST)} all has been seen to come to rest",
                f"if something trembles where it should lie still, write a timestep of {factor} of this one",
                severity="note",
            )
        ]

    def margins(self, envelope):
        if not (touching.meets_objects(envelope.context).any() or touching.meets_planes(envelope.context).any()):
            return []
        return touching.depths(envelope)

    def notes(self, envelope):
        return [*cradle.notes(envelope), *points.notes(envelope), *spinning.notes(envelope)]

    def kinetic(self, readings):
        return self._sum(readings, "kinetic")

    def drag_taken(self, readings):
        return self._sum(readings, "drag_loss")

    def clocks(self, readings):
        return {self.name: sum(readings.fix_seconds(part.fix) for part in touching.parts(readings.context))}

    def _sum(self, readings, entry: str) -> float:
        """Sum of an entry of the vectors of its fixes."""
        return sum(readings.fix_value(part.fix, entry) for part in touching.parts(readings.context))


def _glue(context, part: touching.Part) -> list[str]:
    """The file of glue of a fix: what is glued together is of known shapes."""
    if part.fix != touching.FIXES[0]:
        return []
    return [line for facet in features.facets("glue") for line in facet.lines(context)]


def _may_touch(scene) -> bool:
    """Whether there is anything that a solid may touch."""
    return len(scene.solids) > 1 or any(e.of(scene).planes(scene) for e in features.effects())


def molecule_ranges(solids: np.ndarray) -> str:
    """Molecule IDs of the chosen solids, bool, shape (M,), as LAMMPS's ranges ``a:b``."""
    chosen = np.flatnonzero(solids) + 1
    pieces = np.split(chosen, np.flatnonzero(np.diff(chosen) > 1) + 1)
    return " ".join(f"{p[0]}:{p[-1]}" if len(p) > 1 else f"{p[0]}" for p in pieces)


def inertia_text(tensors: np.ndarray, solids: np.ndarray) -> str:
    """The file of ``inertia``: tensors of the chosen solids [kg m^2], shape (M, 3, 3), in digits that keep every bit."""
    rows = components(tensors).tolist()
    lines = (f"{m + 1} {' '.join(map(repr, rows[m]))}\n" for m in np.flatnonzero(solids).tolist())
    return "# Moments of inertia, written by mdanim-lammps: molecule Ixx Iyy Izz Ixy Ixz Iyz\n" + "".join(lines)


EFFECTS = (RigidMotion(),)
