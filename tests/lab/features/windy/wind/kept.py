# SPDX-License-Identifier: GPL-2.0-only
"""The wind in a trajectory."""

from __future__ import annotations

from dataclasses import dataclass

from mdanim_lammps.effects.kept import KeptRecord
from mdanim_lammps.scene.schema import Vector


@dataclass(frozen=True, slots=True)
class Weather(KeptRecord):
    """The air."""

    UNLIKE = "winds"

    wind: Vector
    """[m/s]"""

    @classmethod
    def of(cls, scene, grid):
        return cls(scene.wind) if any(scene.wind) else None

    def fault(self):
        return "" if len(self.wind) == 3 else "the wind is not a vector"


class WindTrack:
    """Property of a trajectory with wind."""

    @property
    def wind(self):
        """[m/s]; None where it is at rest."""
        return self.metadata.kept["wind"].wind if "wind" in self.metadata.kept else None


KEPT, Track = {"wind": Weather}, WindTrack
