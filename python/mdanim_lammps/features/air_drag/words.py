# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from ...scene.schema import Rule, setting

SWITCHES = {"air-drag": "an object's `drag`"}


class DragWords:
    """Settings of an object."""

    drag: float = setting(
        "<lambda:N*s/m>", "Air drag of the whole object, F = -lambda v, eq. (3.9).",
        "0.5 N*s/m", Rule.NOT_NEGATIVE, default=0.0, after="spin")  # fmt: skip
    """lambda of the whole object, eq. (3.9) [N*s/m]."""


OBJECT = DragWords
