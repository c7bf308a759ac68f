# SPDX-License-Identifier: GPL-2.0-only
"""Rigid against elastic, for studies."""

from __future__ import annotations

import numpy as np

from ...effects.varied import Varied
from .proposal import LADDER, as_rigid, groups


class AsRigid(Varied):
    """Elastic objects as they are, None, or rigid wherever their words allow it, 1."""

    name, letter, order, color = LADDER, "r", 30, "#8c564b"
    usual, word, converges = None, "elasticity rigid", False

    def of(self, scene):
        return None

    def put(self, scene, value):
        found = groups(scene) if value else {}
        return as_rigid(scene, np.concatenate(list(found.values())).tolist()) if found else scene

    def said(self, scene):
        return False

    def why_not(self, context):
        return "" if groups(context.scene) else "no elastic object may be rigid as its words are"

    def ladder(self, value):
        return (1, None)

    def size(self, value):
        return 1.0 if value is None else 2.0

    def told(self, value, number=str):
        return ", elasticity rigid" if value else ""

    def shown(self, value):
        return "rigid" if value else "elastic"


VARIED = (AsRigid(),)
