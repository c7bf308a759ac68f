# SPDX-License-Identifier: GPL-2.0-only
"""Which objects touch as layers, and how: their elements, reach and stiffness (docs/physics-folds.md). What tears is a layer,
too, or its surface is: its pieces touch each other."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from typing import Any

import numpy as np

from ...effects.context import Context
from ...model.boxes import box_pairs
from ...model.model import Model
from ...model.rope import section
from ...reach.region import Sweeps
from ...records import dataclass
from ...scene.once import once_for
from ...scene.scene import SceneRecord
from ..contact.pairs import damping, frictions, pair_rules
from ..ropes.words import is_rope
from ..sheets.words import is_sheet
from ..tearing.words import fills, tears
from .words import Itself

REACH = 1.0 / 3.0
"""Distance at which layers begin to push, over the longer spacing, at least; else it is the sum of their half thicknesses."""
STIFF = 0.25
"""Stiffness of a contact over that of the links of what touches."""
APART = 2.5
"""Spacings without load between parts of one object, up to which they never touch each other, beside twice the reach."""
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
"""Corners of the faces of a cell, counter-clockwise seen from outside."""


def folds(solid: Any) -> bool:
    """Whether an object touches itself."""
    return solid.touches_itself is Itself.YES


def breaks(solid: Any) -> bool:
    """Whether an object may tear into pieces that touch each other: a sheet or a solid."""
    return tears(solid) and not is_rope(solid)


@once_for(lambda scene: scene)
def _kinds(scene: SceneRecord) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Sheets, sheets and ropes that touch themselves, all sheets and ropes, and solids that tear, bool, each of shape (M,)."""
    sheet, filled, folding, torn = (np.array([is_so(s) for s in scene.solids], bool) for is_so in (is_sheet, fills, folds, tears))
    return sheet, ~filled & folding, ~filled, filled & torn


def _layered(scene: SceneRecord) -> np.ndarray:
    """Numbers of the sheets, ropes and solids that may tear of a scene, int64, shape (K,)."""
    _, _, bare, torn = _kinds(scene)
    return np.flatnonzero(bare | torn)


def as_layers(scene: SceneRecord, i: Any, j: Any) -> np.ndarray:
    """Which pairs of sheets and ropes of a scene, by number, touch each other as layers where they meet, bool, of the shape of
    ``i`` and ``j``."""
    sheet, folding, bare, torn = _kinds(scene)
    layered = bare | torn
    return (sheet[i] & sheet[j]) | (folding[i] & folding[j]) | (torn[i] & layered[j]) | (layered[i] & torn[j])


@once_for(lambda scene: scene)
def coupled(scene: SceneRecord) -> list[tuple[int, int]]:
    """Pairs i < j of objects of a scene that touch each other as layers where they meet, sorted."""
    layered = _layered(scene)
    i, j = layered[np.array(np.triu_indices(len(layered), 1))]
    may = as_layers(scene, i, j)
    return list(zip(i[may].tolist(), j[may].tolist()))


def meeting(scene: SceneRecord, swept: Sweeps) -> list[tuple[int, int]]:
    """Pairs i <= j of objects of a scene that touch as layers where they meet, can be in one place, and are not joined, sorted;
    equal ones touch themselves."""
    found = [(m, m) for m, solid in enumerate(scene.solids) if folds(solid) or breaks(solid)]
    layered = _layered(scene)
    for some in box_pairs(swept.low[layered], swept.high[layered]):
        i, j = np.sort(layered[np.array(some)], axis=0)
        within = ((swept.low[i] < swept.high[j]) & (swept.low[j] < swept.high[i])).all(axis=1) & as_layers(scene, i, j)
        found += zip(i[within].tolist(), j[within].tolist())
    return sorted(pair for pair in found if pair not in swept.passing)


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
    """[m]; 0 of two objects, and of one that touches itself only once it is torn."""


@dataclass(frozen=True, eq=False)
class FoldLayer:
    """An object as a layer."""

    particle: np.ndarray
    """Numbers of its particles that touch, ascending, int64, shape (n,)."""
    rest: np.ndarray
    """Their places without load [m], shape (n, 3)."""
    element: np.ndarray
    """Rows of `particle`: segments, shape (E, 2), triangles, shape (E, 3), or cells, shape (E, 8)."""
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
        word = {2: "segment", 3: "triangle", 8: "cell"}[self.element.shape[1]]
        lines += [f"{word} {' '.join(str(k + 1) for k in row)}" for row in self.element.tolist()]
        return "".join(f"{line}\n" for line in lines)


def layer_of(model: Model, solid: Any) -> FoldLayer:
    """The layer of an object: all of a rope or a sheet, the surface of its cells of a solid; all cells of one that may tear."""
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
    if tears(solid):
        return FoldLayer(every, rest, model.hexahedron, weight, h, 0.0, model.young * h)
    face = model.hexahedron[:, FACES].reshape(-1, 4)
    _, first, uses = np.unique(np.sort(face, axis=1), axis=0, return_index=True, return_counts=True)
    outer = face[np.sort(first[uses == 1])]
    triangle = np.concatenate([outer[:, [0, 1, 2]], outer[:, [0, 2, 3]]])
    particle, row = np.unique(triangle, return_inverse=True)
    return FoldLayer(particle, rest[particle], row.reshape(-1, 3), weight[particle], h, 0.0, model.young * h)


@once_for(lambda context: context.system)
def layers(context: Context) -> dict[int, FoldLayer]:
    """Layers of the objects of a context that may touch, by their numbers in it."""
    numbers = sorted({k for pair in _numbers(context) for k in pair})
    return {m: layer_of(context.system_models[m], context.solids[m]) for m in numbers}


@once_for(lambda context: context.system)
def pairs(context: Context) -> tuple[LayerPair, ...]:
    """Pairs of a context that touch."""
    return tuple(_pairs(context))


@once_for(lambda context: context.system)
def _numbers(context: Context) -> list[tuple[int, int]]:
    """Pairs that may meet, by numbers in the context."""
    number = {name: m for m, name in enumerate(context.system.names)}
    solids, still = context.scene.solids, context.system.still
    told = ((number.get(solids[m].name) for m in pair) for pair in meeting(context.scene, context.reach.region))
    found = (sorted(pair) for pair in map(list, told) if None not in pair)
    return sorted((a, b) for a, b in found if not (still[a] and still[b]))


def _pairs(context: Context) -> Iterator[LayerPair]:
    scene, names, of = context.scene, context.system.names, layers(context)
    mu_of = dict(zip((s.name for s in scene.solids), frictions(scene)))
    told = {(i, j): rule for i, j, *rule in pair_rules(scene, names)}
    for a, b in _numbers(context):
        one, other = of[a], of[b]
        h = max(one.spacing, other.spacing)
        itself = a == b and folds(context.solids[a])
        thick = one.half + other.half if a != b or itself else 0.0  # a tear parts what is nearer than a thickness may be
        reach = max(thick, REACH * h)
        k = STIFF * scene.control.contact_stiffness * 2.0 * one.link * other.link / (one.link + other.link)
        mu = sqrt(mu_of[names[a]] * mu_of[names[b]])
        mu, beta = told.get((a, b), (mu, damping(scene) if mu > 0.0 else 0.0))
        yield LayerPair(a, b, reach, k, mu, beta, APART * h + 2.0 * reach if itself else 0.0)
