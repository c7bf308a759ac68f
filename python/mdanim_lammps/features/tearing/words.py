# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...scene.holding import all_held
from ...scene.limits import Limit
from ...scene.schema import Observable, Rule, setting
from ...scene.shapes import Rope, Sheet, Shell

SWITCHES = {"tearing": "an object's `tear-strain e`"}

QUANTITIES = {
    ("NAME", "torn"): Observable("1", "share of its springs that are gone, from 0 to 1", "tearing"),
    ("NAME", "pieces"): Observable("1", "parts of it that hang together; 1 before it tears", "tearing"),
}

LEDGER = {"torn": "energy of springs at the moment in which they broke"}

TEAR_STRAIN = Limit("tear-strain", 100.0, 1e-6, "0.1 for a thread, 5 for rubber")


class TearWords:
    """Settings of an object."""

    tear_strain: float | None = setting(
        "<e>",
        "Of what deforms: where it is stretched by more than this share of its length, it tears. Of a rope the weakest link, "
        "which the `seed` of `control` chooses, bears so much, the others a quarter more. Absent: it never tears.",
        "0.1", Rule.POSITIVE, default=None, limit=TEAR_STRAIN, after="damping", shared=True)  # fmt: skip
    """[-]; None for never."""
    toughness: float | None = setting(
        "<G:N/m>",
        "In place of tear-strain: the energy that a tear takes for each area that it opens, whatever the spacing of particles.",
        "50 J/m^2", Rule.POSITIVE, default=None, after="tear-strain", shared=True)  # fmt: skip
    """[J/m^2]; None where a strain is given, or for never."""


OBJECT = TearWords


def tears(solid: Any) -> bool:
    """Whether springs of an object may break."""
    if solid.tear_strain is None and solid.toughness is None:
        return False
    return not all_held(solid)


def word_of(solid: Any) -> str:
    """The word by which it tears."""
    return "toughness" if solid.tear_strain is None else "tear-strain"


def fills(solid: Any) -> bool:
    """Whether an object fills a volume with cells."""
    return not isinstance(solid.shape, (Rope, Sheet, Shell))


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """No rigid object tears, and no rope is torn to begin with."""
    word = word_of(solid)
    if word not in solid.spans:
        return solid
    span, rope = solid.spans[word], solid.shape
    if "toughness" in solid.spans and word == "tear-strain":
        cause = f"{solid.name} has a tear-strain, which then follows from its toughness"
        v.problem(solid.spans["toughness"], cause, "write one of the two")
    if getattr(solid.elasticity, "modulus", 0.0) == math.inf:
        cause = f"{solid.name} is rigid: it has no springs that could break"
        v.problem(span, cause, f"write its elasticity, as in elasticity 1 MPa, or take {word} out")
    elif (
        isinstance(rope, Rope)
        and word == "tear-strain"
        and (stretched := rope.curve.length / rope.length - 1.0) > solid.tear_strain
    ):
        cause = (
            f"{solid.name} is stretched by {100 * stretched:.3g} % from the start, and tears at {100 * solid.tear_strain:.3g} %"
        )
        v.problem(span, cause, "write a larger tear-strain, or a length nearer to the distance of its ends")
    return solid


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """A liquid finds objects by their cells, of which those that are torn do not tell where the object is."""
    if held.get("liquid") is None:
        return
    for solid in [s for s in held["solids"] if tears(s) and fills(s)][:1]:
        cause = f"{solid.name} may tear, and a liquid finds objects by their cells, which are then torn"
        v.problem(solid.spans[word_of(solid)], cause, "take the liquid out, or the tearing", key="tear-liquid")


CHECKS = {"object": check_object}
