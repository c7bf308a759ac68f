# SPDX-License-Identifier: GPL-2.0-only
"""Joints, by ``fix mdanim/joint``."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...effects.context import Context, Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...effects.margin import Margin
from ...errors import Problem
from ...scene.formatting import number, say
from . import advice
from .links import Link, links_of
from .measure import first_of_several
from .motion import JointMotion
from .place import doubled, misplaced
from .rows import BROKEN, FIELD, FORCE, TOLD, joint_field, rows_of_joints
from .strength import GAP, Strength, Sums, strengths
from .table import joints_text
from .welds import thin_of, told_of_welds, welds_here

HEAT, WORK = "joint_heat", "work"
"""Columns of the ledger."""
RESOLVED = 120
"""Steps in a period of a spring: leap-frog makes it too short by 1e-4, and its energy varies by 7e-4."""
SHOWS = 4.0
"""Times the gap of a joint between rigid objects, from which on it is worth a warning."""


class Joints(StandardSteps, JointMotion, Effect):
    """Springs between material points of two bodies: U = k |g|^2/2 + k L^2/2 sum |F_A e - F_B e|^2 with the gap g of both points
    and the directions e that a joint holds; motors, friction and stops act on the motion that it leaves (docs/physics-joints.md).
    """

    styles = (("fix", "mdanim/joint"),)
    name = "joint"
    fix = ledger = "joints"
    order = 60
    if_off = "what is joined falls apart"

    def called_for(self, scene, reach):
        if not scene.joints:
            return Verdict(self.name, False, "the scene has no joint")
        joint, more = scene.joints[0], len(links_of(scene).all) - 1
        others = f" and {more} more" if more else ""
        return Verdict(self.name, True, f"joint {joint.words}{others}", joint.spans.get("joint"))

    # --- what it brings into a run ------------------------------------------------------------------------------------

    def acts_on(self, context):
        return bool(_here(context) or welds_here(context))

    def commands(self, context):
        return [f"fix {self.fix} {context.pushed} mdanim/joint joints table:{self.fix}"] if _here(context) else []

    def tables(self, context):
        return {self.fix: joints_text(found, _numbers(context))} if (found := _here(context)) else {}

    def rate(self, context):
        return _sums(context)[0]

    def drag_rate(self, context):
        return _sums(context)[1]

    def max_timestep(self, context):
        """Springs that may be seen to swing take RESOLVED steps in a period."""
        return min((2.0 * math.pi / one.frequency / RESOLVED for one in strengths(context) if one.swings), default=math.inf)

    # --- accounts and frames ------------------------------------------------------------------------------------------

    def energy(self, readings):
        return readings.fix_value(self.fix, "joints") if _here(readings.context) else 0.0

    def losses(self, scene):
        return (HEAT,)

    def sources(self, scene):
        return (WORK,) if any(joint.motor for joint in scene.joints) else ()

    def lost(self, readings):
        scene, acts = readings.context.scene, bool(_here(readings.context))
        return {term: readings.fix_value(self.fix, term) if acts else 0.0 for term in (*self.losses(scene), *self.sources(scene))}

    def clocks(self, readings):
        return super().clocks(readings) if _here(readings.context) else {}

    def fields(self, scene):
        return (joint_field(scene),)

    def tell(self, readings):
        here = _here(readings.context)
        told = [readings.fix_rows(self.fix, len(here), TOLD)] if here else []
        told.append(told_of_welds(readings))
        return {FIELD: _rows(readings.context, np.concatenate(told))}

    def tell_start(self, context):
        # Forces and ways are not known yet.
        links = [one.link for one in _here(context)] + welds_here(context)
        return {FIELD: _rows(context, [(*[np.nan] * (BROKEN - FORCE), 0.0, *one.begin, *one.end) for one in links])}

    # --- advice -------------------------------------------------------------------------------------------------------

    def problems(self, resolved, models, grid):
        return misplaced(resolved.scene, models)

    def warnings(self, context):
        """Joints that stand twice, or are asked about and not the only ones; objects that move against their joints at the start:
        the worst."""
        return [*doubled(context.scene), *first_of_several(context.scene), *advice.drawn_apart(context)]

    def margins(self, envelope):
        found = [one for one in strengths(envelope.context) if not one.swings]
        if not found:
            return []
        worst = max(found, key=lambda one: one.gap / one.thin)
        joint, most = worst.link.joint, SHOWS * GAP * worst.thin
        name = envelope.scene.solids[worst.link.first].name
        stiffness = worst.load * worst.softening / (GAP * worst.thin)
        where = " at the end of its way" if worst.softening > 1.0 else ""
        return [
            Margin(
                "joint gap",
                name,
                worst.gap,
                most,
                "m",
                f"joint {joint.words} opens by {say(worst.gap, 'm')}{where} under {say(worst.load, 'N')}, what hangs on it at "
                f"rest: {number(100.0 * worst.gap / worst.thin, 2)} % of the thinnest part of what it joins",
                joint.spans.get("stiffness") or joint.spans.get("joint"),
                "refused" if worst.turns_over and worst.gap > worst.thin else "warning" if worst.gap > most else "ok",
                hint=f"write stiffness {number(stiffness, 2)} N/m in it",
            )
        ]

    def doubts(self, context, run):
        return advice.opened(strengths(context), run)

    def notes(self, envelope):
        """The hardest joint, where joints set the time step."""
        rates, found = envelope.rates, strengths(envelope.context)
        free = ~envelope.system.held
        if not found or not free.any():
            return []
        total = sum(rates.values())
        worst = int(np.where(free, total, 0.0).argmax())
        if rates[self.name][worst] < 0.5 * total[worst]:
            return []
        m = int(envelope.system.object[worst])
        own = [one for one in found if any(m in body.members for body in one.bodies)]
        hardest = max(own, key=lambda one: one.stiffness)
        joint = hardest.link.joint
        cause = f"joint {joint.words} sets the time step: {number(hardest.stiffness)} N/m "
        if hardest.swings:
            cause += f"give what hangs on it {say(hardest.frequency / (2.0 * math.pi), 'Hz')}"
            way_out = "write a lower stiffness in it, or more mass on it, where it may swing slower"
        else:
            cause += f"hold it together, it opens by {say(hardest.gap, 'm')} under {say(hardest.load, 'N')} at rest"
            way_out = "write a lower stiffness in it where a larger gap may be seen"
        return [Problem(joint.spans.get("joint"), cause, way_out, severity="note")]


def _numbers(context: Context) -> dict[int, int]:
    """Molecule IDs of the solids of a context, by their numbers in the scene."""
    of = {name: m + 1 for m, name in enumerate(context.system.names)}
    return {m: of[solid.name] for m, solid in enumerate(context.scene.solids) if solid.name in of}


def _here(context: Context) -> list[Strength]:
    """The joints of a context: both of their objects are in it."""
    numbers = _numbers(context)
    return [one for one in strengths(context) if _is_in(one.link, numbers)]


def _rows(context: Context, told: np.ndarray | Sequence) -> np.ndarray:
    """Rows of a frame, of what springs hold together and then of welds."""
    joined = [(one.link, one.thin) for one in _here(context)]
    joined += [(one, thin_of(context.scene.solids, one)) for one in welds_here(context)]
    return rows_of_joints(joined, np.reshape(told, (len(joined), TOLD)), _numbers(context))


def _is_in(link: Link, numbers: dict[int, int]) -> bool:
    return all(m in numbers for m in link.ends)


def _sums(context: Context) -> tuple[np.ndarray, np.ndarray]:
    sums = Sums(context)
    for one in strengths(context):
        one.add_to(sums)
    return sums.of_particles()


EFFECTS = (Joints(),)
