# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

import math
from typing import Any

from ...scene.holding import all_held
from ...scene.limits import Limit
from ...scene.schema import Observable, Rule, setting

SWITCHES = {"yielding": "an object's `yield-strain e`"}

QUANTITIES = {
    ("NAME", "yielded"): Observable("1", "largest change of a rest length for good, over that at the start", "yielding")
}

MARGINS = {
    "yielding": "energy of motion of each volume over the stress at which an object yields; above about 0.15 cells are crushed"
}

LEDGER = {"yielding": "work of springs that yield"}

YIELD_STRAIN = Limit("yield-strain", 10.0, 1e-6, "0.02 for clay, 0.002 for a metal")


class YieldWords:
    """Settings of an object."""

    yield_strain: float | None = setting(
        "<e>",
        "Of what deforms: a strain beyond this one stays, and nothing bears more than at it. A sheet stays bent by what its "
        "faces are strained beyond 1.5 times of it. Absent: it always springs back.",
        "0.02", Rule.POSITIVE, default=None, limit=YIELD_STRAIN, after="toughness", shared=True)  # fmt: skip
    """[-]; None for never."""


OBJECT = YieldWords


def yields(solid: Any) -> bool:
    """Whether springs of an object may yield."""
    return solid.yield_strain is not None and not all_held(solid)


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Only what is elastic and can move yields."""
    if solid.yield_strain is None or "yield-strain" not in solid.spans:
        return solid
    span = solid.spans["yield-strain"]
    if getattr(solid.elasticity, "modulus", 0.0) == math.inf:
        cause = f"{solid.name} is rigid: it has no springs that could yield"
        v.problem(span, cause, "write its elasticity, as in elasticity 1 MPa, or take yield-strain out")
    elif all_held(solid):
        v.problem(span, f"{solid.name} is held as a whole: it keeps its form", "take yield-strain out, or hold less of it")
    return solid


CHECKS = {"object": check_object}
