# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from enum import Enum
from typing import Any

from ...scene.holding import all_held
from ...scene.schema import Words, setting

SWITCHES = {"folds": "an object with `touches-itself`, two sheets that may meet, or an object that may tear"}


class Itself(Enum):
    """Whether an object touches itself."""

    YES, NO = "yes", "no"


class FoldWords:
    """Settings of an object."""

    touches_itself: Itself = setting(
        "<yes|no>",
        "Folds of it touch each other: a letter, a towel that is thrown, a coil of rope. Ropes and sheets that both have it "
        "touch each other, too; sheets do so where they may meet. It takes time in every step.",
        "yes", default=Itself.NO, codec=Words(Itself), after="restitution")  # fmt: skip


OBJECT = FoldWords


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """An object that does not deform has no folds."""
    if solid.touches_itself is not Itself.YES:
        return solid
    rigid = not hasattr(solid.elasticity, "modulus") or type(solid.elasticity).__name__ == "Rigid"
    if all_held(solid) or rigid:
        cause = f"{solid.name} does not deform, and never touches itself"
        v.problem(solid.spans["touches-itself"], cause, "leave it out")
    return solid


CHECKS = {"object": check_object}
