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
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from fractions import Fraction

import numpy as np

from .effects import EFFECTS, Effect, Verdict
from .effects.liquid import EVERY, STRIDE
from .errors import Problem, RefusedError, SceneError, Span
from .model.basin import liquid_level
from .model.cells import TooThin, end_share, fill_cells
from .model.shapes import thickness
from .model.system import System
from .scene.formatting import at_least, estimate, number, say
from .scene.scene import Accuracy, Ellipsoid, Scene, Shape, Sphere

WARN = 0.7
"""Time step over the bound above which large motion may blow up: the bound is that of small motion (docs/physics-solids.md)."""
STRONG = 0.5
"""phi = lambda dt / 2m, eq. (3.13), above which the implicit form is no good: beyond 1 it turns velocities round every step."""
FOLDS = 0.2
"""Speed of an impact over the wave speed above which a lattice folds up and stays crumpled (docs/physics-solids.md)."""
FOLDS_ON_END, FOLDS_POWER = 0.5, 0.45
"""The same of a ball or ellipsoid that lands on ground or walls, over a power of the part of its cells that its smallest end has:
these few bear the blow of all (docs/physics-solids.md)."""
CRUSH = 0.2
"""Load over Young's modulus above which a lattice is crushed (docs/physics-solids.md)."""
THINNEST = 2
"""Fewest cells across: one cell is 1.9 times too stiff in bending (docs/physics-solids.md)."""
TUNNEL = (0.5, 0.65, 0.8)
"""Closing speed over the wave speed from which a block goes through a clamped plate of 1, 2, 3 and more
cells (docs/stability.md)."""
SOFTER = 2.0 / 3.0
"""With contact softer than its standard that speed falls with this power of ``contact-stiffness`` (docs/physics-contact.md)."""
SWEEPS = 4
"""Fewest sweeps of the automaton for each cell that the fastest solid travels; 8 are better (docs/physics-liquid.md)."""
MOST_FRAMES, MOST_STEPS = 10**7, 10**15
"""Frames and steps of a run at most: every frame has a row of the ledger in memory, and so many steps take years."""
MOST_OBJECTS = 100
"""Objects whose own bound is told, the smallest first."""


@dataclass(frozen=True, slots=True)
class Margin:
    """A quantity beside its limit, for the object where it comes closest."""

    name: str
    """``time step``, ``contact``, ``load`` ..."""
    object: str
    """Name of the object."""
    value: float
    limit: float
    unit: str
    """Of value and limit; empty for ratios."""
    text: str
    """Both in a sentence."""
    span: Span | None
    """Scene line of what would change it."""
    severity: str
    """``ok``, ``warning`` or ``refused``."""
    least: bool = False
    """Whether the value is to be above the limit, not below."""
    hint: str = ""
    """What to write instead."""

    @property
    def used(self) -> float:
        """Part of the limit that is used [-]: more than 1 is beyond it."""
        if self.least:
            return self.limit / self.value if self.value else math.inf
        return self.value / self.limit

    def to_json(self) -> dict:
        """Plain data for certificate.json."""
        numbers = {
            k: v if math.isfinite(v) else None for k, v in (("value", self.value), ("limit", self.limit), ("used", self.used))
        }
        return {**asdict(self), **numbers, "span": str(self.span) if self.span else None}


@dataclass(frozen=True, slots=True)
class Certificate:
    """What is certified before step 0."""

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

    @property
    def lengths(self) -> tuple[int, ...]:
        """Steps to each frame after the one at t = 0."""
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
        }

    def __str__(self) -> str:
        if not math.isfinite(self.bound):
            return f"dt {say(self.timestep, 's')}   nothing in the scene vibrates: every step is stable"
        return (
            f"dt {say(self.timestep, 's')} = {self.fraction:.2f} of the bound {say(self.bound, 's')}   "
            f"set by: {self.object}, {self.cause}"
        )


def certify(scene: Scene, system: System, verdicts: dict[str, Verdict], *, allow_unstable: bool = False) -> Certificate:
    """Bound the time step of a scene and choose one that fits its frames.

    Raises RefusedError when ``control timestep`` is above the bound (unless ``allow_unstable``), and SceneError when
    ``time`` and ``frames`` cannot be met by one time step.
    """
    on = {e.name: e for e in EFFECTS if verdicts[e.name].on}
    rates = {name: r for name, e in on.items() if (r := e.rate(scene, system)) is not None}
    drags = {name: r for name, e in on.items() if (r := e.drag_rate(scene, system)) is not None}
    limit = stable_step(sum(rates.values(), np.zeros(system.particles)), sum(drags.values(), np.zeros(system.particles)))
    limit[system.held] = np.inf
    worst = int(np.argmin(limit))
    bound = float(limit[worst])
    # Where nothing vibrates any step integrates free fall exactly: one step per frame, or what liquid or scene say.
    causes = {name: r[worst] for name, r in rates.items()}
    if math.isfinite(bound):
        causes |= {name: 2.0 * r[worst] / bound for name, r in drags.items()}
    total = sum(causes.values())
    cause = max(causes, key=causes.get) if total else "nothing"
    name = system.names[system.object[worst]]

    asked, fraction = scene.control.timestep, accuracy_fraction(scene)
    if asked is not None and asked > bound * (1.0 + 1e-12) and not allow_unstable:
        problem = Problem(
            scene.control.spans.get("timestep"),
            f"timestep {say(asked, 's', 4)} is above the certified bound {say(bound, 's', 4)}, set by {name} ({cause})",
            f"write 'timestep auto' ({say(fraction * bound, 's')}), or insist with --allow-unstable",
        )
        raise RefusedError(str(problem))
    longest = min([fraction * bound, *(e.pace(scene, system) for e in on.values())]) if asked is None else asked
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
    return Certificate(
        timestep=timestep,
        bound=bound,
        object=name,
        cause=cause,
        share=float(causes[cause] / total) if total else 0.0,
        steps_per_frame=per_frame,
        frames=frames,
        last_steps=last,
        span=scene.solids[system.object[worst]].spans.get("elasticity"),
        margins=tuple(_Margins(scene, system, on, timestep).all(limit, rates)),
    )


def accuracy_fraction(scene: Scene) -> float:
    """Time step over the bound that the scene's accuracy asks of ``timestep auto``; a target error counts as balanced."""
    accuracy = scene.control.accuracy
    return (accuracy if isinstance(accuracy, Accuracy) else Accuracy.BALANCED).fraction


def stable_step(stiff: np.ndarray, drag: np.ndarray) -> np.ndarray:
    """Largest dt with dt^2 a + 2 dt b <= 4, for a [1/s^2] and b [1/s] of any shape; infinite where both are 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.where(stiff > 0.0, (np.sqrt(drag**2 + 4.0 * stiff) - drag) / stiff, 2.0 / drag)
        # The difference loses all digits where dashpots are strong.
        root = np.where(drag**2 > 4.0 * stiff, 4.0 / (np.sqrt(drag**2 + 4.0 * stiff) + drag), root)
    return np.where((stiff > 0.0) | (drag > 0.0), root, np.inf)


def fit_steps(scene: Scene, longest: float) -> tuple[int, int, int]:
    """Steps per frame, whole frames, and steps of a last shorter frame, so that one dt <= ``longest`` meets them all.

    ``time * frames`` = p/q in lowest terms asks for a multiple of q steps per frame. Raises SceneError when q is so large
    that it would shorten the step by more than a factor of four.
    """
    control = scene.control
    least = max(1, math.ceil(1.0 / (control.frames * longest) * (1.0 - 1e-12))) if longest < math.inf else 1
    ratio = Fraction(control.time * control.frames).limit_denominator(10_000)
    if abs(float(ratio) - control.time * control.frames) > 1e-9 * float(ratio or 1) or ratio.denominator > 4 * least + 100:
        whole = max(1, round(control.time * control.frames))
        raise SceneError(
            [
                Problem(
                    control.spans.get("time"),
                    f"time {number(control.time, 6)} s is {number(control.time * control.frames, 6)} frames at "
                    f"{number(control.frames, 6)} fps: "
                    "no time step fits both",
                    f"try 'time {number(whole / control.frames, 6)} s' ({whole} frames)",
                )
            ]
        )
    if ratio.numerator / ratio.denominator > MOST_FRAMES:
        raise SceneError(
            [
                Problem(
                    control.spans.get("time"),
                    f"time {number(control.time)} s is {estimate(control.time * control.frames)} frames at "
                    f"{number(control.frames)} fps; {estimate(MOST_FRAMES)} are the most",
                    f"write a shorter time, or at most {number(MOST_FRAMES / control.time)} frames a second",
                )
            ]
        )
    q = ratio.denominator
    per_frame = q * math.ceil(least / q)
    frames, rest = divmod(ratio.numerator, q)
    return per_frame, frames, rest * per_frame // q


def strong_drag(scene: Scene, system: System, effects: Iterable[Effect], timestep: float) -> float:
    """Largest phi of the drag that these effects make, all together, when it is above STRONG, else 0."""
    frictions = [f for e in effects if (f := e.friction(scene, system)) is not None]
    phi = float((sum(frictions) / system.mass).max()) * timestep / 2.0 if frictions else 0.0
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


def wave_speed(system: System) -> np.ndarray:
    """Speed of longitudinal waves in each solid, sqrt(1.2 E / rho) [m/s], shape (M,)."""
    density = system.mass_of / (np.add.reduceat(system.share, system.first[:-1]) * system.cell_volume)
    return np.sqrt(1.2 * system.young / density)


class _Margins:
    """Every limit of a scene at a time step."""

    def __init__(self, scene: Scene, system: System, on: dict[str, Effect], timestep: float):
        self.scene, self.system, self.on, self.dt = scene, system, on, timestep
        self.moving = ~system.still
        """Solids of which something can move, bool, shape (M,)."""
        self.wave = wave_speed(system)
        self.speed = self._speed(self._fall())
        """Largest speed that each solid may reach by its start and its fall [m/s], shape (M,)."""
        self.cells = self._cells()
        """Cells across the thinnest part of each solid [-], shape (M,)."""

    def all(self, limit: np.ndarray, rates: dict[str, np.ndarray]) -> list[Margin]:
        """The margins, the bound of the objects first; ``limit`` is the largest stable step of each particle [s], shape (N,)."""
        found = [*self._bounds(limit), *self._contact_and_wall(rates), *self._drag()]
        if not self.moving.any():
            return found
        if "springs" in self.on:
            found += [self._amplitude(), *self._load(), self._thinnest()]
        return found + self._closing() + self._sweeps()

    def _of(self, m: int, *keywords: str) -> Span | None:
        """Where the first of these keywords of a solid stands; its name where there is none."""
        spans = self.scene.solids[m].spans
        return next((spans[k] for k in (*keywords, "object") if k in spans), None)

    # --- the time step --------------------------------------------------------------------------------------------

    def _bounds(self, limit: np.ndarray) -> list[Margin]:
        system = self.system
        own = np.minimum.reduceat(limit, system.first[:-1])
        own = np.where(np.isfinite(own), own, np.inf)
        order = np.argsort(own, kind="stable")[:MOST_OBJECTS]
        margins = []
        for m in order[np.isfinite(own[order])]:
            used = self.dt / own[m]
            severity = "refused" if used > 1.0 + 1e-12 else "warning" if used > WARN * (1.0 + 1e-9) else "ok"
            margins.append(
                Margin(
                    "time step",
                    system.names[m],
                    self.dt,
                    float(own[m]),
                    "s",
                    f"the time step {say(self.dt, 's')} is {used:.2f} of what {system.names[m]} bears, {say(own[m], 's')}; "
                    f"above {WARN:g} large motion may blow up, above 1 any",
                    self.scene.control.spans.get("timestep") or self._of(m, "elasticity"),
                    severity,
                    hint="write 'timestep auto'",
                )
            )
        return margins

    def _contact_and_wall(self, rates: dict[str, np.ndarray]) -> list[Margin]:
        """What contact and walls alone would bear."""
        walls = [rates[name] for name in ("ground", "walls", "basin") if name in rates]
        margins = []
        for name, rate in (("contact", rates.get("contact")), ("wall", np.maximum.reduce(walls) if walls else None)):
            if rate is None or not np.any(free := np.where(self.system.held, 0.0, rate)):
                continue
            i = int(np.argmax(free))
            m = int(self.system.object[i])
            alone = 2.0 / math.sqrt(free[i])
            margins.append(
                Margin(
                    name,
                    self.system.names[m],
                    self.dt,
                    alone,
                    "s",
                    f"{name} alone would bear a time step of {say(alone, 's')} at {self.system.names[m]}",
                    self._of(m, "elasticity"),
                    "refused" if self.dt > alone * (1.0 + 1e-12) else "ok",
                    hint="write 'timestep auto'",
                )
            )
        return margins

    def _drag(self) -> list[Margin]:
        """phi of air and liquid together, as an immersed particle feels it."""
        system = self.system
        frictions = {name: f for name, e in self.on.items() if (f := e.friction(self.scene, system)) is not None}
        if not frictions:
            return []
        phi = sum(frictions.values()) / system.mass * self.dt / 2.0
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
                self.on[list(frictions)[-1]].called_for(self.scene).span,
                "warning" if strong else "ok",
                hint="the exponential form is used instead of the paper's implicit one: same terminal speed, no overshoot",
            )
        ]

    # --- impacts --------------------------------------------------------------------------------------------------

    def _speed(self, fall: np.ndarray) -> np.ndarray:
        """The start's speed, with that of a fall [m], shape (M,)."""
        start = np.maximum.reduceat((self.system.velocity**2).sum(1), self.system.first[:-1])
        return np.where(self.moving, np.sqrt(np.maximum(0.0, start + 2.0 * self._g() * fall)), 0.0)

    def _g(self) -> float:
        return max(0.0, -self.scene.gravity[2]) if "gravity" in self.on else 0.0

    def _fall(self) -> np.ndarray:
        """Height of each solid's fall [m], shape (M,), down to the ground, the floor of the basin, or the lowest object.

        As if through air: in a liquid, heights count by what it leaves of the weight. Below the surface a light solid gains
        height; where there are others it may meet them at the surface already.
        """
        scene, system = self.scene, self.system
        bottom = np.minimum.reduceat(system.position[:, 2], system.first[:-1])
        floors = [z for z in (scene.ground, scene.liquid and scene.liquid.low[2]) if z is not None]
        floor = min([bottom.min(), *floors])
        if "buoyancy" not in self.on:
            return bottom - floor
        surface = liquid_level(scene.liquid)
        in_air, in_liquid = np.maximum(0.0, bottom - surface), np.minimum(bottom, surface) - floor
        weight = self._weight_left()
        return in_air + in_liquid * (weight if len(system.names) == 1 else np.maximum(0.0, weight))

    def _weight_left(self) -> np.ndarray:
        """What the liquid leaves of each solid's weight when it is immersed, over its weight; below 0 where it floats,
        shape (M,)."""
        if "buoyancy" not in self.on:
            return np.ones(len(self.system.names))
        volume = np.add.reduceat(self.system.volume, self.system.first[:-1])
        return 1.0 - self.scene.liquid.density * volume / self.system.mass_of

    def _amplitude(self) -> Margin:
        scene, system = self.scene, self.system
        meets = len(system.names) > 1 or any(x is not None for x in (scene.ground, scene.walls, scene.liquid))
        ratio = np.where(meets, self.speed / self.wave, 0.0)
        hard = not self.on.keys().isdisjoint(("ground", "walls")) and "liquid" not in self.on
        spot = self._spots() if hard else np.full(len(ratio), np.inf)
        limit = np.minimum(FOLDS, spot)
        m = int((ratio / limit).argmax())
        folds = ratio > limit
        others = int(folds.sum()) - 1
        enough = system.young[m] * (ratio[m] / limit[m]) ** 2
        what, coarser = "a soft object folds up", ""
        if spot[m] < FOLDS:
            what = f"one of {number(self.cells[m], 2)} cells across folds up at the spot where it lands"
            h = float(np.cbrt(system.cell_volume[m]))
            if ratio[m] < FOLDS and (h := _coarser(scene.solids[m].shape, h, float(ratio[m]))):
                coarser = f", or resolution {say(h, 'm')}"
        return Margin(
            "amplitude",
            system.names[m],
            float(ratio[m]),
            float(limit[m]),
            "",
            f"{system.names[m]}{f' and {others} more' if others > 0 else ''} may hit at {say(self.speed[m], 'm/s', 2)}, "
            f"{ratio[m]:.2f} of the wave speed {say(self.wave[m], 'm/s', 2)}; "
            f"above about {number(limit[m], 2)} {what} and stays crumpled",
            self._of(m, "elasticity"),
            "warning" if folds[m] else "ok",
            hint=f"write elasticity {say(at_least(enough), 'Pa')} or more{coarser}, or a lower density, height or speed",
        )

    def _spots(self) -> np.ndarray:
        """Speed of a landing on the smallest end, over the wave speed, that folds it up; infinite for what is not round,
        shape (M,)."""
        system, known = self.system, {}
        spots = np.full(len(system.names), np.inf)
        balls = [m for m, s in enumerate(self.scene.solids) if self.moving[m] and isinstance(s.shape, (Sphere, Ellipsoid))]
        first = np.searchsorted(system.hexahedron[:, 0], system.first)
        for m in balls:
            key = self.scene.solids[m].shape, float(system.cell_volume[m])
            if key not in known:
                middle = system.position[system.hexahedron[first[m] : first[m + 1]]].mean(axis=1)
                middle = middle @ np.array(self.scene.solids[m].rotation)
                place = np.rint((middle - middle.min(axis=0)) / np.cbrt(system.cell_volume[m])).astype(int)  # voxels are cubes
                filled = np.zeros(place.max(axis=0) + 1, bool)
                filled[tuple(place.T)] = True
                known[key] = folds_on_end(filled)
            spots[m] = known[key]
        return spots

    def _closing(self) -> list[Margin]:
        """Speed at which each solid may meet another: both fall alike, so only the start tells them apart,
        until one has landed."""
        if "contact" not in self.on:
            return []
        system = self.system
        low, high = system.bounds(system.velocity)
        apart = np.maximum(high - _least_of_others(low), -_least_of_others(-high) - low)
        apart = np.sqrt((np.maximum(apart, 0.0) ** 2).sum(1))
        closing = np.where(self.moving, np.sqrt(apart**2 + 2.0 * self._g() * np.maximum(0.0, self._fall())), 0.0)
        # A held partner may be met at full speed, the softer of two is the one that is passed through.
        limit = np.array(TUNNEL)[np.clip(np.rint(self.cells).astype(int), 1, len(TUNNEL)) - 1] * self.wave
        soft = system.contact_factor < 1.0
        limit *= system.contact_factor**SOFTER if soft else 1.0
        weakest = int(limit.argmin())
        fastest = int((closing / np.minimum(limit, limit[weakest])).argmax())
        value, most = float(closing[fastest]), float(min(limit[fastest], limit[weakest]))
        partner = "" if limit[fastest] <= limit[weakest] else f", in {system.names[weakest]}"
        return [
            Margin(
                "closing speed",
                system.names[fastest],
                value,
                most,
                "m/s",
                f"{system.names[fastest]} may meet another object at {say(value, 'm/s')}; "
                f"up to {say(most, 'm/s')}{partner} nothing passes through",
                self.scene.control.spans.get("contact-stiffness") if soft else self._of(fastest, "velocity", "position"),
                "warning" if value > most else "ok",
                hint="write contact-stiffness 1, or a lower speed"
                if soft
                else "write a lower speed, a higher elasticity, or a resolution of three cells across the thinnest part",
            )
        ]

    # --- load and thickness ---------------------------------------------------------------------------------------

    def _load(self) -> list[Margin]:
        g = self._g()
        if not g:
            return []
        system = self.system
        stress = self._stress(g)
        ratio = np.where(self.moving, stress / (CRUSH * system.young), 0.0)
        m = int(ratio.argmax())
        strength = CRUSH * system.young[m]
        return [
            Margin(
                "load",
                system.names[m],
                float(stress[m]),
                float(strength),
                "Pa",
                f"{system.names[m]} bears about {say(stress[m], 'Pa')} at its foot by its weight and by what stands above it at "
                f"the start, {ratio[m]:.2f} of its crush strength 0.2 E = {say(strength, 'Pa')} "
                "(an estimate: evenly spread, at rest)",
                self._of(m, "elasticity"),
                "warning" if ratio[m] > 1.0 else "ok",
                hint=f"write elasticity {say(at_least(system.young[m] * ratio[m] * 1.5), 'Pa')} or more, "
                "or a lower density or height",
            )
        ]

    def _stress(self, g: float) -> np.ndarray:
        """rho g H of each solid and of the part of others that stands above it, less buoyancy [Pa], shape (M,)."""
        system = self.system
        low, high = system.bounds(system.position)
        size = np.maximum(high - low, 1e-300)
        weight = system.mass_of * g * np.maximum(0.0, self._weight_left())
        floor = size[:, 0] * size[:, 1]
        above = np.zeros(len(weight))
        for start in range(0, len(weight), 256):  # the table of all pairs would be too large for a crowd
            part = slice(start, start + 256)
            wide = [
                np.minimum(high[part, None, a], high[None, :, a]) - np.maximum(low[part, None, a], low[None, :, a])
                for a in (0, 1)
            ]
            over = np.maximum(wide[0], 0.0) * np.maximum(wide[1], 0.0) / floor
            over[low[None, :, 2] < high[part, None, 2] - 0.25 * size[part, None, 2]] = 0.0
            above[part] = over @ weight
        volume = np.add.reduceat(system.volume, system.first[:-1])
        return (weight + above) * size[:, 2] / volume

    def _cells(self) -> np.ndarray:
        system, known = self.system, {}
        thin = np.array(
            [known[s.shape] if s.shape in known else known.setdefault(s.shape, thickness(s.shape)) for s in self.scene.solids]
        )
        return thin / np.cbrt(system.cell_volume)

    def _thinnest(self) -> Margin:
        cells = np.where(self.moving, self.cells, np.inf)
        m = int(cells.argmin())
        few = round(float(cells[m])) < THINNEST
        h = float(np.cbrt(self.system.cell_volume[m]))
        return Margin(
            "thinnest part",
            self.system.names[m],
            float(cells[m]),
            THINNEST,
            "cells",
            f"{self.system.names[m]} is {number(cells[m], 2)} cells thin; "
            "one cell is 1.9 times too stiff in bending, two are not",
            self._of(m, "shape"),
            "warning" if few else "ok",
            least=True,
            hint=f"write resolution {say(0.5 * h * cells[m], 'm')} for two cells",
        )

    # --- liquid ---------------------------------------------------------------------------------------------------

    def _sweeps(self) -> list[Margin]:
        """Sweeps for each cell that the fastest solid travels: it may go on for EVERY steps before the fix looks."""
        if "liquid" not in self.on:
            return []
        liquid, cell = self.scene.liquid, min(self.system.grid.cell)
        bottom = np.minimum.reduceat(self.system.position[:, 2], self.system.first[:-1])
        surface = liquid_level(liquid)
        # Fastest at the surface on its way down or up, or at the floor.
        rise = np.maximum(0.0, surface - bottom) * np.maximum(0.0, -self._weight_left())
        fastest = self._speed(np.maximum.reduce([bottom - surface, rise, self._fall()]))
        m = int(fastest.argmax())
        speed = float(fastest[m])
        stride = STRIDE + EVERY * self.dt * speed / cell
        each = 2.0 * SWEEPS if liquid.sweeps is None else liquid.sweeps / stride
        few = each < SWEEPS
        return [
            Margin(
                "sweeps",
                self.system.names[m],
                each,
                SWEEPS,
                "per cell",
                f"liquid is swept {number(each, 2)} times for each cell that {self.system.names[m]} "
                f"travels at {say(speed, 'm/s')}; below {SWEEPS} it is pushed up before it can flow away, "
                f"{2 * SWEEPS} are better",
                liquid.spans.get("sweeps") or liquid.spans.get("liquid"),
                "warning" if few else "ok",
                least=True,
                hint=f"write sweeps auto, or {math.ceil(2 * SWEEPS * stride)}",
            )
        ]


def folds_on_end(filled: np.ndarray) -> float:
    """Speed of a landing over the wave speed above which the smallest end of a body of these cells stays folded up [-]."""
    return FOLDS_ON_END * end_share(filled) ** FOLDS_POWER


def _coarser(shape: Shape, h: float, ratio: float) -> float | None:
    """The next coarser spacing [m] at which a landing at this part of the wave speed folds no end;
    None below three cells across."""
    for trial in (at_least(h * 1.05**k) for k in range(1, 40)):
        try:
            if thickness(shape) / trial < 3.0:
                break
            if ratio <= folds_on_end(fill_cells(shape, trial).filled):
                return trial
        except TooThin:
            continue
    return None


def _least_of_others(values: np.ndarray) -> np.ndarray:
    """Along each axis, the least of all rows but one's own; shape (M, 3)."""
    order = np.argsort(values, axis=0)
    least = np.broadcast_to(np.take_along_axis(values, order[:1], 0), values.shape).copy()
    if len(values) > 1:
        np.put_along_axis(least, order[:1], np.take_along_axis(values, order[1:2], 0), 0)
    return least
