# SPDX-License-Identifier: GPL-2.0-only
"""Pieces in the file of glue of ``fix mdanim/rigid``: a line for each face between two (docs/fix_mdanim_rigid.md)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...effects.context import Context
from ...model import cut
from ...scene.formatting import in_full
from ...scene.once import once_for
from ...scene.scene import PieceShape, SceneRecord

EFFECT = "pieces"


@once_for(lambda scene: scene)
def wholes(scene: SceneRecord) -> tuple[tuple[int, int], ...]:
    """First piece of each object with pieces, and the one behind its last: their numbers in the scene."""
    found: list[tuple[int, int]] = []
    last = None
    for m, solid in enumerate(scene.solids):
        if not isinstance(solid.shape, PieceShape):
            last = None
        elif solid.shape.whole is last:
            found[-1] = (found[-1][0], m + 1)
        else:
            last = solid.shape.whole
            found.append((m, m + 1))
    return tuple(found)


def is_glued(context: Context) -> bool:
    """Whether there are pieces in a context that glue holds together."""
    return context.on(EFFECT) and any(isinstance(solid.shape, PieceShape) for solid in context.solids)


def lines(context: Context) -> Iterator[str]:
    """Pieces, their sides, strength and area, second moments, section moduli, middle, normal and first axis."""
    if not is_glued(context):
        return
    number = {name: m + 1 for m, name in enumerate(context.system.names)}
    scene = context.scene
    for first, _ in wholes(scene):
        if scene.solids[first].name not in number:
            continue
        shape = scene.solids[first].shape
        division = cut.division(shape.of, shape.how, shape.seed)
        for face in division.faces:
            one, other = scene.solids[first + face.a], scene.solids[first + face.b]
            turn = np.array(one.rotation)
            at = np.array(one.position) + turn @ (face.at - division.pieces[face.a].surface.centre)
            normal, axis = (turn @ face.axes[k] for k in (0, 1))
            values = [one.strength, face.area, *face.second, *face.section, *at.tolist(), *normal.tolist(), *axis.tolist()]
            yield f"{number[one.name]} {number[other.name]} {face.side_a} {face.side_b} {in_full(values)}\n"
