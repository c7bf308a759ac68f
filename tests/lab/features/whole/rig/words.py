# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to the rig."""

from __future__ import annotations

from mdanim_lammps.scene.schema import Observable, Vector, setting

SWITCHES = {"rig": "`rig`"}

QUANTITIES = {("rig", "work"): Observable("J", "energy that the rig has brought in", "rig")}

MARGINS = {"shaking": "how fast held parts may shake"}


class RigWords:
    """Settings outside of all blocks."""

    rig: Vector = setting(
        "<(x, y, z):m>", "How far held parts shake. Absent: there is no rig.", "(0, 0, 1) cm", default=(0.0,) * 3
    )
    rig_memory: float = setting("<c:N/m>", "How much forces depend on what was before.", "2 N/m", default=0.0)


SCENE = RigWords
