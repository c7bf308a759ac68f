# SPDX-License-Identifier: GPL-2.0-only
"""The objects that an object with pieces stands for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...model import cut
from ...model.creased import may_move
from ...model.mesh import MeshError
from ...scene.scene import PieceShape, Solid
from .names import piece_name, seed_of


def pieces_of(v: Any, solid: Solid) -> tuple[Solid, ...]:
    """The pieces of an object where it stands, with the mass of the whole together and its motion; of one without pieces, itself.
    v is the scene/validate.Validator."""
    if solid.pieces is None or v.problems.errors:
        return (solid,)
    seed = seed_of(v, solid.name)
    try:
        division = cut.division(solid.shape, solid.pieces, seed)
    except MeshError as error:
        v.problem(solid.spans["pieces"], f"{solid.name} cannot be cut into pieces: {error}", error.hint)
        return ()
    shapes = [PieceShape(of=solid.shape, how=solid.pieces, seed=seed, number=alike, whole=solid) for alike in division.alike]
    unclean = [n for n, shape in enumerate(shapes) if division.pieces[n].polyhedron is None and not may_move(shape)]
    if unclean:
        cause = f"{piece_name(solid.name, unclean[0])} has edges or faces too small for contact by features"
        v.problem(
            solid.spans["pieces"], cause, "write another seed in control, a few pieces more, or a mesh of some hundred triangles"
        )
        return ()
    turn, spin, velocity = (np.array(x) for x in (solid.rotation, solid.spin, solid.velocity))
    volume, found = division.volume, []
    for n, piece in enumerate(division.pieces):
        arm = turn @ piece.surface.centre
        share = piece.surface.volume / volume
        found.append(
            replace(
                solid,
                name=piece_name(solid.name, n),
                shape=shapes[n],
                position=tuple((np.array(solid.position) + arm).tolist()),
                velocity=tuple((velocity + np.cross(spin, arm)).tolist()),
                mass=None if solid.mass is None else solid.mass * share,
                pieces=None,
            )
        )
    return tuple(found)


DIVIDES = {"object": pieces_of}
