# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to the wind."""

from __future__ import annotations

from mdanim_lammps.scene.schema import Observable, Vector, setting

SWITCHES = {"wind": "`wind`"}

QUANTITIES = {("wind", "work"): Observable("J", "work of the wind since the start", "wind")}

MARGINS = {"gust": "how fast the wind may be; above it sails tear"}


class WindWords:
    """Settings outside of all blocks."""

    wind: Vector = setting(
        "<(wx, wy, wz):m/s>", "Velocity of the air. Absent: it is at rest.", "(3, 0, 0) m/s", default=(0.0,) * 3
    )


SCENE = WindWords
