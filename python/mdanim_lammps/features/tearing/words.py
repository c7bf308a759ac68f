# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from typing import Any

from ...scene.formatting import with_article
from ...scene.limits import Limit
from ...scene.schema import Observable, Rule, setting
from ...scene.shapes import HoldAll, Rope

SWITCHES = {"tearing": "a rope's `tear-strain e`"}

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
        "Of a rope or chain: where it is stretched by more than this share of its length, it tears. Its weakest link, which the "
        "`seed` of `control` chooses, bears so much, the others a quarter more. Absent: it never tears.",
        "0.1", Rule.POSITIVE, default=None, limit=TEAR_STRAIN, after="damping", shared=True)  # fmt: skip
    """[-]; None for never."""


OBJECT = TearWords


def tears(solid: Any) -> bool:
    """Whether springs of an object may break."""
    return solid.tear_strain is not None and not any(isinstance(hold, HoldAll) for hold in solid.hold)


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Only ropes tear, and none that is torn to begin with."""
    if solid.tear_strain is None:
        return solid
    span, rope = solid.spans["tear-strain"], solid.shape
    if not isinstance(rope, Rope):
        kind = with_article(type(rope).FORMS[0].split()[0])
        cause = f"{solid.name} is {kind}, and only ropes and chains tear"
        v.problem(span, cause, "leave it out, or build the object of parts that joints with breaks hold together")
    elif (stretched := rope.curve.length / rope.length - 1.0) > solid.tear_strain:
        cause = (
            f"{solid.name} is stretched by {100 * stretched:.3g} % from the start, and tears at {100 * solid.tear_strain:.3g} %"
        )
        v.problem(span, cause, "write a larger tear-strain, or a length nearer to the distance of its ends")
    return solid


CHECKS = {"object": check_object}
