# SPDX-License-Identifier: GPL-2.0-only
"""The scene's own checks: every ``expect`` line, measured after the run."""

from __future__ import annotations

import operator
from dataclasses import dataclass
from functools import lru_cache

from ..effects.measured import Measure, Measured, Recorded
from ..features import facets
from ..scene.formatting import number
from ..scene.scene import GLOBALS, Expect

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
        e = self.expect
        when = "" if e.time is None else f" at {number(e.time, 6)} s"
        verdict = "met" if self.met else "MISSED"
        place = f"{e.span}: " if e.span else ""
        return f"{place}expect {e.what}{when} {self.asked}: found {number(self.found, 6)}, {verdict}"

    @property
    def asked(self) -> str:
        """``= 0.12 +- 0.01``, ``< 0.1``"""
        e = self.expect
        return f"{e.relation} {number(e.value, 6)}" + (f" +- {number(e.tolerance, 6)}" if e.relation == "=" else "")


def evaluate(expects: tuple[Expect, ...], measured: Measured) -> list[Outcome]:
    """Measure every expectation. What needs an effect is refused before a run in which that is off."""
    return [Outcome(e, _measure(e, measured)) for e in expects]


@lru_cache(maxsize=1)
def measures() -> dict[tuple[str, str], Measure]:
    """How features find their quantities, by subject and word as in scene.QUANTITIES."""
    return {of: measure for facet in facets("measure") for of, measure in getattr(facet, "MEASURES", {}).items()}


@lru_cache(maxsize=1)
def recordable() -> dict[str, Recorded]:
    """Quantities of objects that need all particles at every frame."""
    return {word: found for facet in facets("measure") for word, found in getattr(facet, "RECORDED", {}).items()}


def recorded(expects: tuple[Expect, ...]) -> dict[tuple[str, str], str]:
    """Quantities that must be recorded during the run: (solid, quantity) to the ledger's column, in order and once."""
    return {(e.subject, e.quantity): _column(e) for e in expects if e.quantity in recordable()}


def _column(e: Expect) -> str:
    return f"{recordable()[e.quantity].column}.{e.subject}"


def _measure(e: Expect, m: Measured) -> float:
    if e.quantity in recordable():
        return recordable()[e.quantity].measure(m, m.ledger(_column(e)), e.time)
    if (e.subject, e.quantity) == ("energy", "residual"):
        return m.largest(m.ledger("residual"), e.time)
    return measures()[e.subject if e.subject in GLOBALS else "NAME", e.quantity](m, e)
