# SPDX-License-Identifier: GPL-2.0-only
"""Friction and damping of objects and of pairs, as contact blocks, objects and ``control`` say, and what touches what."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np

from ... import features
from ...effects.context import Context
from ...reach import largest_of_others
from ...scene.formatting import in_full
from ...scene.naming import objects_by_name, pairs_of
from ...scene.once import once_for
from ...scene.scene import SceneRecord

USUAL_DAMPING = 0.3
"""Share of critical damping of a contact with friction: enough to end chatter."""


@once_for(lambda scene, plane="": scene)
def frictions(scene: SceneRecord, plane: str = "") -> list[float]:
    """Coefficient of friction of every object [-], its own or, with the name of a plane, that against the plane; not to be
    changed, because the list is kept: frames ask for it many times."""
    found = [scene.control.friction if s.friction is None else s.friction for s in scene.solids]
    told = [c for c in scene.contacts if plane in (c.first, c.second) and c.friction is not None] if plane else []
    by_name = objects_by_name(s.name for s in scene.solids) if told else {}
    for contact in told:
        for i in (*by_name.get(contact.first, ()), *by_name.get(contact.second, ())):
            found[i] = contact.friction
    return found


def pair_rules(scene: SceneRecord, names: Sequence[str]) -> list[tuple[int, int, float, float]]:
    """Rules of contact blocks for pairs i < j, from 0, of these objects of a scene: i, j, friction, share of critical damping."""
    own = dict(zip((s.name for s in scene.solids), frictions(scene))) if any(c.friction is None for c in scene.contacts) else {}
    by_name = objects_by_name(names) if scene.contacts else {}
    rules = []
    for c in scene.contacts:
        for i, j in pairs_of(by_name.get(c.first, ()), by_name.get(c.second, ())):
            mu = sqrt(own[names[i]] * own[names[j]]) if c.friction is None else c.friction
            usual = damping(scene) if mu > 0.0 else 0.0
            rules.append((i, j, mu, usual if c.contact_damping is None else c.contact_damping))
    return rules


def runs(scene: SceneRecord) -> bool:
    """Whether the surface of something runs over it."""
    return any(effect.of(scene).belts(scene) for effect in features.effects())


def belts(context: Context, among: np.ndarray | None = None) -> list[str]:
    """Words for surfaces that run over solids, or over those of them that are ``among``, bool, shape (M,)."""
    running = [one for effect in context.reach.acting.effects for one in effect.belts(context.scene).items()]
    number = {name: m for m, name in enumerate(context.system.names)} if running else {}
    found = ((number.get(context.scene.solids[m].name), velocity) for m, velocity in running)
    return [f"belt {m + 1} {in_full(u)}" for m, u in found if m is not None and (among is None or among[m])]


def damping(scene: SceneRecord) -> float:
    """Share of critical damping of a contact with friction of which no contact block says anything else."""
    asked = scene.control.contact_damping
    return USUAL_DAMPING if asked is None else asked


def any_friction(scene: SceneRecord) -> bool:
    """Whether anything in a scene may have friction."""
    return any(frictions(scene)) or any(c.friction for c in scene.contacts)


def largest_of_partners(context: Context, value: np.ndarray, apart: Sequence[np.ndarray] = ()) -> np.ndarray:
    """Largest value among the solids that may touch each solid, both of shape (M,); 0 where there are none.

    Two lines or sheets of particles never touch, nor do two solids of one of the sets ``apart``, bool, each of shape (M,), nor
    what is joined.
    """
    bare = context.system.bare
    sets = [*apart, *([bare] if bare.any() else [])]
    found = largest_of_others(value)
    for own in sets:
        found = np.where(own, value[~own].max(initial=0.0), found)
    passed: dict[int, list[int]] = {}
    for i, j in context.passing:
        passed.setdefault(i, []).append(j)
        passed.setdefault(j, []).append(i)
    for m, others in passed.items():
        may = np.ones(len(value), bool)
        may[[m, *others]] = False
        for own in sets:
            may &= ~(own & own[m])
        found[m] = value[may].max(initial=0.0)
    return found
