# SPDX-License-Identifier: GPL-2.0-only
"""Springs that yield, by ``fix mdanim/yield`` (docs/physics-yielding.md)."""

from __future__ import annotations

import numpy as np

from ...effects.context import Context, Verdict
from ...effects.effect import Effect
from ...effects.envelope import Envelope
from ...effects.fields import column
from ...effects.margin import Margin
from ...model.springs import dashpots
from ...scene.formatting import at_least, number, say
from ..springs.effect import spring_norm
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
POISSON = 0.25
"""Poisson's ratio of lattices (docs/physics-solids.md)."""
LOST = "yielding"
"""Column of the ledger: work of springs that yield."""


class Yielding(Effect):
    """F = -k (r - L - p), p = r - L -+ b where +-(r - L - p) > b (docs/physics-yielding.md)."""

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
        return {GROWN: np.zeros(len(context.system.spring)), BEARS: borne(context)}

    def rate(self, context):
        return turned(context, context.system.stiffness)

    def drag_rate(self, context):
        ratio = context.damping_ratio
        return turned(context, dashpots(context.system, ratio)) if ratio.any() else None

    def margins(self, envelope):
        return blow(envelope)

    def commands(self, context):
        return [f"fix {self.fix} mobile mdanim/yield grown {GROWN.name} bears {BEARS.name}"]

    def losses(self, scene):
        return (LOST,)

    def lost(self, readings):
        return {LOST: readings.fix_value(self.fix, "energy")}

    def clocks(self, readings):
        return {self.name: readings.fix_seconds(self.fix)}


def borne(context: Context) -> np.ndarray:
    """Stretch that springs bear [m], shape (S,): that which they have in a body that is pulled along one of its own axes until it
    is longer by e, of the three the largest. So all of them yield together, and a bar bears E e."""
    system, found = context.system, np.zeros(len(context.system.spring))
    for m, solid in enumerate(context.solids):
        if yields(solid):
            own = system.springs_of(m)
            i, j = system.spring[own].T
            along = (system.position[i] - system.position[j]) @ np.array(solid.rotation)
            square = (along**2).max(axis=1) / (along**2).sum(axis=1)
            found[own] = solid.yield_strain * ((1.0 + POISSON) * square - POISSON) * system.rest[own]
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
    """The energy of motion of each volume beside E e, which is what each volume takes that is pressed to nothing."""
    own = np.array([yields(solid) for solid in env.scene.solids], bool) & env.reach.moving
    if not own.any() or (len(own) == 1 and not env.planes):
        return []
    system = env.system
    bears = system.young * np.array([solid.yield_strain or np.inf for solid in env.scene.solids])
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
