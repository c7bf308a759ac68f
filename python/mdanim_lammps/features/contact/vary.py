# SPDX-License-Identifier: GPL-2.0-only
"""The stiffness of contact, for studies."""

from __future__ import annotations

from dataclasses import replace

from ...effects.varied import Varied
from ...scene.formatting import number
from .words import CONTACT_STIFFNESS

PRESSED = 1.3
"""Part of contact in the bound over that of springs, at a corner and a ``contact-stiffness`` of 1 (docs/physics-contact.md)."""


class Stiffness(Varied):
    """``contact-stiffness``: the depth that a load presses surfaces into each other goes with 1/√stiffness."""

    name, letter, order, color = "contact", "k", 20, "#9467bd"
    usual, word, finer_is, by_depth = 1.0, "contact-stiffness", "stiffer contact", True

    def of(self, scene):
        return scene.control.contact_stiffness

    def put(self, scene, value):
        return replace(scene, control=replace(scene.control, contact_stiffness=value))

    def said(self, scene):
        return self.of(scene) != self.usual or self.word in scene.control.spans

    def why_not(self, context):
        if any(e.presses for e in context.resolved.effects):
            return ""
        return f"nothing touches: {context.resolved.verdicts['contact'].reason}, and there is neither ground nor walls"

    def ladder(self, value):
        least, most = CONTACT_STIFFNESS.least, CONTACT_STIFFNESS.most
        return (x for k in (-2, -1, 0, 1, 2, 3) if least <= (x := value * 2.0**k) <= most)

    def size(self, value):
        return value**-0.5  # a load goes with the square of the depth

    def finer(self, value, times):
        # Contact sinks in less by as much as the spacing is smaller.
        stiffer = min(max(value * times**2, CONTACT_STIFFNESS.least), CONTACT_STIFFNESS.most)
        return float(number(stiffer, 6))

    def stiffness(self, value):
        return 1.0 + PRESSED * value


VARIED = (Stiffness(),)
