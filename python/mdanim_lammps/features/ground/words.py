# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from ...scene.schema import setting

SWITCHES = {"ground": "`ground`"}


class GroundWords:
    """Settings outside of all blocks."""

    ground: float | None = setting("z <h:m>", "A floor plane at height h. Absent: no floor.", "z 0 m", default=None)
    """Height of the ground plane [m]."""


SCENE = GroundWords

TOUCHED = {"ground": ""}

MISPLACED = {
    "ground x": "the ground is level, at a height z; for a wall across x write walls from (-2, -2, 0) m to (2, 2, 3) m",
    "ground y": "up is z: write ground z 0 m; for a wall across y write walls from (-2, -2, 0) m to (2, 2, 3) m",
}


def touched(scene) -> bool:
    """Whether it brings something into a scene that objects may touch."""
    return scene.ground is not None
