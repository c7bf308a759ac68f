# SPDX-License-Identifier: GPL-2.0-only
"""What an effect is: when a scene calls for it, what it writes into LAMMPS's input, what
it adds to the ledger and to the bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import Problem, Span
from ..model.planes import Plane
from ..model.system import System
from ..scene.formatting import number
from ..scene.scene import ContactModel, SceneRecord, Switch
from .envelope import Envelope
from .margin import Margin
from .readings import Readings


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether an effect is on, and why; shown by ``check`` with the scene line."""

    name: str
    on: bool
    reason: str
    span: Span | None = None


@dataclass(frozen=True)
class Resolved:
    """The verdicts of a scene, worked out once."""

    scene: SceneRecord
    verdicts: dict[str, Verdict]
    """Of every effect, by its name."""
    effects: tuple[Effect, ...]
    """Those that are on, in the order in which their forces are summed."""
    planes: tuple[Plane, ...]
    """The planes of those that are on."""
    warnings: tuple[Problem, ...]
    """About effects that the scene calls for and switches off."""


class Effect:
    """One physical effect. A subclass is one file in this folder and says everything that is to be said about it.

    An effect that is off leaves no trace: no column, no command, no term.
    """

    name = ""
    """As in ``effects { name off }``; also its name in the cost table."""
    fix = ""
    """ID of its LAMMPS fix of ours, which times itself; empty when it has none."""
    ledger = ""
    """The column of ledger.csv with the energy that it stores; empty when it stores none."""
    further_ledger: tuple[str, ...] = ()
    """Further columns of that kind, see `further_energies`."""
    has_potential = False
    """Whether its energy is a `potential`, that of a uniform field; no other effect has the same column then."""
    has_arbitrary_zero = False
    """Whether only changes of the energy in its column ``ledger`` mean something; that of a potential always is so."""
    uses_grid = False
    """Whether it lives in the cells of the basin."""
    keeps_apart = False
    """Whether objects cannot be inside each other where it is on."""
    needs: tuple[str, ...] = ()
    """Effects without which this one cannot be; they stand before it in EFFECTS."""
    if_off = ""
    """What looks wrong when a scene needs the effect and it is switched off."""

    def __init__(self, on_surfaces: Effect | None = None):
        self.on_surfaces = on_surfaces
        """What it is under ``contact-model surface``; None where that is the same."""

    def of(self, scene: SceneRecord) -> Effect:
        """What it is under the contact model of a scene."""
        surface = scene.control.contact_model is ContactModel.SURFACE
        return self.on_surfaces if surface and self.on_surfaces else self

    def called_for(self, scene: SceneRecord, planes: tuple[Plane, ...] | None = None) -> Verdict:
        """Whether the scene, by itself, calls for the effect; ``planes`` push objects back, None are those of the scene."""
        raise NotImplementedError

    def columns(self, scene: SceneRecord, system: System) -> dict[str, np.ndarray]:
        """Per-particle properties that its commands name as ``d_NAME``, each of shape (N,).

        With ``body``, the kind of each particle's body (System.contact_kind), its fix is given the contact bodies of all kinds.
        """
        return {}

    def tables(self, scene: SceneRecord, system: System) -> dict[str, np.ndarray]:
        """Per-particle whole numbers that its commands name as ``i2_NAME``, int32, each of shape (N, K)."""
        return {}

    def commands(self, scene: SceneRecord, system: System) -> list[str]:
        """LAMMPS commands; group ``mobile`` exists by then."""
        return []

    def rate(self, scene: SceneRecord, system: System) -> np.ndarray | None:
        """Its share in the bound on the squared frequency of each particle, 2 lambda_max(D_i)/m_i [1/s^2], shape (N,)."""
        return None

    def own_rate(self, scene: SceneRecord, system: System) -> np.ndarray | None:
        """The part of `rate` that comes of points of a particle's own surface in something else [1/s^2], shape (N,).

        No point is in two things at once: of these parts of all effects the largest alone counts.
        """
        return None

    def drag_rate(self, scene: SceneRecord, system: System) -> np.ndarray | None:
        """The same as `rate` of its dashpots, 2 lambda_max(C_i)/m_i [1/s], shape (N,)."""
        return None

    def max_timestep(self, scene: SceneRecord, system: System) -> float:
        """Longest time step that still shows what it does [s]; stability is another matter, see `rate`."""
        return math.inf

    def friction(self, scene: SceneRecord, system: System) -> np.ndarray | None:
        """The most that it adds to each particle's lambda, eq. (3.9) [N*s/m], shape (N,)."""
        return None

    def energy(self, readings: Readings) -> float:
        """What stands in its column ``ledger`` now [J]."""
        return self.potential(readings.scene, readings.system.mass, readings.array("x")) if self.has_potential else 0.0

    def further_energies(self, readings: Readings) -> dict[str, float]:
        """What stands in its columns ``further_ledger`` now [J]."""
        return {}

    def potential(self, scene: SceneRecord, mass: np.ndarray, x: np.ndarray) -> float:
        """Its energy in a uniform field [J]; mass [kg], shape (n,), and x [m], shape (n, 3), are those of particles or, for
        the same energy, of objects and their centres of mass."""
        raise NotImplementedError

    def losses(self, scene: SceneRecord) -> tuple[str, ...]:
        """The columns of ledger.csv with the energies that it has taken so far."""
        return ()

    def lost(self, readings: Readings) -> dict[str, float]:
        """What stands in these columns now [J]."""
        return {}

    def planes(self, scene: SceneRecord) -> tuple[Plane, ...]:
        """The planes that push objects back, whether the effect is on or not."""
        return ()

    def margins(self, envelope: Envelope) -> list[Margin]:
        """Limits that a scene in which something can move has to keep because of the effect, each with what the scene reaches."""
        return []

    def pull(self, scene: SceneRecord) -> float:
        """Acceleration downward that it gives to everything [m/s^2]."""
        return 0.0

    def lift(self, scene: SceneRecord, system: System) -> np.ndarray | float:
        """Part of the mass of each immersed solid that it carries [kg], shape (M,)."""
        return 0.0

    def surface(self, scene: SceneRecord) -> float | None:
        """Height below which solids are immersed in it [m]; None where it immerses nothing."""
        return None

    def acts_on(self, system: System, liquid: bool) -> bool:
        """Whether it has anything to act on in a part of a scene: some of its solids, and the liquid or not."""
        return True

    def warnings(self, scene: SceneRecord, system: System) -> list[Problem]:
        """What is doubtful about the start of a scene that the effect is on in."""
        return []

    def notes(self, envelope: Envelope) -> list[Problem]:
        """What ``check`` tells of a scene in which something can move besides: nothing is doubtful, but it may not be known."""
        return []

    def reach(self, scene: SceneRecord, system: System) -> np.ndarray | float:
        """Gap from which on a solid does not feel another by it, the larger one of both counts [m], shape (M,)."""
        return 0.0

    @property
    def fixes(self) -> tuple[str, ...]:
        """IDs of the fixes whose scalars are its energy."""
        return (self.fix,) if self.fix else ()

    def clocks(self, readings: Readings) -> dict[str, float]:
        """Wall seconds so far of each of its pieces.

        What runs under the clock of another style has its part of that clock, as ``python bench/effects.py shares`` measures it.
        """
        return {self.fix: readings.fix_seconds(self.fix)} if self.fix else {}

    def penetration(self, readings: Readings) -> float:
        """Deepest that something has been where it should not be, in this run [m]."""
        return 0.0


def stiffness_told(scene: SceneRecord) -> str:
    """What the reason of an effect that pushes back adds about ``contact-stiffness``; nothing where it is the usual one."""
    factor = scene.control.contact_stiffness
    return "" if factor == 1.0 else f", {number(factor)} times as stiff as usual"


def decide(effects: tuple[Effect, ...], scene: SceneRecord) -> tuple[dict[str, Verdict], list[Problem]]:
    """Verdict of each effect, by name, with the scene's own switches applied; and warnings about needed ones switched off."""
    effects = tuple(e.of(scene) for e in effects)
    verdicts: dict[str, Verdict] = {}
    warnings: list[Problem] = []
    planes = tuple(p for e in effects if scene.effects.get(e.name) is not Switch.OFF for p in e.planes(scene))
    for effect in effects:
        own = effect.called_for(scene, planes)
        switch = scene.effects.get(effect.name, Switch.AUTO)
        span = scene.spans.get(f"effects.{effect.name}")
        if switch is Switch.OFF and own.on:
            warnings.append(
                Problem(
                    span,
                    f"{effect.name} is switched off, but the scene calls for it ({own.reason})",
                    effect.if_off,
                    severity="warning",
                )
            )
            own = Verdict(effect.name, False, f"switched off; {effect.if_off}", span)
        elif switch is Switch.ON and not own.on:
            warnings.append(
                Problem(
                    span,
                    f"{effect.name} cannot be switched on: {own.reason}",
                    "effects are called for by what stands in the scene",
                    severity="warning",
                )
            )
        verdicts[effect.name] = own
    for effect in effects:
        missing = next((name for name in effect.needs if not verdicts[name].on), None)
        if (own := verdicts[effect.name]).on and missing:
            verdicts[effect.name] = Verdict(effect.name, False, f"{missing} is off", own.span)
    return verdicts, warnings


def resolve(effects: tuple[Effect, ...], scene: SceneRecord) -> Resolved:
    """Decide on every effect of a scene."""
    effects = tuple(e.of(scene) for e in effects)
    verdicts, warnings = decide(effects, scene)
    on = tuple(e for e in effects if verdicts[e.name].on)
    return Resolved(scene, verdicts, on, tuple(p for e in on for p in e.planes(scene)), tuple(warnings))
