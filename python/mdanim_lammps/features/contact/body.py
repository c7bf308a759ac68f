# SPDX-License-Identifier: GPL-2.0-only
"""A body that never moves is a surface with a depth: nothing of its inside is simulated."""

from __future__ import annotations

from ...bodies import BodyKind, all_held, beneath, only_features
from ...model import shapes
from ...model.build import lattice_model
from ...model.held import held_model
from ...scene.scene import Box, Mesh, Sphere
from .words import ContactModel


class HeldBody(BodyKind):
    """An object that is held as a whole. The points and the depth of its surface are as fine as the spacing says; its particles
    are the corners of a box, also where it is driven, as a whole. A liquid and barriers between particles ask for the lattice."""

    name = "held"
    order = 200

    def takes(self, solid):
        return all_held(solid)

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
        return held_model(solid, h, shared, self.bare(shared.scene, solid))


def only_surfaces_act(scene) -> bool:
    """Whether nothing in a scene reads particles inside of what never moves."""
    return scene.liquid is None and scene.control.contact_model is ContactModel.SURFACE


KINDS = (HeldBody(),)
