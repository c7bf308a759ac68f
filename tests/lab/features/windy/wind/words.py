# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to the wind."""

from __future__ import annotations

from mdanim_lammps.scene.schema import Observable, Rule, Vector, setting

SWITCHES = {"wind": "`wind`"}

QUANTITIES = {("wind", "work"): Observable("J", "work of the wind since the start", "wind")}

MARGINS = {"gust": "how fast the wind may be; above it sails tear"}


class WindWords:
    """Settings outside of all blocks."""

    wind: Vector = setting(
        "<(wx, wy, wz):m/s>", "Velocity of the air. Absent: it is at rest.", "(3, 0, 0) m/s", default=(0.0,) * 3
    )
    lulls: int = setting("<n>", "How often the wind is looked up.", "2", Rule.COUNT, default=1)


SCENE = WindWords


class SailWords:
    """Settings of an object."""

    sail: float = setting(
        "<A:m^2>", "Its sail. Absent: as large as particles have it.", "2 m^2", Rule.POSITIVE, default=1.0, after="density"
    )


OBJECT = SailWords
