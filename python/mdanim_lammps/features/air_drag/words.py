# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from typing import Any

from ...scene.holding import all_held
from ...scene.schema import Rule, setting

SWITCHES = {"air-drag": "an object's `drag`"}


class DragWords:
    """Settings of an object."""

    drag: float = setting(
        "<lambda:N*s/m>", "Air drag of the whole object, F = -lambda v, eq. (3.9).",
        "0.5 N*s/m", Rule.NOT_NEGATIVE, default=0.0, after="spin")  # fmt: skip
    """lambda of the whole object, eq. (3.9) [N*s/m]."""


OBJECT = DragWords


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Air slows what can move."""
    if all_held(solid) and solid.drag:
        cause = f"{solid.name} is held as a whole, and its drag is not used"
        v.problem(
            solid.spans["drag"], cause, f"leave out the drag or the hold{block.where}", "warning", ("drag", id(block.group))
        )
    return solid


CHECKS = {"object": check_object}
