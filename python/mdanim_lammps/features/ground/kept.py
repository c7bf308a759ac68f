# SPDX-License-Identifier: GPL-2.0-only
"""The ground in a trajectory."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...effects.kept import KeptRecord


@dataclass(frozen=True, slots=True)
class Ground(KeptRecord):
    """The floor plane."""

    height: float
    """[m]"""

    @classmethod
    def of(cls, scene, grid):
        return None if scene.ground is None else cls(scene.ground)

    @classmethod
    def read(cls, attributes, shapes):
        return cls(float(attributes["ground"])) if "ground" in attributes else None

    def write(self):
        return {"ground": self.height}

    def fault(self):
        return "" if math.isfinite(self.height) else "the ground is NaN or infinite"


KEPT = {"ground": Ground}
