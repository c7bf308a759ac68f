# SPDX-License-Identifier: GPL-2.0-only
"""Numbers and quantities for messages, written as people do and as they may be written in a scene, and for programs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from decimal import Decimal

PREFIXED = {
    "m": (("m", 1.0, 1.0), ("cm", 1e-2, 1e-2), ("mm", 1e-3, 0.0)),
    "m^3": (("m^3", 1.0, 1.0), ("l", 1e-3, 0.0)),
    "s": (("s", 1.0, 0.1), ("ms", 1e-3, 0.0)),
    "kg": (("kg", 1.0, 1.0), ("g", 1e-3, 0.0)),
    "N": (("kN", 1e3, 1e3), ("N", 1.0, 0.0)),
    "Pa": (("GPa", 1e9, 1e9), ("MPa", 1e6, 1e6), ("kPa", 1e3, 1e3), ("Pa", 1.0, 0.0)),
}
"""By SI unit: units that people use in its place, what each is worth, and from where on; the scene language knows all of them."""


def say(value: float, unit: str = "", digits: int = 3) -> str:
    """A number with its SI unit, in the one that suits its size: 0.034 m is ``3.4 cm``, 176000 Pa is ``176 kPa``."""
    if value == 0.0 or not math.isfinite(value):
        return f"{number(value, digits)} {unit}".rstrip()
    size = abs(_rounded(value, digits))
    name, worth = next((name, worth) for name, worth, least in PREFIXED.get(unit, ((unit, 1.0, 0.0),)) if size >= least)
    if size < 1e-3 * worth:  # too small for the smallest: the power of ten then belongs to the SI unit
        name, worth = unit, 1.0
    return f"{number(value / worth, digits)} {name}".rstrip()


def in_full(numbers: Iterable[float]) -> str:
    """Numbers with all their bits, for programs."""
    return " ".join(map(repr, map(float, numbers)))


def number(value: float, digits: int = 3) -> str:
    """A number in so many digits, with a power of ten only below 0.001 and where digits before the point would be made up.

    Up to 99 999 none are thought to be: ``12300``, but ``1.23e5``. Thousands stand together, as a scene does not take them apart.
    """
    value = _rounded(value, digits)
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    if 1e-3 <= abs(value) < max(1e5, 10.0**digits):
        return f"{Decimal(repr(value)).normalize():f}"
    mantissa, power = f"{value:.{digits - 1}e}".split("e")
    return f"{float(mantissa):g}e{int(power)}"


def with_article(noun: str) -> str:
    """``a box``, ``an air block``."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def exact(value: float) -> str:
    """A number with as many digits as tell it from all others; no point where it is whole."""
    return repr(value).removesuffix(".0")


def vector(v: tuple[float, ...]) -> str:
    """``(0, 0, 1)``"""
    return f"({', '.join(number(x, 6) for x in v)})"


def whole(count: int) -> str:
    """A count, in threes: ``13 312``."""
    return f"{count:,}".replace(",", " ")


def estimate(count: float) -> str:
    """A count in three digits, in threes: ``2 000 000``; from ten digits on ``1e12``."""
    return whole(int(_rounded(count, 3))) if count < 1e9 else number(count)


def at_least(value: float, digits: int = 2) -> float:
    """The next number of so few digits that is not below a positive one: what a message proposes to write must be enough."""
    rounded = _rounded(value, digits)
    return rounded if rounded >= value else _rounded(rounded + 10.0 ** (math.floor(math.log10(rounded)) + 1 - digits), digits)


def at_most(value: float, digits: int = 3) -> float:
    """The next number of so few digits that is not above a positive one, but for rounding."""
    rounded = _rounded(value, digits)
    near = rounded <= value * (1.0 + 1e-9)
    return rounded if near else _rounded(rounded - 10.0 ** (math.floor(math.log10(value)) + 1 - digits), digits)


def _rounded(value: float, digits: int) -> float:
    return float(f"{value:.{digits - 1}e}") if math.isfinite(value) else value
