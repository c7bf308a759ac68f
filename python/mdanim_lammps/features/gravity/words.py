# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from ...scene.schema import Vector, setting

SWITCHES = {"gravity": "a gravity vector that is not zero"}


class GravityWords:
    """Settings outside of all blocks."""

    gravity: Vector = setting(
        "<(gx, gy, gz):m/s^2>",
        "Acceleration of free fall. Absent or zero: no gravity effect at all. With a liquid it must point along -z.",
        "(0, 0, -9.81) m/s^2", default=(0.0, 0.0, 0.0))  # fmt: skip
    """[m/s^2]"""


SCENE = GravityWords
