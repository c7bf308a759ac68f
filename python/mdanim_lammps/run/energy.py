# SPDX-License-Identifier: GPL-2.0-only
"""The energies of a state, in the terms of the ledger."""

from __future__ import annotations

import numpy as np

from ..engine.instance import Instance
from ..engine.plan import Plan
from ..model.system import System
from ..scene.scene import SceneRecord

LEAST_STRAIN = 1e-9
"""Strain that neither a picture nor a measurement of a run shows."""
ROUNDED_STEPS = 1e8
"""Steps whose rounding errors, which add up like a random walk, are below the least energy."""

UNEVEN = 200.0
"""Times `load_energy`: a vibration has up to 4 times that, and the account of the highest ones, at half of the bound, is off by
5 % of them; a class of accuracy is 0.001."""


def rounding_energy(scene: SceneRecord, system: System) -> float:
    """Energy below which no account is kept [J]: that of all solids at a strain of `LEAST_STRAIN`, or at the strain that the
    rounding of positions, so far from the origin, makes in `ROUNDED_STEPS`; and what rounding of the weights of all solids and
    of a full basin, times their heights, makes in so many. In a liquid, also that in which vibrations by `load_energy` have an
    account of usual accuracy."""
    farthest = np.abs(system.position).max(initial=0.0)
    strain = max(LEAST_STRAIN, np.sqrt(ROUNDED_STEPS) * np.spacing(farthest) / system.spacing.min(initial=np.inf))
    potential = float((system.mass * np.abs(system.position @ np.array(scene.gravity))).sum())
    if scene.liquid:
        low, high = np.array(scene.liquid.low), np.array(scene.liquid.high)
        heights = np.abs(scene.gravity) * np.maximum(np.abs(low), np.abs(high))
        potential += scene.liquid.density * float(np.prod(high - low) * heights.sum())
    elastic = strain**2 * float((system.young[system.object] * system.volume).sum())
    least = max(elastic, float(np.sqrt(ROUNDED_STEPS) * np.spacing(potential)))
    return max(least, UNEVEN * load_energy(scene, system)) if scene.liquid else least


def load_energy(scene: SceneRecord, system: System) -> float:
    """Energy that weight and lift of solids in balance strain them by, about: sum f_i^2 / (2 E_i h_i) [J].

    Weight acts on the fitted masses of particles, lift on their volumes by cells: f_i = g (m_i - rho V_i). A body as dense as the
    liquid rests as a whole and vibrates by it.
    """
    load = np.linalg.norm(scene.gravity) * (system.mass - (system.density[system.object] * system.volume))
    free = ~system.held
    return 0.5 * float((load**2 / (system.young * system.spacing)[system.object])[free].sum())


def ledger_terms(plan: Plan) -> tuple[str, ...]:
    """Columns of the ledger: kinetic energy, and those of the effects that are on."""
    of_effects = (term for e in plan.effects for term in (e.ledger, *e.further_ledger, *e.losses(plan.scene)) if term)
    return ("kinetic", *dict.fromkeys(of_effects))


def potential_terms(plan: Plan) -> tuple[str, ...]:
    """Those of them whose zero is arbitrary."""
    return tuple(dict.fromkeys(e.ledger for e in plan.effects if e.has_potential or e.has_arbitrary_zero))


def loss_terms(plan: Plan) -> tuple[str, ...]:
    """Those of them that only grow: what effects have taken so far."""
    return tuple(dict.fromkeys(term for e in plan.effects for term in e.losses(plan.scene)))


def energies(instance: Instance, center: np.ndarray) -> dict[str, float]:
    """Every term of the ledger [J], at the end of a `run` or after `setup`; ``center`` as for `potentials`."""
    return stored(instance) | potentials(instance.plan, center) | losses(instance)


def stored(instance: Instance) -> dict[str, float]:
    """The terms of what a state holds, 0 for `potentials`, without losses [J]; when as in `energies`.

    Objects that stand still, guests or laid aside, have no part in them.
    """
    plan = instance.plan
    effects = [e for e in plan.effects if e.ledger]
    found = dict.fromkeys(("kinetic", *(e.ledger for e in effects)), 0.0)
    found["kinetic"] = instance.kinetic_energy()
    for effect in effects:
        if not effect.has_potential:
            found[effect.ledger] += effect.energy(instance)
        found |= effect.further_energies(instance)
    return found


def potentials(plan: Plan, center: np.ndarray) -> dict[str, float]:
    """The terms that follow from where the objects of a plan are [J], for their centres of mass [m], shape (M, 3)."""
    return {e.ledger: e.potential(plan.scene, plan.system.mass_of, center) for e in plan.effects if e.has_potential}


def losses(instance: Instance) -> dict[str, float]:
    """The terms of what has been lost since the instance was made [J]."""
    plan, found = instance.plan, dict.fromkeys(loss_terms(instance.plan), 0.0)
    for effect in plan.effects:
        for term, energy in effect.lost(instance).items():
            found[term] += energy
    return found
