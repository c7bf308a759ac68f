# SPDX-License-Identifier: GPL-2.0-only
"""A body that never moves is a surface with a depth: nothing of its inside is simulated."""

from __future__ import annotations

from ...bodies import BodyKind, all_held, beneath, kind_of, only_features
from ...model import shapes
from ...model.build import lattice_model
from ...model.held import held_model
from ...scene.once import once_for
from ...scene.scene import Box, Mesh, Sphere
from .words import ContactModel


class HeldBody(BodyKind):
    """An object that is held as a whole. The points and the depth of its surface are as fine as the spacing says; its particles
    are the corners of a box, also where it is driven, as a whole. A liquid and barriers between particles ask for the lattice."""

    name = "held"
    order = 200

    def takes(self, solid):
        return all_held(solid)

    def asks(self, scene):
        """None where its surface alone counts and something else sets the spacing: a thin shelf does not ask for fine cells
        of what falls onto it."""
        others = only_surfaces_act(scene) and any(solid.resolution is None for solid in _soft(scene))
        return lambda solid: not others

    def has_spacing(self, scene):
        return not only_features(scene)

    def spacing(self, scene, h):
        """As the scene, where something reads its surface, no coarser than two cells across but for a cuboid, whose depth is
        exact, and fine enough for what lies on it."""
        if not (only_features(scene) or only_surfaces_act(scene)):
            return lambda solid: h
        return lambda s: h if self.thinner(scene, s) else min(h, shapes.thickness(s.shape) / max(2, beneath(scene, s)))

    def thinner(self, scene, solid):
        """A cuboid may be so for what falls onto it: its depth is exact, and its points are as far apart as those of others."""
        return isinstance(solid.shape, Box) and only_surfaces_act(scene) and bool(_soft(scene))

    def particles(self, scene, solid, lattice, h):
        return 8.0 if only_surfaces_act(scene) else lattice

    def bare(self, scene, solid):
        """Where all touch by features nothing reads its cells, and of these shapes none are made."""
        return isinstance(solid.shape, Box | Sphere | Mesh) and only_features(scene)

    def make(self, solid, h, shared):
        if shared.inside or not only_surfaces_act(shared.scene):
            return lattice_model(solid, h, shared)
        return held_model(solid, h, shared, self.bare(shared.scene, solid))


@once_for(lambda scene: scene)
def _soft(scene) -> list:
    """Objects with an inside that can move and whose thinnest parts may set the spacing of the scene."""
    return [s for s in scene.solids if not all_held(s) and kind_of(s).fills and kind_of(s).sets_spacing]


def only_surfaces_act(scene) -> bool:
    """Whether nothing in a scene reads particles inside of what never moves."""
    return scene.liquid is None and scene.control.contact_model is ContactModel.SURFACE


KINDS = (HeldBody(),)
