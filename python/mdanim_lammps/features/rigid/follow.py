# SPDX-License-Identifier: GPL-2.0-only
"""Objects that are held as a whole: what they need not say, because they do not bend, and nothing asks for their mass."""

from __future__ import annotations

from typing import Any

from ...scene.keywords import KEYWORDS
from ...scene.shapes import HoldAll
from ..drives.words import RELEASE
from .words import Rigid

DENSITY = 1000.0
"""Density of what is held and says none [kg/m^3]."""


def fill(v: Any) -> None:
    """Give it these where it has none; v is the scene/validate.Validator. What is let go has to say them, and so do ropes and
    sheets, which are not rigid."""
    for block in v.blocks("object"):
        held = next((s for s in block.settings.get("hold", ()) if s.kind is HoldAll), None)
        shape, said = block.first("shape"), block.words()
        if held is None or RELEASE in said or (shape is not None and getattr(shape.kind, "BENDS", False)):
            continue
        for word, value in (("elasticity", Rigid()), ("density", DENSITY)):
            if word not in said:
                block.settings[word] = [held.following(KEYWORDS["object"][word], value)]


def explained() -> dict[str, str]:
    """No names of its own."""
    return {}
