# SPDX-License-Identifier: GPL-2.0-only
"""The scene's own checks: every ``expect`` line, measured after the run."""

from __future__ import annotations

import math
import operator

import numpy as np

from ..effects.measured import Measurable, Measured
from ..records import dataclass
from ..scene.formatting import number
from ..scene.scene import Expect
from .quantities import quantity_of

ROUNDING = 1e-12
"""Relative error of a value that was read from text [-]."""
BOUNDS = {
    "<": operator.lt,
    ">": operator.gt,
    "<=": lambda found, value: found <= value + ROUNDING * abs(value),
    ">=": lambda found, value: found >= value - ROUNDING * abs(value),
}
"""Whether what is found keeps a bound."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The demand of an ``expect`` line and the value found."""

    expect: Expect
    found: float

    @property
    def met(self) -> bool:
        # A NaN is never met; the last digit of a value read from text is forgiven.
        e = self.expect
        if e.relation != "=":
            return BOUNDS[e.relation](self.found, e.value)
        return abs(self.found - e.value) <= e.tolerance + ROUNDING * max(abs(e.value), e.tolerance)

    def __str__(self) -> str:
        verdict = "met" if self.met else "MISSED"
        place = f"{self.expect.span}: " if self.expect.span else ""
        told = f"found {number(self.found, 6)}"
        if math.isnan(self.found):
            told = f"it has no value then (mdanim-lammps explain {self.expect.quantity} tells of it)"
        return f"{place}expect {self.what} {self.asked}: {told}, {verdict}"

    @property
    def what(self) -> str:
        """``max ball.speed from 0 s to 1 s``"""
        e = self.expect
        if e.begin is not None:
            return f"{e.said} from {number(e.begin, 6)} s to {number(e.time, 6)} s"
        return e.said if e.time is None else f"{e.said} at {number(e.time, 6)} s"

    @property
    def asked(self) -> str:
        """``= 0.12 +- 0.01``, ``< 0.1``"""
        e = self.expect
        return f"{e.relation} {number(e.value, 6)}" + (f" +- {number(e.tolerance, 6)}" if e.relation == "=" else "")

    def to_json(self) -> dict:
        """A row of summary.json."""
        e = self.expect
        return {
            "what": e.said,
            "time": e.time,
            "from": e.begin,
            "relation": e.relation,
            "value": e.value,
            "tolerance": e.tolerance,
            "found": self.found if math.isfinite(self.found) else None,
            "met": self.met,
        }


def evaluate(expects: tuple[Expect, ...], measured: Measured) -> list[Outcome]:
    """Measure every expectation. What needs an effect is refused before a run in which that is off."""
    return [Outcome(e, _found(e, quantity_of(e), measured)) for e in expects]


def _found(e: Expect, quantity: Measurable, m: Measured) -> float:
    """The value at a time; of a window, or with ``over``, that of all frames in it."""
    if e.begin is None and not e.over:
        return quantity.value(m, e, e.time)
    begin, end = (m.times[0], m.times[-1]) if e.begin is None else (e.begin, e.time)
    if e.over == "mean":
        return quantity.mean(m, e, begin, end)
    values = quantity.within(m, e, begin, end)[1]
    if e.over:
        return float({"min": np.min, "max": np.max}[e.over](values))
    return float(_worst(e, values))


def _worst(e: Expect, values: np.ndarray) -> float:
    """The value of a window that keeps what is expected the least."""
    if e.relation in ("<", "<="):
        return values.max()
    return values.min() if e.relation in (">", ">=") else values[np.abs(values - e.value).argmax()]
