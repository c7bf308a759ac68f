# SPDX-License-Identifier: GPL-2.0-only
"""Which objects touch as layers, and how: their elements, reach and stiffness (docs/physics-folds.md)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from ...effects.context import Context
from ...model.model import Model
from ...model.rope import section
from ...scene.once import once_for
from ...scene.scene import Rope, SceneRecord, Sheet, Shell
from ..contact.pairs import damping, frictions, pair_rules
from .words import Itself

REACH = 1.0 / 3.0
"""Distance at which layers begin to push, over the longer spacing, at least; else it is the sum of their half thicknesses."""
STIFF = 0.25
"""Stiffness of a contact over that of the links of what touches."""
APART = 2.5
"""Spacings without load between parts of one object, up to which they never touch each other, beside twice the reach."""
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
"""Corners of the faces of a cell, counter-clockwise seen from outside."""


def is_sheet(solid: Any) -> bool:
    """Whether an object is a layer of particles."""
    return isinstance(solid.shape, Sheet | Shell)


def is_rope(solid: Any) -> bool:
    """Whether an object is a line of particles."""
    return isinstance(solid.shape, Rope)


def folds(solid: Any) -> bool:
    """Whether an object touches itself."""
    return solid.touches_itself is Itself.YES


def as_layers(one: Any, other: Any) -> bool:
    """Whether two objects touch each other as layers where they meet."""
    if not (is_sheet(one) or is_rope(one)) or not (is_sheet(other) or is_rope(other)):
        return False
    return (is_sheet(one) and is_sheet(other)) or (folds(one) and folds(other))


@once_for(lambda scene: scene)
def touching(scene: SceneRecord) -> tuple[tuple[int, int], ...]:
    """Pairs i <= j of objects of a scene that may touch as layers, by their kinds alone; equal ones touch themselves."""
    solids = scene.solids
    layered = [m for m, s in enumerate(solids) if is_sheet(s) or is_rope(s)]
    pairs = [(i, j) for n, i in enumerate(layered) for j in layered[n + 1 :] if as_layers(solids[i], solids[j])]
    return tuple(sorted([*pairs, *((m, m) for m, s in enumerate(solids) if folds(s))]))


@dataclass(frozen=True, slots=True)
class LayerPair:
    """Two objects of a context that touch as layers, or one that touches itself."""

    first: int
    second: int
    reach: float
    """[m]"""
    stiffness: float
    """[N/m]"""
    friction: float
    damping: float
    """Share of critical damping."""
    apart: float
    """[m]; 0 of two objects."""


@dataclass(frozen=True, eq=False)
class FoldLayer:
    """An object as a layer."""

    particle: np.ndarray
    """Numbers of its particles that touch, ascending, int64, shape (n,)."""
    rest: np.ndarray
    """Their places without load [m], shape (n, 3)."""
    element: np.ndarray
    """Rows of `particle`: segments, shape (E, 2), or triangles, shape (E, 3)."""
    weight: np.ndarray
    """Part of the stiffness of each that is its own, up to 1, shape (n,)."""
    spacing: float
    """[m]"""
    half: float
    """Half of its thickness [m]; 0 of a solid, whose surface it is."""
    link: float
    """Stiffness of its links [N/m]."""

    def text(self) -> str:
        """Its lines in the table of the fix."""
        rows = zip(self.particle.tolist(), self.rest.tolist(), self.weight.tolist())
        lines = [f"particle {i + 1} {x!r} {y!r} {z!r} {w!r}" for i, (x, y, z), w in rows]
        word = "triangle" if self.element.shape[1] == 3 else "segment"
        lines += [f"{word} {' '.join(str(k + 1) for k in row)}" for row in self.element.tolist()]
        return "".join(f"{line}\n" for line in lines)


def layer_of(model: Model, solid: Any) -> FoldLayer:
    """The layer of an object: all of a rope or a sheet, the surface of its cells of a solid."""
    n, h = len(model.position), model.spacing
    every = np.arange(n)
    weight = np.minimum(1.0, model.share / np.median(model.share))
    rest = model.position - model.position.mean(axis=0)
    if is_rope(solid):
        rope = solid.shape
        line = np.zeros((n, 3))
        line[:, 0] = np.arange(n) * (rope.length / (n - 1))
        link = model.young * section(rope) * (n - 1) / rope.length
        return FoldLayer(every, line, np.stack([every[:-1], every[1:]], axis=1), weight, h, 0.5 * rope.thickness, link)
    if is_sheet(solid):
        t = solid.shape.thickness
        return FoldLayer(every, rest, model.frame.triangle, weight, h, 0.5 * t, model.young * t)
    face = model.hexahedron[:, FACES].reshape(-1, 4)
    _, first, uses = np.unique(np.sort(face, axis=1), axis=0, return_index=True, return_counts=True)
    outer = face[np.sort(first[uses == 1])]
    triangle = np.concatenate([outer[:, [0, 1, 2]], outer[:, [0, 2, 3]]])
    particle, row = np.unique(triangle, return_inverse=True)
    return FoldLayer(particle, rest[particle], row.reshape(-1, 3), weight[particle], h, 0.0, model.young * h)


@once_for(lambda context: context.system)
def layers(context: Context) -> dict[int, FoldLayer]:
    """Layers of the objects of a context that may touch, by their numbers in it."""
    of = {model.name: (model, solid) for model, solid in zip(context.models, context.scene.solids)}
    return {m: layer_of(*of[context.system.names[m]]) for m in sorted({k for pair in _numbers(context) for k in pair})}


@once_for(lambda context: context.system)
def pairs(context: Context) -> tuple[LayerPair, ...]:
    """Pairs of a context that touch."""
    return tuple(_pairs(context))


def _numbers(context: Context) -> list[tuple[int, int]]:
    """Pairs that may meet, by numbers in the context."""
    number = {name: m for m, name in enumerate(context.system.names)}
    solids, swept, still = context.scene.solids, context.reach.region, context.system.still
    found = []
    for i, j in touching(context.scene):
        a, b = number.get(solids[i].name), number.get(solids[j].name)
        if a is None or b is None or (still[a] and still[b]):
            continue
        if i == j or may_meet(swept, i, j):
            found.append((min(a, b), max(a, b)))
    return sorted(found)


def may_meet(swept: Any, i: int, j: int) -> bool:
    """Whether two objects of a scene, i < j, can be in one place, and are not joined."""
    return bool(((swept.low[i] < swept.high[j]) & (swept.low[j] < swept.high[i])).all()) and (i, j) not in swept.passing


def _pairs(context: Context) -> Iterator[LayerPair]:
    scene, names = context.scene, context.system.names
    mu_of = dict(zip((s.name for s in scene.solids), frictions(scene)))
    told = {(i, j): rule for i, j, *rule in pair_rules(scene, names)}
    for a, b in _numbers(context):
        one, other = layers(context)[a], layers(context)[b]
        h = max(one.spacing, other.spacing)
        reach = max(one.half + other.half, REACH * h)
        k = STIFF * scene.control.contact_stiffness * 2.0 * one.link * other.link / (one.link + other.link)
        mu = sqrt(mu_of[names[a]] * mu_of[names[b]])
        mu, beta = told.get((a, b), (mu, damping(scene) if mu > 0.0 else 0.0))
        yield LayerPair(a, b, reach, k, mu, beta, APART * h + 2.0 * reach if a == b else 0.0)
