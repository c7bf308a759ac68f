# SPDX-License-Identifier: GPL-2.0-only
"""The energies of a state, in the terms of the ledger."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..effects import Effect
from ..engine.instance import Instance
from ..engine.plan import Plan
from ..model.system import System
from ..results.ledger import LOSS

LEAST_STRAIN = 1e-9
"""Strain that neither a picture nor a measurement of a run shows."""
ROUNDED_STEPS = 1e8
"""Steps whose rounding errors of positions, which add up like a random walk, are below the least energy."""


def rounding_energy(system: System) -> float:
    """Energy below which no account is kept [J]: that of all solids at a strain of `LEAST_STRAIN`, or at the strain that the
    rounding of positions, so far from the origin, makes in `ROUNDED_STEPS`."""
    farthest = np.abs(system.position).max(initial=0.0)
    strain = max(LEAST_STRAIN, np.sqrt(ROUNDED_STEPS) * np.spacing(farthest) / system.spacing.min(initial=np.inf))
    return strain**2 * float((system.young[system.object] * system.volume).sum())


def ledger_terms(effects: Iterable[Effect]) -> tuple[str, ...]:
    """Columns of the ledger: kinetic energy, and those of the effects that are on."""
    return ("kinetic", *dict.fromkeys(e.ledger for e in effects if e.ledger))


def energies(instance: Instance) -> dict[str, float]:
    """Every term of the ledger [J], at the end of a `run` or after `setup`."""
    return stored(instance) | potentials(instance.plan, instance.array("x")) | losses(instance)


def stored(instance: Instance) -> dict[str, float]:
    """The terms of what a state holds, 0 for `potentials`, without losses [J]; when as in `energies`.

    Objects that stand still, guests or laid aside, have no part in them.
    """
    plan = instance.plan
    effects = [e for e in plan.effects if e.ledger and not e.ledger.endswith(LOSS)]
    found = dict.fromkeys(ledger_terms(effects), 0.0)
    found["kinetic"] = instance.kinetic_energy()
    for effect in effects:
        if not effect.has_potential:
            found[effect.ledger] += effect.energy(instance, plan.scene, plan.system)
    return found


def potentials(plan: Plan, x: np.ndarray) -> dict[str, float]:
    """The terms that follow from where all particles of a plan are [J]; x [m], shape (N, 3)."""
    return {e.ledger: e.potential(plan.scene, plan.system.mass, x) for e in plan.effects if e.has_potential}


def losses(instance: Instance) -> dict[str, float]:
    """The terms of what has been lost since the instance was made [J]."""
    plan, found = instance.plan, {}
    for effect in plan.effects:
        if effect.ledger.endswith(LOSS):
            found[effect.ledger] = found.get(effect.ledger, 0.0) + effect.energy(instance, plan.scene, plan.system)
    return found
