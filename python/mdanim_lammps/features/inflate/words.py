# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from typing import Any, ClassVar

from ...records import dataclass
from ...scene.formatting import number
from ...scene.schema import Observable, OneOf, setting
from ...scene.shapes import Shell

SWITCHES = {"inflate": "an object's `inflate p`"}

QUANTITIES = {
    ("NAME", "pressure"): Observable("Pa", "pressure of the gas in an object above that outside", "inflate"),
    ("NAME", "volume"): Observable("m^3", "volume that the surface of an inflated object encloses", "inflate"),
}

LEDGER = {
    "gas": "what the gas in inflated objects can still give, until its pressure is that outside [J]",
    "gas_loss": "what it could still give when their sheets tore",
}
"""Columns of the ledger."""

OUTSIDE = 101325.0
"""Pressure outside where a scene does not say it [Pa]."""


@dataclass(frozen=True, slots=True)
class Inflate:
    """Gas in an object."""

    FORMS: ClassVar = ("<p:Pa> [outside <p0:Pa>]",)
    pressure: float
    """Above that outside, at the start [Pa]."""
    outside: float = OUTSIDE
    """[Pa]"""

    @classmethod
    def read(cls, form: int, values: tuple) -> Inflate:
        """Raises ValueError(message, hint, number of the value)."""
        over, outside = values
        outside = OUTSIDE if outside is None else outside
        if over < 0.0:
            raise ValueError(
                f"inflate has a pressure above that outside: found {number(over, 6)} Pa",
                "write inflate 0 Pa for gas that is shut in as it is",
                0,
            )
        if outside < 0.0:
            raise ValueError(f"a pressure outside of {number(outside, 6)} Pa", "write outside 0 Pa for nothing outside", 1)
        if over + outside == 0.0:
            raise ValueError("there is no gas: nothing inside and nothing outside", "write inflate 2 kPa", 0)
        return cls(over, outside)

    def write(self) -> tuple[int, tuple]:
        """Form and values that are read as this."""
        return 0, (self.pressure, None if self.outside == OUTSIDE else self.outside)


class InflateWords:
    """Settings of an object."""

    inflate: Inflate | None = setting(
        None,
        "Gas in a closed sheet: the pressure p at the start, above the pressure p0 outside, 101 325 Pa where it is not said. The "
        "gas keeps its temperature: (p + p0) V stays as it is. The sheet is free of tension at the start, and swells until its "
        "own tension bears p ([how](physics-inflate.md)).",
        "2 kPa", default=None, codec=OneOf(Inflate), after="shape")  # fmt: skip


OBJECT = InflateWords


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Gas is in what is hollow."""
    if solid.inflate is not None and not isinstance(solid.shape, Shell):
        kind = type(solid.shape).__name__.lower()
        cause = f"{solid.name} is a {kind}, which has no room for gas: inflate is for closed sheets"
        v.problem(
            solid.spans["inflate"], cause, "write sheet thickness 1 mm behind a shape such as sphere 10 cm, or leave it out"
        )
    return solid


CHECKS = {"object": check_object}
