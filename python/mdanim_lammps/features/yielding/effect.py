# SPDX-License-Identifier: GPL-2.0-only
"""Springs that yield, by ``fix mdanim/yield`` (docs/physics-yielding.md)."""

from __future__ import annotations

import numpy as np

from ...effects.context import Context, Verdict
from ...effects.effect import Effect
from ...effects.envelope import Envelope
from ...effects.facets import StandardSteps
from ...effects.fields import BENT, column
from ...effects.margin import Margin
from ...errors import Problem
from ...model.springs import dashpots
from ...scene.formatting import at_least, number, say
from ..springs.effect import spring_norm
from .bends import field_of, first_values, is_layer, stiffness, table
from .grown import EFFECT, FIX, NAME, acts
from .words import yields

GROWN = column(NAME, "m", per="bond", state=True)
"""Growth of the rest length of a spring."""
BEARS = column("bears", "m", per="bond")
"""Stretch that a spring bears, either way; 0 for one that never yields."""
CRUSHED = 0.15
"""Energy of motion of each volume over E e above which cells at the spot of a blow may be crushed (docs/physics-yielding.md)."""
LOOK = 2.0
"""Seconds of the flights of what may hit."""
FREE = column("free", "m", per="bond")
"""Length of a spring without load, where it is not its rest length."""
RINGS = "bends"
"""Table of rings."""
POISSON = {3: 0.25, 2: 1.0 / 3.0}
"""Poisson's ratio of lattices (docs/physics-solids.md) and of flat sheets."""
ANY_WAY = 0.82
"""Part of e that springs of curved sheets bear, whose directions are any: the mean of what they bear is then E e."""
LOST = "yielding"
"""Column of the ledger: work of springs that yield."""


class Yielding(StandardSteps, Effect):
    """F = -k (r - r0 - p), p = r - L -+ b where +-(r - L - p) > b, of sheets in bending, too (docs/physics-yielding.md)."""

    styles = (("fix", "mdanim/yield"),)
    name, fix = EFFECT, FIX
    order = 12
    needs = ("springs",)
    if_off = "nothing stays bent"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if yields(solid):
                return Verdict(self.name, True, f"{solid.name} has a yield-strain", solid.spans.get("yield-strain"))
        return Verdict(self.name, False, "no object has a yield-strain")

    def acts_on(self, context):
        return acts(context)

    def columns(self, context):
        found = {GROWN: np.zeros(len(context.system.spring)), BEARS: borne(context)}
        if _holds_itself(context):
            found[FREE] = context.system.unloaded
        if (bent := field_of(context)) is not None:
            found[bent] = first_values(context, bent)
        return found

    def tables(self, context):
        rings = table(context, share)
        return {RINGS: rings} if rings else {}

    def rate(self, context):
        system, found = context.system, turned(context, context.system.stiffness)
        for m, (model, solid) in enumerate(zip(context.system_models, context.solids)):
            if is_layer(solid):
                own = slice(*system.first[m : m + 2])
                found[own] += stiffness(model, solid) / system.mass[own]
        return found

    def drag_rate(self, context):
        ratio = context.damping_ratio
        return turned(context, dashpots(context.system, ratio)) if ratio.any() else None

    def margins(self, envelope):
        return blow(envelope)

    def notes(self, envelope):
        """Ropes, which have no direction across in which they could keep a bend."""
        for model, solid in zip(envelope.context.models, envelope.scene.solids):
            if yields(solid) and model.frame.dimensions == 1:
                cause = f"{solid.name} keeps what it is pulled to, and does not stay bent"
                way = "write a strip, as in shape sheet (30, 1) cm thickness 2 mm, or a box, for a wire that is to be bent"
                return [Problem(solid.spans.get("yield-strain"), cause, way, severity="note")]
        return []

    def commands(self, context):
        free = f" free {FREE.name}" if _holds_itself(context) else ""
        bends = f" bent {BENT} rings table:{RINGS}" if any(map(is_layer, context.solids)) else ""
        return [f"fix {self.fix} mobile mdanim/yield grown {GROWN.name} bears {BEARS.name}{free}{bends}"]

    def losses(self, scene):
        return (LOST,)

    def lost(self, readings):
        return {LOST: readings.fix_value(self.fix, "energy")}

    def clocks(self, readings):
        return {self.name: readings.fix_seconds(self.fix)}


def _holds_itself(context: Context) -> bool:
    """Whether a scene has springs that yield and push without load, of ropes and sheets."""
    return any(yields(solid) and model.frame.bare for model, solid in zip(context.models, context.scene.solids))


def share(context: Context, m: int, way: np.ndarray) -> np.ndarray:
    """Part of e that what lies along directions of an object bears, shape (K,), from these by its own axes, shape (K, 3): the
    strain there in a body that is pulled along one of its axes until it is longer by 1, of all axes the largest. So all of it
    yields together, and a bar bears E e."""
    frame = context.system_models[m].frame
    if frame.dimensions == 1:
        return np.ones(len(way))
    if frame.spans != frame.dimensions:
        return np.full(len(way), ANY_WAY)
    square = (way[:, : frame.dimensions] ** 2).max(axis=1) / (way**2).sum(axis=1)
    return (1.0 + POISSON[frame.dimensions]) * square - POISSON[frame.dimensions]


def borne(context: Context) -> np.ndarray:
    """Stretch that springs bear [m], shape (S,): `share` of e, of their length without load."""
    system, found = context.system, np.zeros(len(context.system.spring))
    for m, solid in enumerate(context.solids):
        if yields(solid):
            own = system.springs_of(m)
            i, j = system.spring[own].T
            along = (system.position[i] - system.position[j]) @ np.array(solid.rotation)
            found[own] = solid.yield_strain * share(context, m, along) * system.unloaded[own]
    return found


def turned(context: Context, weight: np.ndarray) -> np.ndarray:
    """Share in a bound by which it holds for a body that yields however it is bent, shape (N,), unit of ``weight`` over kg.

    Directions of springs are no longer those of the start: sum w n n^T of a particle is at most sum w in any direction, and the
    part of a spring across its own, (1 - r0/r) w, is never above w. So the share is 2 (sum w - lambda_max(sum w n n^T))/m.
    """
    system = context.system
    own = np.array([yields(solid) for solid in context.solids], bool)[system.object[system.spring[:, 0]]]
    weight, (i, j) = np.where(own, weight, 0.0), system.spring.T
    whole = np.bincount(i, weight, system.particles) + np.bincount(j, weight, system.particles)
    return 2.0 * (whole - spring_norm(system, weight)) / system.mass


def blow(env: Envelope) -> list[Margin]:
    """The energy of motion of each volume of a solid beside E e, which is what each volume takes that is pressed to nothing."""
    solid = np.array([yields(one) and not model.frame.bare for one, model in zip(env.scene.solids, env.context.models)], bool)
    own = solid & env.reach.moving
    if not own.any() or (len(own) == 1 and not env.planes):
        return []
    system = env.system
    bears = system.young * np.where(solid, [one.yield_strain or np.inf for one in env.scene.solids], np.inf)
    ratio = np.where(own, 0.5 * system.density * env.reach.speed**2 / bears, 0.0)
    m = int(ratio.argmax())
    enough = at_least(env.scene.solids[m].yield_strain * float(ratio[m]) / CRUSHED) if ratio[m] else 0.0
    speed, stress = say(env.reach.speed[m], "m/s", 2), say(bears[m], "Pa", 2)
    return [
        Margin(
            "yielding",
            system.names[m],
            float(ratio[m]),
            CRUSHED,
            "",
            f"{system.names[m]} may hit at {speed}, with {ratio[m]:.2g} of the stress {stress} at which it yields by volume; "
            f"above about {CRUSHED:g} cells where it lands may be crushed",
            env.place(m, "yield-strain"),
            "warning" if ratio[m] > CRUSHED else "ok",
            hint=f"write yield-strain {number(enough)} or more, a larger elasticity, or a lower height or speed",
        ),
        *struck(env, bears),
    ]


def struck(env: Envelope, bears: np.ndarray) -> list[Margin]:
    """The energy of motion of each volume of what may hit a solid, beside the stress E e that this one bears [Pa], shape (M,): of
    the pair of most energy for which it is too much and whose ways cross as both fly alone. None where no pair is."""
    system, (low, high) = env.system, env.reach.flight().swept(min(env.scene.control.time, LOOK))
    energy = 0.5 * system.density * np.where(env.reach.moving, env.reach.speed, 0.0) ** 2
    own = np.flatnonzero(np.isfinite(bears))
    for n in np.argsort(-energy, kind="stable").tolist():
        if energy[n] <= CRUSHED * bears[own].min():
            break
        meets = (own != n) & ((low[own] <= high[n]) & (low[n] <= high[own])).all(axis=1)
        ratio = np.where(meets, energy[n] / bears[own], 0.0)
        m = int(own[ratio.argmax()])
        if (worst := float(ratio.max())) > CRUSHED:
            hits, who = system.names[n], system.names[m]
            speed, stress = say(env.reach.speed[n], "m/s", 2), say(bears[m], "Pa", 2)
            return [
                Margin(
                    "yielding",
                    who,
                    worst,
                    CRUSHED,
                    "",
                    f"{hits} may hit {who} at {speed}: its energy by volume is {worst:.2g} of the stress {stress} at which {who} "
                    f"yields; above about {CRUSHED:g} cells where it lands may be crushed",
                    env.place(m, "yield-strain"),
                    "warning",
                    hint=f"write yield-strain {number(at_least(env.scene.solids[m].yield_strain * worst / CRUSHED))} or more, a "
                    f"larger elasticity, or a lower speed or density of {hits}",
                )
            ]
    return []


EFFECTS = (Yielding(),)
