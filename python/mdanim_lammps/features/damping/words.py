# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from ...scene.limits import Limit
from ...scene.schema import Rule, setting

SWITCHES = {"damping": "an object's `damping`"}

DAMPING = Limit("damping", 100.0, way_out="1 is critical damping: nothing vibrates any more")


class DampingWords:
    """Settings of an object."""

    damping: float = setting(
        "<zeta>", "Internal damping, as a fraction of critical damping in each spring.",
        "0.05", Rule.NOT_NEGATIVE, default=0.0, limit=DAMPING, after="density", shared=True)  # fmt: skip
    """Fraction of critical damping at the bond level [-]."""


OBJECT = DampingWords
