# SPDX-License-Identifier: GPL-2.0-only
"""The certified time step: a bound from springs, dashpots, contact and walls, what sets it, and the step chosen.

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
from .errors import Problem, RefusedError, SceneError, Span
from .model.basin import liquid_level
from .model.system import System
from .scene.scene import Scene

FRACTION = 0.5
"""``timestep auto`` over the bound: the bound is linear, motion at a tenth of the wave speed needs this margin."""


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
        return {**asdict(self), "bound": self.bound if math.isfinite(self.bound) else None,
                "span": str(self.span) if self.span else None, "steps": self.steps, "fraction": self.fraction}

    def __str__(self) -> str:
        if not math.isfinite(self.bound):
            return f"dt {self.timestep:.3g} s   nothing in the scene vibrates: every step is stable"
        return (f"dt {self.timestep:.3g} s = {self.fraction:.2f} of the bound {self.bound:.3g} s   "
                f"set by: {self.object}, {self.cause}")


def certify(scene: Scene, system: System, verdicts: dict[str, Verdict], *, allow_unstable: bool = False) -> Certificate:
    """Bound the time step of a scene and choose one that fits its frames.

    Raises RefusedError when ``control timestep`` is above the bound (unless ``allow_unstable``), and SceneError when
    ``time`` and ``frames`` cannot be met by one time step.
    """
    on = {e.name: e for e in EFFECTS if verdicts[e.name].on}
    rates = {name: r for name, e in on.items() if (r := e.rate(scene, system)) is not None}
    stiff = sum(rates.values(), np.zeros(system.particles))
    drags = {name: r for name, e in on.items() if (r := e.drag_rate(scene, system)) is not None}
    drag = sum(drags.values(), np.zeros(system.particles))
    free = ~system.held
    if not free.any() or not (stiff + drag)[free].any():
        # Nothing vibrates: any step integrates free fall exactly; one step per frame, or what liquid or scene say.
        bound, worst = math.inf, 0
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            limit = np.where(stiff > 0.0, (np.sqrt(drag**2 + 4.0 * stiff) - drag) / stiff, 2.0 / drag)
        limit[~free] = np.inf
        worst = int(np.argmin(limit))
        bound = float(limit[worst])
    causes = {name: r[worst] for name, r in rates.items()}
    if math.isfinite(bound):
        causes |= {name: 2.0 * r[worst] / bound for name, r in drags.items()}
    total = sum(causes.values())
    cause = max(causes, key=causes.get) if total else "nothing"
    name = system.names[system.object[worst]] if system.particles else "nothing"
    solid = next((s for s in scene.solids if s.name == name), None)

    asked = scene.control.timestep
    if asked is not None and asked > bound * (1.0 + 1e-12) and not allow_unstable:
        problem = Problem(
            scene.control.spans.get("timestep"),
            f"timestep {asked:.4g} s is above the certified bound {bound:.4g} s, set by {name} ({cause})",
            f"write 'timestep auto' ({FRACTION * bound:.3g} s), or insist with --allow-unstable",
        )
        raise RefusedError(str(problem))
    longest = min([FRACTION * bound, *(e.pace(scene, system) for e in on.values())]) if asked is None else asked
    per_frame, frames, last = fit_steps(scene, longest)
    return Certificate(
        timestep=1.0 / (scene.control.frames * per_frame),
        bound=bound,
        object=name,
        cause=cause,
        share=float(causes[cause] / total) if total else 0.0,
        steps_per_frame=per_frame,
        frames=frames,
        last_steps=last,
        span=solid.spans.get("elasticity") if solid else None,
    )


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
        raise SceneError([Problem(
            control.spans.get("time"),
            f"time {control.time:g} s is {control.time * control.frames:.6g} frames at {control.frames:g} fps: "
            "no time step fits both",
            f"try 'time {whole / control.frames:.6g} s' ({whole} frames)",
        )])
    q = ratio.denominator
    per_frame = q * math.ceil(least / q)
    frames, rest = divmod(ratio.numerator, q)
    return per_frame, frames, rest * per_frame // q


STRONG = 0.5
"""phi = lambda dt / 2m, eq. (3.13), above which the implicit form is no good: beyond 1 it turns velocities round every step."""


def strong_drag(scene: Scene, system: System, effects: Iterable[Effect], timestep: float) -> float:
    """Largest phi of the drag that these effects make, all together, when it is above STRONG, else 0."""
    frictions = [f for e in effects if (f := e.friction(scene, system)) is not None]
    phi = float((sum(frictions) / system.mass).max()) * timestep / 2.0 if frictions else 0.0
    return phi if phi > STRONG else 0.0


FOLDS = 0.2
"""Speed of an impact over the wave speed above which a lattice folds up and stays crumpled (docs/physics-solids.md)."""


def hard_landing(scene: Scene, system: System, verdicts: dict[str, Verdict]) -> Problem | None:
    """A warning for the object that may hit hardest for its stiffness, when that is harder than a lattice stands.

    The speed is the start's, with the fall down to the ground, to the floor of the basin, or to the lowest object.
    c = sqrt(1.2 E / rho).
    """
    free = np.logical_or.reduceat(~system.held, system.first[:-1])
    if not free.any():
        return None
    fall = _fall(scene, system, verdicts)
    speed = np.sqrt(np.maximum(0.0, np.maximum.reduceat((system.velocity**2).sum(1), system.first[:-1])
                               + 2.0 * max(0.0, -scene.gravity[2]) * fall))
    meets = len(system.names) > 1 or scene.ground is not None or scene.walls is not None or scene.liquid is not None
    density = system.mass_of / (np.add.reduceat(system.share, system.first[:-1]) * system.cell_volume)
    wave = np.sqrt(1.2 * system.young / density)
    ratio = np.where(free & meets, speed / wave, 0.0)
    worst = int(ratio.argmax())
    if ratio[worst] <= FOLDS:
        return None
    solid = scene.solids[worst]
    enough = system.young[worst] * (ratio[worst] / FOLDS) ** 2
    others = int((ratio > FOLDS).sum()) - 1
    return Problem(
        solid.spans.get("elasticity"),
        f"{solid.name}{f' and {others} more' if others else ''} may hit at {speed[worst]:.2g} m/s, {ratio[worst]:.2f} of the wave speed "
        f"{wave[worst]:.2g} m/s; above about {FOLDS:g} a soft object folds up and stays crumpled",
        f"write elasticity {enough / 1e3:.2g} kPa or more, or a lower density, height or speed",
        severity="warning",
    )


def _fall(scene: Scene, system: System, verdicts: dict[str, Verdict]) -> np.ndarray:
    """Height of each solid's fall [m], shape (M,), as if through air: in a liquid, heights count by what it leaves of the weight.

    Below the surface a light solid gains height; where there are others it may meet them at the surface already.
    """
    bottom = np.minimum.reduceat(system.position[:, 2], system.first[:-1])
    floors = [z for z in (scene.ground, scene.liquid and scene.liquid.low[2]) if z is not None]
    floor = min([bottom.min(), *floors])
    if not verdicts["buoyancy"].on:
        return bottom - floor
    surface = liquid_level(scene.liquid)
    weight = 1.0 - scene.liquid.density * np.add.reduceat(system.volume, system.first[:-1]) / system.mass_of
    in_air, in_liquid = np.maximum(0.0, bottom - surface), np.minimum(bottom, surface) - floor
    return in_air + in_liquid * (weight if len(system.names) == 1 else np.maximum(0.0, weight))
