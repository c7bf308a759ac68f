# SPDX-License-Identifier: GPL-2.0-only
"""The energies of a state, in the terms of the ledger."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..effects import Effect
from ..engine import geometry
from ..engine.instance import Instance
from ..model.system import System
from ..results.ledger import LOSS

ROUNDING = 1e-12
"""Strain that positions in double precision can hardly tell from none."""


def rounding_energy(system: System) -> float:
    """Energy of all solids at a strain of `ROUNDING` [J]: less is rounding, and no account of it adds up."""
    return ROUNDING**2 * float((system.young[system.object] * system.volume).sum())


def ledger_terms(effects: Iterable[Effect]) -> tuple[str, ...]:
    """Columns of the ledger: kinetic energy, and those of the effects that are on."""
    return ("kinetic", *dict.fromkeys(e.ledger for e in effects if e.ledger))


def energies(instance: Instance, before: np.ndarray) -> dict[str, float]:
    """Every term of the ledger [J]; ``before`` are the forces [N] of the step before, shape (N, 3)."""
    return stored(instance, before) | losses(instance)


def stored(instance: Instance, before: np.ndarray, others: np.ndarray | None = None) -> dict[str, float]:
    """The terms of what a state holds, without losses [J]; ``before`` as in `energies`.

    ``others`` are particles of the instance that are not to be counted; they do not move and hold no elastic energy.
    """
    plan = instance.plan
    effects = [e for e in plan.effects if e.ledger and not e.ledger.endswith(LOSS)]
    found = dict.fromkeys(ledger_terms(effects), 0.0)
    found["kinetic"] = kinetic(plan.system, plan.certificate.timestep, instance.array("v"), instance.array("f"), before)
    for effect in effects:
        found[effect.ledger] += effect.energy(instance, plan.scene, plan.system)
    if others is not None and len(others):
        x, mass = instance.array("x")[others], plan.system.mass[others]
        for effect in effects:
            found[effect.ledger] -= effect.potential(plan.scene, mass, x)
    return found


def losses(instance: Instance) -> dict[str, float]:
    """The terms of what has been lost since the instance was made [J]."""
    plan, found = instance.plan, {}
    for effect in plan.effects:
        if effect.ledger.endswith(LOSS):
            found[effect.ledger] = found.get(effect.ledger, 0.0) + effect.energy(instance, plan.scene, plan.system)
    return found


def kinetic(system: System, dt: float, v: np.ndarray, f: np.ndarray, before: np.ndarray) -> float:
    """Kinetic energy [J], corrected so that the sum of all energies is what leap-frog conserves, to fourth order in dt.

    That is T + U + dt^2 (v.U''.v / 12 - F.F / 24 m), the energy of the nearby system whose exact motion the steps are (Hairer,
    Lubich & Wanner, Geometric Numerical Integration, IX.3); without it a vibration of frequency w seems to hold
    (w dt)^2/24 too little, and an impact to lose what goes into vibrations. U''.v is (F(n-1) - F(n)) / dt, and v the velocity
    between these two steps. v [m/s], f and ``before`` [N], all (N, 3).
    """
    return geometry.kinetic(dt, system.mass, ~system.held, v, f, before)
