# SPDX-License-Identifier: GPL-2.0-only
"""A crate: an elastic lattice of its own fineness, with four times its mass in the upper half."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mdanim_lammps.bodies import BodyKind
from mdanim_lammps.model import shapes
from mdanim_lammps.model.build import lattice_model


class Crate(BodyKind):
    """An object with ``crate``."""

    name, order = "crate", 50
    sets_spacing = False
    particle_bytes = 5000.0

    def takes(self, solid):
        return solid.crate > 0

    def cells(self, scene, solid):
        return solid.crate

    def spacing(self, scene, h):
        return lambda solid: shapes.thickness(solid.shape) / solid.crate

    def make(self, solid, h, shared):
        model = lattice_model(solid, h, shared)
        mass = np.where(model.position[:, 2] > solid.position[2], 4.0, 1.0) * model.mass
        return replace(model, mass=mass * (model.mass.sum() / mass.sum()))


KINDS = (Crate(),)
