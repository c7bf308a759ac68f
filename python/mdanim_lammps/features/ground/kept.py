# SPDX-License-Identifier: GPL-2.0-only
"""The ground in a trajectory."""

from __future__ import annotations

import math

from ...effects.kept import KeptRecord
from ...records import dataclass


@dataclass(frozen=True, slots=True)
class Ground(KeptRecord):
    """The floor plane."""

    ground: float
    """Its height [m]."""

    @classmethod
    def of(cls, scene, grid):
        return None if scene.ground is None else cls(scene.ground)

    def fault(self):
        return "" if math.isfinite(self.ground) else "the ground is NaN or infinite"


KEPT = {"ground": Ground}
