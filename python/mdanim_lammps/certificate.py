# SPDX-License-Identifier: GPL-2.0-only
"""The certificate, before step 0: a bound on the time step, what sets it, the step chosen, and how far off every other limit is.

Leap-frog with lagged dashpots is stable while dt^2 K + 2 dt C < 4 M (energy argument in docs/physics-solids.md). With
K <= 2 blockdiag(D_i) and C <= 2 blockdiag(D'_i) this holds when dt^2 a_i + 2 dt b_i <= 4 for every particle, where
a_i = 2 lambda_max(D_i)/m_i and b_i = 2 lambda_max(D'_i)/m_i. Rigorous for springs, dashpots and walls; contact enters with
the largest curvature over a plane of guards on one side (effects/contact.py), and the step is half of the bound. Buoyancy
is a spring from each particle to the surface. Drag, of air or liquid, cannot make it unstable, only inaccurate: strong drag
is taken exponentially, see `strong_drag`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from fractions import Fraction

import numpy as np

from . import features
from .deprecated import OnceMethod
from .effects import Context
from .effects.envelope import Envelope
from .effects.margin import Margin
from .errors import Problem, RefusedError, SceneError, Span
from .model import shapes
from .records import dataclass
from .scene.formatting import estimate, number, say
from .scene.scene import Control, SceneRecord

WARN = 0.7
"""Time step over the bound above which large motion may blow up: the bound is that of small motion (docs/physics-solids.md)."""
STRONG = 0.5
"""phi = lambda dt / 2m, eq. (3.13), above which the implicit form is inaccurate: beyond 1 it reverses velocities every step."""
MOST_STEPS = 10**15
"""Largest number of steps of a run: more would take years."""
ROUNDED = 1e-3
"""Part of a frame by which a time may differ from that of a frame: 1.73333 s are 52 frames of 1/30 s."""
MOST_PARTS = 100
"""Steps of a frame that a last, shorter frame may ask for in any case."""
MOST_OBJECTS = 100
"""Objects whose own bound is told, the smallest first."""


@dataclass(frozen=True, slots=True)
class Certificate(OnceMethod):
    """The figures that are certified before step 0."""

    timestep: float
    """[s]"""
    bound: float
    """Largest stable time step [s]."""
    object: str
    """Object that sets the bound."""
    cause: str
    """Effect that contributes most there."""
    share: float
    """Its share in the bound there [-]."""
    steps_per_frame: int
    frames: int
    """Whole frames after the one at t = 0."""
    last_steps: int
    """Steps of a last, shorter frame; 0 when ``time`` is a whole number of frames."""
    span: Span | None
    """Scene line of what sets the bound."""
    margins: tuple[Margin, ...] = ()
    """The bound of each object, the smallest first, and every other limit that the scene has to keep."""
    notes: tuple[Problem, ...] = ()
    """Remarks that are not doubts, but may not be known, of severity ``note``."""

    @property
    def last_frame(self) -> int:
        """Number of the last frame; the one at t = 0 has 0."""
        return self.frames + (self.last_steps > 0)

    @property
    def lengths(self) -> tuple[int, ...]:
        """Steps to each frame after the one at t = 0: made when asked for, and as long as the run."""
        return (self.steps_per_frame,) * self.frames + ((self.last_steps,) if self.last_steps else ())

    @property
    def steps(self) -> int:
        """Steps of the whole run."""
        return self.steps_per_frame * self.frames + self.last_steps

    @property
    def fraction(self) -> float:
        """Time step over bound."""
        return self.timestep / self.bound

    def to_json(self) -> dict:
        """Plain data for certificate.json."""
        return {
            **asdict(self),
            "bound": self.bound if math.isfinite(self.bound) else None,
            "span": str(self.span) if self.span else None,
            "steps": self.steps,
            "fraction": self.fraction,
            "margins": [m.to_json() for m in self.margins],
            "notes": [{"message": n.message, "hint": n.hint, "place": str(n.span) if n.span else None} for n in self.notes],
        }

    def __str__(self) -> str:
        if not math.isfinite(self.bound):
            return f"dt {say(self.timestep, 's')}   nothing in the scene vibrates: every step is stable"
        return (
            f"dt {say(self.timestep, 's')} = {self.fraction:.2f} of the bound {say(self.bound, 's')}   "
            f"set by: {self.object}, {self.cause}"
        )


def certify(context: Context, *, allow_unstable: bool = False) -> Certificate:
    """Bound the time step of a scene and choose one that fits its frames.

    Raises RefusedError when ``control timestep`` is above the bound (unless ``allow_unstable``), and SceneError when the scene
    expects something behind the last whole frame of a ``time`` that no time step fits.
    """
    scene, system, on = context.scene, context.system, context.resolved.effects
    rates = {e.name: r for e in on if (r := e.rate(context)) is not None}
    drags = {e.name: r for e in on if (r := e.drag_rate(context)) is not None}
    total_rate = sum(rates.values(), np.zeros(system.particles))
    if own := [r for e in on if (r := e.own_rate(context)) is not None]:
        total_rate -= np.sum(own, axis=0) - np.max(own, axis=0)
    limit = stable_step(total_rate, sum(drags.values(), np.zeros(system.particles)))
    limit[system.held] = np.inf
    worst = int(np.argmin(limit)) if len(limit) else None  # a scene of liquid alone has no particles
    bound = math.inf if worst is None else float(limit[worst])
    # Where nothing vibrates any step integrates free fall exactly: one step per frame, or what liquid or scene say.
    causes = {} if worst is None else {name: r[worst] for name, r in rates.items()}
    if math.isfinite(bound):
        causes |= {name: 2.0 * r[worst] / bound for name, r in drags.items()}
    total = sum(causes.values())
    cause = max(causes, key=causes.get) if total else "nothing"
    setter = None if worst is None else int(system.object[worst])
    name = "nothing" if setter is None else system.names[setter]

    asked, fraction = scene.control.timestep, scene.control.accuracy.fraction
    if asked is not None and asked > bound * (1.0 + 1e-12) and not allow_unstable:
        problem = Problem(
            scene.control.spans.get("timestep"),
            f"timestep {say(asked, 's', 4)} is above the certified bound {say(bound, 's', 4)}, set by {name} ({cause})",
            f"write 'timestep auto' ({say(fraction * bound, 's')}), or insist with --allow-unstable",
        )
        raise RefusedError(str(problem))
    longest = min([fraction * bound, *(e.max_timestep(context) for e in on)]) if asked is None else asked
    per_frame, frames, last = fit_steps(scene, longest)
    if (steps := per_frame * frames + last) > MOST_STEPS:
        problem = Problem(
            scene.control.spans.get("timestep") or scene.control.spans.get("time"),
            f"time {say(scene.control.time, 's')} is {estimate(steps)} steps of {say(longest, 's')}"
            + ("" if asked else f", set by {name} ({cause})"),
            "write a shorter time or a longer time step" if asked else "write a shorter time, or a softer or less damped object",
        )
        raise RefusedError(str(problem))
    timestep = 1.0 / (scene.control.frames * per_frame)
    early, envelope = _end(scene, frames, last), Envelope(context, rates, timestep)
    return Certificate(
        timestep=timestep,
        bound=bound,
        object=name,
        cause=cause,
        share=float(causes[cause] / total) if total else 0.0,
        steps_per_frame=per_frame,
        frames=frames,
        last_steps=last,
        span=None if setter is None else scene.solids[setter].spans.get("elasticity"),
        margins=tuple(_margins(envelope, limit)),
        notes=(*early, *_notes(envelope)),
    )


def stable_step(stiff: np.ndarray, drag: np.ndarray) -> np.ndarray:
    """Largest dt with dt^2 a + 2 dt b <= 4, for a [1/s^2] and b [1/s] of any shape; infinite where both are 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.where(stiff > 0.0, (np.sqrt(drag**2 + 4.0 * stiff) - drag) / stiff, 2.0 / drag)
        # The difference loses all digits where dashpots are strong.
        root = np.where(drag**2 > 4.0 * stiff, 4.0 / (np.sqrt(drag**2 + 4.0 * stiff) + drag), root)
    return np.where((stiff > 0.0) | (drag > 0.0), root, np.inf)


def fit_steps(scene: SceneRecord, longest: float) -> tuple[int, int, int]:
    """Steps per frame, whole frames, and steps of a last shorter frame, so that one dt <= ``longest`` meets them all.

    ``time * frames`` = p/q in lowest terms asks for a multiple of q steps per frame. Where q is so large that it would shorten
    the step by more than a factor of four, the run ends with the last whole frame.
    """
    control = scene.control
    least = max(1, math.ceil(1.0 / (control.frames * longest) * (1.0 - 1e-12))) if longest < math.inf else 1
    ratio = _in_frames(control)
    if ratio is None or ratio.denominator > 4 * least + MOST_PARTS:
        return least, whole_frames(control), 0
    q = ratio.denominator
    per_frame = q * math.ceil(least / q)
    frames, rest = divmod(ratio.numerator, q)
    return per_frame, frames, rest * per_frame // q


def _in_frames(control: Control) -> Fraction | None:
    """The time of a scene over that of a frame; None where it is not a fraction of small numbers."""
    ratio = Fraction(control.time * control.frames).limit_denominator(10_000)
    return None if abs(float(ratio) - control.time * control.frames) > 1e-9 * float(ratio or 1) else ratio


def whole_frames(control: Control) -> int:
    """Whole frames in the time of a scene."""
    return math.floor(control.time * control.frames + ROUNDED)


def may_end_early(control: Control) -> bool:
    """Whether there are time steps for which a run ends with the last whole frame."""
    ratio = _in_frames(control)
    return ratio is None or ratio.denominator > MOST_PARTS


def _end(scene: SceneRecord, frames: int, last: int) -> list[Problem]:
    """The problem that a run of ``frames`` whole frames, and of the ``last`` steps of a last one, ends before the time of the
    scene.

    Raises SceneError where the scene expects something later.
    """
    control = scene.control
    if last or frames + ROUNDED >= control.time * control.frames:
        return []
    end = f"{number(frames / control.frames, 6)} s"
    late = [e for e in scene.expects if e.time is not None and e.time > frames / control.frames * (1.0 + 1e-9)]
    cause = f"is after the last whole frame, at {end}: no time step fits the time {number(control.time, 6)} s"
    if late:
        raise SceneError(
            [Problem(e.span, f"{number(e.time, 6)} s {cause}", "write an earlier time, or a longer one") for e in late]
        )
    return [
        Problem(
            control.spans.get("time"),
            f"time {number(control.time, 6)} s is {number(control.time * control.frames, 6)} frames at "
            f"{number(control.frames, 6)} fps, which no time step fits: the run ends with frame {frames}, at {end}",
            f"write 'time {end}'",
            severity="note",
        )
    ]


def strong_drag(context: Context, timestep: float) -> float:
    """Largest phi of the drag that all effects make together, when it is above STRONG, else 0."""
    frictions = [f for e in context.resolved.effects if (f := e.friction(context)) is not None]
    phi = float((sum(frictions) / context.system.mass).max()) * timestep / 2.0 if frictions else 0.0
    return phi if phi > STRONG else 0.0


def warnings(certificate: Certificate) -> list[Problem]:
    """A problem for every limit that is passed, in the order of the margins; one for all objects that pass the same."""
    found: dict[str, Problem] = {}
    for m in certificate.margins:
        if m.severity != "ok":
            found.setdefault(m.name, Problem(m.span, m.text, m.hint, severity="warning"))
    return list(found.values())


def margin_lines(certificate: Certificate) -> list[str]:
    """Lines for ``check``: every limit that is passed, and one line for all that are kept."""
    kept: dict[str, Margin] = {}
    lines = []
    for m in certificate.margins:
        if m.severity != "ok":
            place = f"  [{m.span}]" if m.span else ""
            lines.append(
                f"  {m.severity:<8} {m.name:<14} {say(m.value, m.unit)} {'<' if m.least else '>'} {say(m.limit, m.unit)}"
                + f"  {m.object}{place}"
            )
        elif m.used >= kept.get(m.name, m).used:
            kept[m.name] = m
    lines.append("  kept     " + (", ".join(f"{m.name} {100 * m.used:.0f} %" for m in kept.values()) or "no limit"))
    return lines


def note_lines(certificate: Certificate) -> list[str]:
    """Lines for ``check``: what may not be known, and what to write."""
    told = [(n, f"{n.message}; {n.hint}" if n.hint else n.message) for n in certificate.notes]
    return [f"  {n.severity:<8} {words}" + (f"  [{n.span}]" if n.span else "") for n, words in told]


def _margins(envelope: Envelope, limit: np.ndarray) -> list[Margin]:
    """The margins, the bound of the objects first; ``limit`` is the largest stable step of each particle [s], shape (N,)."""
    found = [*_bounds(envelope, limit), *_drag(envelope)]
    return found + [m for e in envelope.on for m in e.margins(envelope)] if envelope.reach.moving.any() else found


def _notes(envelope: Envelope) -> list[Problem]:
    """Changes to surfaces of files; notes of the effects that are on, and the advice of all features, where something can
    move, or a liquid."""
    mended = list(_mended(envelope))
    if not envelope.reach.moving.any() and envelope.context.grid is None:
        return mended
    return [
        *mended,
        *(n for e in envelope.on for n in e.notes(envelope)),
        *(n for advice in features.facets("advice") for n in advice.notes(envelope)),
    ]


def _mended(envelope: Envelope) -> Iterator[Problem]:
    """A note for each surface that is not as its file has it."""
    first = {}
    for m, solid in enumerate(envelope.scene.solids):
        first.setdefault(solid.shape, m)
    for shape, m in first.items():
        if done := shapes.mended(shape):
            cause = f"{envelope.system.names[m]}: in {shape.path.name} {done}; it encloses {say(shapes.volume(shape), 'm^3')}"
            yield Problem(envelope.place(m, "shape"), cause, "look at its picture: mdanim-lammps picture", severity="note")


def _bounds(env: Envelope, limit: np.ndarray) -> list[Margin]:
    system = env.system
    own = np.minimum.reduceat(limit, system.first[:-1])
    own = np.where(np.isfinite(own), own, np.inf)
    order = np.argsort(own, kind="stable")[:MOST_OBJECTS]
    margins = []
    for m in order[np.isfinite(own[order])]:
        used = env.dt / own[m]
        severity = "refused" if used > 1.0 + 1e-12 else "warning" if used > WARN * (1.0 + 1e-9) else "ok"
        margins.append(
            Margin(
                "time step",
                system.names[m],
                env.dt,
                float(own[m]),
                "s",
                f"the time step {say(env.dt, 's')} is {used:.2f} of what {system.names[m]} bears, {say(own[m], 's')}; "
                f"above {WARN:g} large motion may blow up, above 1 any",
                env.scene.control.spans.get("timestep") or env.place(m, "elasticity"),
                severity,
                hint="write 'timestep auto'",
            )
        )
    return margins


def _drag(env: Envelope) -> list[Margin]:
    """phi of air and liquid together, as an immersed particle feels it."""
    system = env.system
    frictions = {e.name: f for e in env.on if (f := e.friction(env.context)) is not None}
    if not frictions:
        return []
    phi = sum(frictions.values()) / system.mass * env.dt / 2.0
    i = int(np.argmax(phi))
    m = int(system.object[i])
    strong = bool(phi[i] > STRONG)
    kinds = " and ".join(name.replace("-", " ") for name in frictions)
    return [
        Margin(
            "drag",
            system.names[m],
            float(phi[i]),
            STRONG,
            "",
            f"{kinds} is {'strong' if strong else 'weak'} for this time step "
            f"(phi = {number(phi[i], 2)} {'>' if strong else '<='} {STRONG}, eq. (3.13))",
            env.context.resolved.verdicts[list(frictions)[-1]].span,
            "warning" if strong else "ok",
            hint="the exponential form is used instead of the paper's implicit one: same terminal speed, no overshoot",
        )
    ]
