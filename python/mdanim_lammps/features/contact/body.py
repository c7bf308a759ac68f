# SPDX-License-Identifier: GPL-2.0-only
"""A body that never moves is a surface with a depth: nothing of its inside is simulated."""

from __future__ import annotations

import math

from ...bodies import BodyKind, all_held, beneath, kind_of, only_features
from ...model import shapes
from ...model.build import lattice_model
from ...model.held import held_model
from ...scene.once import once_for
from ...scene.scene import Box, Mesh, Sphere
from .words import ContactModel

PLATE, COARSEST = 4.0, 2.5
"""Second side of the box around an object over its thickness from which it is a plate; and cells that may meet it over its
thickness: the edge of a plate holds a ball whose cells are 2.5 times as wide, not 5 times."""
ACROSS = 2
"""Cells across a plate that its depth takes, unless it is a cuboid: the least that have an inside."""


class HeldBody(BodyKind):
    """An object that is held as a whole. The points and the depth of its surface are as fine as the spacing says; its particles
    are the corners of a box, also where it is driven, as a whole. A liquid and barriers between particles ask for the lattice."""

    name = "held"
    order = 200

    def takes(self, solid):
        return all_held(solid)

    def cells(self, scene, solid):
        """The depth of a plate does not go by these, so that a shelf does not make cells of what lies on it fine."""
        return 1.0 / COARSEST if _is_plate(scene, solid) else super().cells(scene, solid)

    def least(self, scene, solid):
        return 1.0 / COARSEST if _is_plate(scene, solid) else super().least(scene, solid)

    def has_spacing(self, scene):
        return not only_features(scene)

    def spacing(self, scene, h):
        """As the scene, where something reads its surface, and fine enough for what lies on it."""
        if not only_features(scene):
            bare = any(beneath(scene, solid) for solid in scene.solids)
            return lambda solid: min(h, shapes.thickness(solid.shape) / max(1, beneath(scene, solid))) if bare else h
        return lambda solid: min(h, shapes.thickness(solid.shape) / 2)

    def particles(self, scene, solid, lattice, h):
        return 8.0 if only_surfaces_act(scene) else lattice

    def bare(self, scene, solid):
        """Where all touch by features nothing reads its cells, and of these shapes none are made."""
        return isinstance(solid.shape, Box | Sphere | Mesh) and only_features(scene)

    def make(self, solid, h, shared):
        if shared.inside or not only_surfaces_act(shared.scene):
            return lattice_model(solid, h, shared)
        exact = isinstance(solid.shape, Box) or not _is_plate(shared.scene, solid)
        across = math.inf if exact else shapes.thickness(solid.shape) / ACROSS
        return held_model(solid, h, shared, self.bare(shared.scene, solid), across)


def _is_plate(scene, solid) -> bool:
    """Whether an object is thin along one axis beside something elastic with an inside, as a shelf, a disc or a bowl, and nothing
    reads particles in it."""
    return only_surfaces_act(scene) and _has_elastic(scene) and is_flat(solid.shape)


def is_flat(shape: shapes.Shape) -> bool:
    """Whether a shape is thin along one axis of the box around it, and wide along both others."""
    low, high = shapes.extent(shape)
    return sorted(high - low)[1] >= PLATE * shapes.thickness(shape)


@once_for(lambda scene: scene)
def _has_elastic(scene) -> bool:
    """Whether an object with an inside can move and deform, and has the spacing of the scene."""
    return any(not all_held(s) and kind_of(s).fills and kind_of(s).deforms and s.resolution is None for s in scene.solids)


def only_surfaces_act(scene) -> bool:
    """Whether nothing in a scene reads particles inside of what never moves."""
    return scene.liquid is None and scene.control.contact_model is ContactModel.SURFACE


KINDS = (HeldBody(),)
