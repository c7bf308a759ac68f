# SPDX-License-Identifier: GPL-2.0-only
"""Effects that push solids back have two forms, one for each contact model."""

from __future__ import annotations

import numpy as np

from ...effects.effect import Effect
from ...model.system import System
from ...scene.formatting import number
from ...scene.scene import SceneRecord
from .words import ContactModel


class Form(Effect):
    """One form of such an effect; that of the paper may have that of surfaces beside it."""

    touches = at_surfaces = True

    def __init__(self, on_surfaces: Form | None = None):
        self.on_surfaces = on_surfaces
        """The effect that takes its place under ``contact-model surface``."""

    @property
    def forms(self):
        return (self, self.on_surfaces) if self.on_surfaces else (self,)

    def of(self, scene):
        return self.forms[-1] if scene.control.contact_model is ContactModel.SURFACE else self


def particle_stiffness(scene: SceneRecord, system: System) -> np.ndarray:
    """Stiffness of a particle in contact with barriers and walls [N/m], shape (N,).

    E h of its solid times the scene's factor, less where few cells stand behind it: min(1, 2 n/8), one half on an edge, a
    quarter in a corner (docs/physics-contact.md). Two of them in series make a pair's k: 2 s_i s_j / (s_i + s_j).
    """
    full = scene.control.contact_stiffness * system.young * np.cbrt(system.cell_volume)
    return full[system.object] * np.minimum(1.0, 2.0 * system.share)


def stiffness_told(scene: SceneRecord) -> str:
    """Addition to the reason of an effect that pushes back, about ``contact-stiffness``; empty where it is the usual one."""
    factor = scene.control.contact_stiffness
    return "" if factor == 1.0 else f", {number(factor)} times as stiff as usual"
