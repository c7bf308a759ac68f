# SPDX-License-Identifier: GPL-2.0-only
"""Which objects the names of contact blocks stand for, and the friction of objects and pairs that follows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import sqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .scene import SceneRecord

PLANES = ("ground", "walls", "basin")
"""Words of a contact block that are not objects."""
USUAL_DAMPING = 0.3
"""Share of critical damping of a contact with friction: enough to end chatter."""


def objects_by_name(names: Iterable[str]) -> dict[str, list[int]]:
    """Objects, from 0 and ascending, that a name stands for: one by its own name, all of a repeat by the name without index, all
    of a group by its name. Without any index it stands for those of all places of the group: ``cart.wheel``.

    Some of the objects of a scene give the same as all of them; so a name that is both has all of these objects.
    """
    found: dict[str, list[int]] = {}
    for number, name in enumerate(names):
        for other in _names_of(name):
            found.setdefault(other, []).append(number)
    return found


def _names_of(name: str) -> Iterator[str]:
    """Its own name, and names of several objects that it is one of, each once."""
    yield name
    if "[" not in name and "." not in name:
        return
    parts, told = name.split("."), {name}
    for n in range(1, len(parts) + 1):
        whole = ".".join(parts[:n])
        bare = ".".join(part.partition("[")[0] for part in parts[:n])
        for other in (whole, whole.rpartition("[")[0] if whole.endswith("]") else whole, bare):
            if other not in told:
                told.add(other)
                yield other


def pairs_of(first: Sequence[int], second: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Pairs (i, j), i < j, of an object of one set and another object of the other, each once."""
    both = set(first) & set(second)
    for i in first:
        for j in second:
            if i < j or (j < i and not (i in both and j in both)):
                yield min(i, j), max(i, j)


def frictions(scene: SceneRecord, plane: str = "") -> list[float]:
    """Coefficient of friction of every object [-], its own or, with the name of a plane, that against the plane."""
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


def damping(scene: SceneRecord) -> float:
    """Share of critical damping of a contact with friction of which no contact block says anything else."""
    asked = scene.control.contact_damping
    return USUAL_DAMPING if asked is None else asked


def any_friction(scene: SceneRecord) -> bool:
    """Whether anything in a scene may have friction."""
    return any(frictions(scene)) or any(c.friction for c in scene.contacts)
