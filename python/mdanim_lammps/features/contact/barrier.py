# SPDX-License-Identifier: GPL-2.0-only
"""Contact: a barrier between boundary and inner particles of objects whose boxes meet, Wcislo 1999, sec. 3.3."""

from __future__ import annotations

from functools import lru_cache
from math import ceil

import numpy as np

from ...bodies import all_held, kind_of
from ...effects.context import Context, Verdict
from ...effects.envelope import Envelope
from ...effects.fields import column
from ...effects.margin import Margin
from ...errors import Problem
from ...model.model import Layer
from ...reach import by, thrower_of
from ...scene.formatting import at_least, say
from .forms import Form, particle_stiffness, stiffness_told
from .narrow import narrow, slim_tips
from .pairs import largest_of_partners
from .planes import OR_ON_SURFACES, STIFFNESS, others
from .touching import REACH, THIN, WAY_NAMES, touching

TUNNEL = (0.5, 0.65, 0.8)
"""Closing speed over the wave speed from which a block goes through a clamped plate of 1, 2, 3 and more
cells (docs/stability.md)."""
GAP = column("reach", "m")
"""How far each particle is felt as a barrier."""
FARTHEST = 8.0
"""Reach over the spacing up to which the curvature of a plane is summed; longer ones occur beside far finer objects alone."""
NEAREST = "nearest"
"""In the vector of fix mdanim/barrier: the smallest distance of a pair over its reach in this run [-]."""
SOFTER = 2.0 / 3.0
"""With contact softer than its standard that speed falls with this power of ``contact-stiffness`` (docs/physics-contact.md)."""


@lru_cache(maxsize=16)
def plane_stiffness(reach: float) -> float:
    """Largest curvature that a particle meets over a square plane of barrier particles, in units of the pair's k.

    ``reach`` is the reach over the spacing of that plane. The Hessian of U = k rc^2/3 (1 - r/rc)^3, summed over the plane and
    all layers below it within reach, is scanned over all lateral offsets and over heights from 0.3 spacings up (surfaces 0.7 deep
    in each other) to where it falls; deeper than that the object is crushed anyway. Gives 1.61 at a reach of 1.6, and 0.223
    times the cube of long ones.
    """
    if reach > FARTHEST:
        return plane_stiffness(FARTHEST) * (reach / FARTHEST) ** 3
    lowest, step = 0.3, np.linspace(0.0, 0.5, 6)
    side, layers = max(3, ceil(reach + step[-1]) - 1), max(2, ceil(reach - lowest))
    around = np.arange(-side, side + 1)
    plane = np.stack(np.meshgrid(around, around, -np.arange(layers), indexing="ij"), -1).reshape(-1, 3)
    heights = [*np.linspace(lowest, 1.2, 19), *(np.linspace(1.2, 0.45 * reach, 30) if reach > 3.0 else [])]
    return max(_curvature(plane, step, height, reach) for height in heights)


def _curvature(plane: np.ndarray, step: np.ndarray, height: float, reach: float) -> float:
    """The same at one height, over offsets along both edges of the square."""
    probe = np.stack(np.meshgrid(step, step, [height], indexing="ij"), -1).reshape(-1, 1, 3)
    d = probe - plane
    r = np.linalg.norm(d, axis=-1)
    depth = np.maximum(0.0, 1.0 - r / reach)
    second, first = 2.0 * depth, -reach * depth**2 / r
    n = d / r[..., None]
    hessian = np.einsum("pa,pai,paj->pij", second - first, n, n) + first.sum(1)[:, None, None] * np.eye(3)
    return float(np.linalg.eigvalsh(hessian)[:, -1].max())


def barrier(fix: str, context: Context, thin: tuple[str, ...] = ("group thin type 4 8",)) -> list[str]:
    """Commands for a barrier of this name, with the columns ``stiffness`` and ``reach``; ``thin`` make the group of particles
    that are a barrier themselves, because there are none inside."""
    groups = ["group inner type 1 2 5 6", "group boundary type 3 4 7 8", *thin]
    words = [f"fix {fix} {context.pushed} mdanim/barrier boundary inner d_stiffness d_reach"]
    words += [f"thin thin {THIN!r}"] if (context.system.layer == Layer.THIN).any() else []
    return [*groups, " ".join([*words, *excluded(context)])]


def excluded(context: Context) -> list[str]:
    """Words for pairs of objects that never touch."""
    return [f"exclude {i + 1} {j + 1}" for i, j in context.passing]


def barrier_rate(context: Context, s: np.ndarray, reach: float) -> np.ndarray:
    """Its share in the bound, see `Effect.rate`: stiffness of each particle [N/m], shape (N,), and the largest reach [m]."""
    system = context.system
    partner = largest_of_partners(context, np.maximum.reduceat(s, system.first[:-1]))[system.object]
    k = np.divide(2.0 * s * partner, s + partner, out=np.zeros(len(s)), where=s > 0.0)
    over_spacing = float(reach / np.cbrt(system.cell_volume.min()))
    return 2.0 * plane_stiffness(round(over_spacing, 3)) * k / system.mass


class ObjectContact(Form):
    """Objects that push each other apart; subclasses have the laws of the two contact models (docs/physics-contact.md)."""

    name = "contact"
    order = 40
    fix = "contact"
    ledger = "contact"
    keeps_apart = presses = True
    if_off = "objects pass through each other"

    def called_for(self, scene, reach):
        moving = [s for s in scene.solids if not all_held(s)]
        if len(scene.solids) < 2:
            return Verdict(self.name, False, "one object" if scene.solids else "no objects")
        if not moving:
            return Verdict(self.name, False, "every object is held")
        if not reach.region.any_pair:
            ropes = sum(not kind_of(s).fills for s in scene.solids) > 1
            told = ", or ropes, which do not touch each other" if ropes else ""
            return Verdict(self.name, False, f"all that could meet is joined{told}")
        first, second, apart = reach.closest()
        if apart > 0.0:
            return Verdict(
                self.name,
                False,
                f"no two objects can come within reach: nearest are {first.name} and {second.name}, "
                f"with {say(apart, 'm')} to spare",
                second.spans.get("object"),
            )
        return Verdict(self.name, True, f"{first.name} and {second.name} may meet{self.told(scene)}", second.spans.get("object"))

    def told(self, scene) -> str:
        """Remarks of ``check`` on this contact."""
        return stiffness_told(scene)

    def gap(self, context):
        return REACH * context.system.spacing

    def margins(self, envelope):
        slender = [*narrow(envelope), *slim_tips(envelope)]
        return [*envelope.own_step("contact", envelope.rates[self.name]), *self._closing_speed(envelope), *slender]

    def tunnelling(self, envelope: Envelope) -> np.ndarray:
        """Closing speed over the wave speed from which each solid is passed through, shape (M,)."""
        return np.array(TUNNEL)[np.clip(np.rint(envelope.cells).astype(int), 1, len(TUNNEL)) - 1]

    def _closing_speed(self, envelope: Envelope) -> list[Margin]:
        """Speed at which each solid may meet another; none where nothing is passed through at any speed, as all is rigid."""
        system = envelope.system
        closing = envelope.reach.closing(envelope.reach.fall)
        # A held partner may be met at full speed, the softer of two is the one that is passed through.
        limit = self.tunnelling(envelope) * envelope.reach.wave
        factor = envelope.scene.control.contact_stiffness
        soft = factor < 1.0
        limit *= factor**SOFTER if soft else 1.0
        if not np.isfinite(limit).any():
            return []
        weakest = int(limit.argmin())
        fastest = int((closing / np.minimum(limit, limit[weakest])).argmax())
        value, most = float(closing[fastest]), float(min(limit[fastest], limit[weakest]))
        partner = "" if limit[fastest] <= limit[weakest] else f", in {system.names[weakest]}"
        thrower = thrower_of(envelope.reach.acting, fastest, value, others=True)
        usual = envelope.place(fastest, "velocity", "position")
        way_out = "write a lower speed, a higher elasticity, or a resolution of three cells across the thinnest part"
        told = Margin(
            "closing speed",
            system.names[fastest],
            value,
            most,
            "m/s",
            f"{system.names[fastest]} may meet another object at {say(value, 'm/s')}{by(thrower)}; "
            f"up to {say(most, 'm/s')}{partner} nothing passes through",
            envelope.scene.control.spans.get("contact-stiffness") if soft else thrower.span if thrower else usual,
            "warning" if value > most else "ok",
            hint="write contact-stiffness 1, or a lower speed"
            if soft
            else way_out.replace("write a lower speed", thrower.way_out)
            if thrower
            else way_out,
        )
        return [told]

    def acts_on(self, context):
        return len(context.system.names) > 1 and not context.system.held.all()


class BarrierContact(ObjectContact):
    """A barrier between boundary and inner particles: U(r) = k_c r_c^2/3 (1 - r/r_c)^3 [J] below the reach r_c [m], Wcislo 1999,
    sec. 3.3.

    k_c = 2 s_i s_j/(s_i + s_j) [N/m] with s = E h min(1, 2 n/8), where n of the 8 cells around a particle are filled
    (docs/physics-contact.md, "The barrier of the paper"; in the bound: "In the bound on the time step").
    """

    styles = (("fix", "mdanim/barrier"),)

    def clearance(self, first, second):
        thin = (first.layer == Layer.THIN).any() or (second.layer == Layer.THIN).any()
        return (THIN * REACH if thin else REACH - 1.0) * max(first.spacing, second.spacing)

    def columns(self, context):
        system = context.system
        return {STIFFNESS: particle_stiffness(context.scene, system), GAP: self.gap(context)[system.object]}

    def commands(self, context):
        return barrier(self.fix, context)

    def rate(self, context):
        system = context.system
        return barrier_rate(context, particle_stiffness(context.scene, system), REACH * system.spacing.max())

    def warnings(self, context):
        scene = context.scene
        passing = set(context.passing)
        found = touching(context.system, particle_stiffness(scene, context.system))
        found = [t for t in found if (min(t.first, t.second), max(t.first, t.second)) not in passing]
        if not found:
            return []
        t = found[0]
        first, second = scene.solids[t.first], scene.solids[t.second]
        # Boxes around what is turned overlap: there may be no gap to tell.
        gap = f"leave a gap of {say(at_least(t.gap, 3), 'm')}: " if t.gap > 0.0 else ""
        return [
            Problem(
                second.spans.get("position") or second.spans.get("object"),
                f"{second.name} starts within reach of {first.name}: contact holds {say(t.energy, 'J')} at the start and pushes "
                f"them apart{others(found, 'pairs')}",
                f"{gap}move {second.name} {WAY_NAMES[t.way]} by {say(at_least(t.move, 3), 'm')}; {OR_ON_SURFACES}",
                severity="warning",
            )
        ]

    def energy(self, readings):
        return readings.fix_scalar(self.fix)

    def penetration(self, readings):
        # A guard lies one spacing below its surface, so r = h means that surfaces touch; between lattice points, and for
        # thin objects, this overestimates.
        nearest = readings.fix_value(self.fix, NEAREST)
        return max(0.0, (1.0 / REACH - nearest) * REACH * float(readings.system.spacing.max()))
