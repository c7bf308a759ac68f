# SPDX-License-Identifier: GPL-2.0-only
"""The energies of a state, in the terms of the ledger."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from .. import features
from ..effects.fields import OF_OBJECTS, Field, Fields, join_fields
from ..engine.instance import Instance
from ..engine.plan import Plan
from ..model.system import System
from ..scene.scene import SceneRecord

LEAST_STRAIN = 1e-9
"""Strain that neither a picture nor a measurement of a run shows."""
ROUNDED_STEPS = 1e8
"""Steps whose rounding errors, which add up like a random walk, are below the least energy."""


def least_energy(scene: SceneRecord, system: System) -> float:
    """Energy below which no account is kept [J]: the largest of three.

    That of all solids at a strain of `LEAST_STRAIN`, or at the strain that the rounding of positions, so far from the origin,
    makes in `ROUNDED_STEPS`; the energy that rounding of the `weighed` of all effects makes in so many; and their `unsettled`.
    """
    effects = [e.of(scene) for e in features.effects()]
    farthest = np.abs(system.position).max(initial=0.0)
    strain = max(LEAST_STRAIN, np.sqrt(ROUNDED_STEPS) * np.spacing(farthest) / system.spacing.min(initial=np.inf))
    young = np.where(np.isfinite(system.young), system.young, 0.0)  # what is rigid has no energy of its own
    elastic = strain**2 * float((young[system.object] * system.volume).sum())
    rounded = float(np.sqrt(ROUNDED_STEPS) * np.spacing(sum(e.weighed(scene, system) for e in effects)))
    return max(elastic, rounded, *(e.unsettled(scene, system) for e in effects))


def ledger_terms(plan: Plan) -> tuple[str, ...]:
    """Columns of the ledger: kinetic energy, and those of the effects that are on."""
    of_effects = (
        term
        for e in plan.effects
        for term in (e.ledger, *e.further_ledger, *e.losses(plan.scene), *e.sources(plan.scene))
        if term
    )
    return ("kinetic", *dict.fromkeys(of_effects))


def extra_fields(plan: Plan) -> tuple[Field, ...]:
    """Fields that are columns of the ledger besides its terms."""
    terms = ledger_terms(plan)
    return tuple(f for f in frame_fields(plan) if f.ledger and f.name not in terms)


def frame_fields(plan: Plan) -> tuple[Field, ...]:
    """The fields of a frame from all effects, and their columns that are part of the state."""
    return (*(f for e in plan.effects for f in e.fields(plan.scene)), *(plan.fields[name] for name in plan.states))


def tell(instance: Instance) -> dict[str, Any]:
    """The values of the fields that an instance has, by their names."""
    of_effects = {name: value for e in instance.plan.effects for name, value in e.tell(instance).items()}
    return of_effects | {name: instance.column(name) for name in instance.plan.states}


def potential_terms(plan: Plan) -> tuple[str, ...]:
    """Terms whose zero is arbitrary."""
    return tuple(dict.fromkeys(e.ledger for e in plan.effects if e.has_potential or e.has_arbitrary_zero))


def loss_terms(plan: Plan) -> tuple[str, ...]:
    """Terms that are sums since the start: what effects have taken, and what they have brought in."""
    return tuple(dict.fromkeys(term for e in plan.effects for term in (*e.losses(plan.scene), *e.sources(plan.scene))))


def source_terms(plan: Plan) -> tuple[str, ...]:
    """Terms that count what was brought in from outside."""
    return tuple(dict.fromkeys(term for e in plan.effects for term in e.sources(plan.scene)))


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
    found["kinetic"] = instance.kinetic_energy() + sum(effect.kinetic(instance) for effect in plan.effects)
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


def whole_fields(plan: Plan, parts: Iterable[tuple[np.ndarray, Fields]]) -> dict[str, Any]:
    """The fields of a frame, from those of parts of the plan (fields.join_fields)."""
    return join_fields(frame_fields(plan), plan.rows, plan.system.still, parts, plan.columns)


def start_fields(plan: Plan) -> dict[str, Any]:
    """Fields of things that objects have before the first step, as they are declared."""
    of_effects = {name: value for e in plan.effects for name, value in e.tell_start(plan.context).items()}
    told = whole_fields(plan, [(np.arange(len(plan.system.names)), of_effects)])
    return {field.name: told[field.name] for field in frame_fields(plan) if field.per in OF_OBJECTS}
