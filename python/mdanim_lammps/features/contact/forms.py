# SPDX-License-Identifier: GPL-2.0-only
"""Effects that push solids back have two forms, one for each contact model."""

from __future__ import annotations

from ...effects.effect import Effect
from ...scene.formatting import number
from ...scene.scene import ContactModel, SceneRecord


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


def stiffness_told(scene: SceneRecord) -> str:
    """Addition to the reason of an effect that pushes back, about ``contact-stiffness``; empty where it is the usual one."""
    factor = scene.control.contact_stiffness
    return "" if factor == 1.0 else f", {number(factor)} times as stiff as usual"
