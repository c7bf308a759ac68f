# SPDX-License-Identifier: GPL-2.0-only
"""A rigid body: few particles without springs, which show where it is, and the moments of inertia of its shape."""

from __future__ import annotations

import math
from dataclasses import replace

from ...bodies import BodyKind, all_held, kind_of
from ...model import shapes
from ...model.build import lattice_model
from ...model.inertia import tensor
from .words import Rigid

ACROSS = 2
"""Cells across its thinnest part, the least that have an inside, where nothing needs more."""


class RigidBody(BodyKind):
    """An object with ``elasticity rigid``. Its particles are points of the body: a lattice of hexahedra without springs."""

    name = "rigid"
    order = 100
    deforms = sets_spacing = False
    particle_bytes = 500.0

    def takes(self, solid):
        return isinstance(solid.elasticity, Rigid)

    def cells(self, scene, solid):
        return ACROSS if scene.liquid is None else super().cells(scene, solid)

    def spacing(self, scene, h):
        """Two cells across; no coarser than the scene where there is a liquid or something soft, whose forces find the body at
        its particles and at points as far apart as these."""
        finest = h if scene.liquid is not None or any(is_soft(s) for s in scene.solids) else math.inf
        return lambda solid: min(finest, shapes.thickness(solid.shape) / ACROSS)

    def make(self, solid, h, shared):
        model = lattice_model(solid, h, shared, loose=True)
        return model if all_held(solid) else replace(model, inertia=tensor(solid.shape, shapes.mass(solid), solid.rotation))


def is_soft(solid) -> bool:
    """Whether an object moves and deforms."""
    return kind_of(solid).deforms and not all_held(solid)


KINDS = (RigidBody(),)
