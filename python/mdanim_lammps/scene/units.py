# SPDX-License-Identifier: GPL-2.0-only
"""Units and dimensions: the value of ``kg*m/s^2`` in SI, and which quantities may be added to which."""

from __future__ import annotations

import math
import operator
from difflib import get_close_matches
from functools import cache

from ..records import dataclass
from .formatting import number, say

Dim = tuple
"""Exponents of (metre, kilogram, second, radian). With the angle, ``mass 20 deg`` is an error."""

NONE: Dim = (0, 0, 0, 0)


class DimensionError(ValueError):
    """Two quantities that cannot be combined; ``hint`` is the way out."""

    def __init__(self, message: str, hint: str = ""):
        super().__init__(message)
        self.hint = hint


@dataclass(frozen=True, slots=True)
class Unit:
    """One unit as a ratio, so that 7 cm is 7/100 rounded once, not 7 times a rounded 0.01."""

    text: str
    over: float
    under: float
    dim: Dim

    def times(self, other: Unit, power: int = 1) -> Unit:
        """This unit multiplied by ``other**power``."""
        over, under = (other.over, other.under) if power >= 0 else (other.under, other.over)
        dim = tuple(a + power * b for a, b in zip(self.dim, other.dim))
        return Unit(self.text, self.over * over ** abs(power), self.under * under ** abs(power), dim)


ONE = Unit("1", 1.0, 1.0, NONE)

_TABLE = """
m 1 1 m | mm 1 1000 m | cm 1 100 m | km 1000 1 m | l 1 1000 m3
s 1 1 s | ms 1 1000 s | min 60 1 s | Hz 1 1 s-1 | fps 1 1 s-1
kg 1 1 kg | g 1 1000 kg | t 1000 1 kg
N 1 1 m,kg,s-2 | kN 1000 1 m,kg,s-2 | J 1 1 m2,kg,s-2
Pa 1 1 m-1,kg,s-2 | kPa 1e3 1 m-1,kg,s-2 | MPa 1e6 1 m-1,kg,s-2 | GPa 1e9 1 m-1,kg,s-2
rad 1 1 rad | deg pi 180 rad | rpm pi 30 rad,s-1
"""
_BASE = ("m", "kg", "s", "rad")


def _dim(text: str) -> Dim:
    exponent = dict.fromkeys(_BASE, 0)
    for part in text.split(","):
        name = part.rstrip("-0123456789")
        exponent[name] = int(part[len(name) :] or 1)
    return tuple(exponent.values())


def _number(text: str) -> float:
    return math.pi if text == "pi" else float(text)


UNITS: dict[str, Unit] = {
    name: Unit(name, _number(over), _number(under), _dim(dim))
    for name, over, under, dim in (row.split() for line in _TABLE.split("\n") if line for row in line.split("|"))
}
"""Every unit that may stand alone."""

HOUR = Unit("h", 3600.0, 1.0, UNITS["s"].dim)
"""Only below a fraction bar (``km/h``): alone, ``h`` is a usual name for a height."""


@cache
def unit(text: str) -> Unit:
    """The unit written as ``N*s/m``; raises KeyError for a word that is none."""
    result, sign, rest = ONE, 1, text
    while rest:
        end = min((rest.index(c) for c in "*/" if c in rest), default=len(rest))
        name, _, power = rest[:end].partition("^")
        factor = ONE if name == "1" else HOUR if name == "h" and sign < 0 else UNITS[name]
        result = result.times(factor, sign * int(power or 1))
        sign = -1 if rest[end : end + 1] == "/" else 1
        rest = rest[end + 1 :]
    return Unit(text, result.over, result.under, result.dim)


LISTED = (
    ("m", "a length", "m mm cm km"),
    ("s", "a time", "s ms min"),
    ("kg", "a mass", "kg g t"),
    ("N", "a force", "N kN"),
    ("Pa", "a pressure", "Pa kPa MPa GPa"),
    ("m/s", "a speed", "m/s km/h"),
    ("m/s^2", "an acceleration", "m/s^2"),
    ("kg/m^3", "a density", "kg/m^3 g/cm^3"),
    ("N/m", "a spring constant", "N/m"),
    ("N*s/m", "a drag coefficient", "N*s/m"),
    ("Pa*s", "a viscosity", "Pa*s"),
    ("m^2", "an area", "m^2"),
    ("m^3", "a volume", "m^3 l"),
    ("rad", "an angle", "deg rad"),
    ("rad/s", "an angular speed", "rad/s rpm"),
    ("1/s", "a rate", "1/s Hz fps"),
    ("J", "an energy", "J"),
    ("J/s", "a power", "J/s"),
)
"""SI unit, name and units in use of each dimension that has a name; products and quotients of units are allowed too."""

NAMES: dict[Dim, tuple[str, str]] = {unit(text).dim: (text, name) for text, name, _ in LISTED}
"""SI unit and name by dimension."""


def symbol(dim: Dim) -> str:
    """The SI unit of a dimension, e.g. ``kg/m^3``."""
    if dim in NAMES:
        return NAMES[dim][0]
    parts = [f"{b}^{e}" if e != 1 else b for b, e in zip(_BASE, dim) if e]
    return "*".join(parts)


def describe(dim: Dim) -> str:
    """A dimension in words: ``a mass``, ``a plain number``, ``a quantity in m*kg``."""
    if dim == NONE:
        return "a plain number"
    return NAMES[dim][1] if dim in NAMES else f"a quantity in {symbol(dim)}"


TORQUE = "N*m"
"""SI unit of a torque, which has the dimension of an energy, and is none."""


def describe_unit(text: str) -> str:
    """The dimension of a SI unit in words; of N*m ``a torque``."""
    return "a torque" if text == TORQUE else describe(unit(text).dim)


def fitting(text: str) -> list[str]:
    """The listed units that measure the same as a SI unit; of N*m itself alone."""
    return [TORQUE] if text == TORQUE else units_of(unit(text).dim)


def units_of(dim: Dim) -> list[str]:
    """The listed units of a dimension, the SI one among them."""
    found = [text for *_, texts in LISTED for text in texts.split() if unit(text).dim == dim]
    return found or ([symbol(dim)] if dim != NONE else [])


def suggest_unit(word: str, dim: Dim | None = None) -> str:
    """``did you mean 'kg'?`` for a mistyped unit; units of the dimension that is wanted come first."""
    choice = units_of(dim) if dim is not None else list(UNITS)
    close = [u for u in choice if u.lower() == word.lower()] or get_close_matches(word, choice, 1, 0.5)
    if close:
        return f"did you mean '{close[0]}'?"
    return f"{'units that fit' if dim is not None else 'known units'}: {' '.join(choice)}"


# --- arithmetic: a bare number is a float, one with a dimension a Quantity, a vector a tuple of them ------


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number in SI units together with its dimension, which is not NONE."""

    value: float
    dim: Dim


Scalar = float | Quantity


def magnitude(x: Scalar) -> float:
    """The number in SI units."""
    return x.value if isinstance(x, Quantity) else x


def dimension(x: Scalar) -> Dim:
    """The dimension; NONE for a bare number."""
    return x.dim if isinstance(x, Quantity) else NONE


def quantity(value: float, dim: Dim) -> Scalar:
    """A Quantity, or a float where nothing of the dimension is left."""
    return value if dim == NONE else Quantity(value, dim)


def show(x: object, unit_wanted: str = "") -> str:
    """A value for messages: ``0.12 m``, ``(0, 0, 1) m/s``; a number with the dimension of a torque is one where N*m is wanted."""
    if isinstance(x, tuple):
        dims = {dimension(c) for c in x}
        if len(dims) == 1:
            return f"({', '.join(number(magnitude(c), 6) for c in x)}) {symbol(dims.pop())}".rstrip()
        return f"({', '.join(map(show, x))})"
    torque = unit_wanted == TORQUE and dimension(x) == unit(TORQUE).dim
    return say(magnitude(x), TORQUE if torque else symbol(dimension(x)), 6)


def same_kind(x: Scalar, y: Scalar, doing: str) -> Dim:
    """The common dimension of two values; a bare number takes the other's SI unit."""
    a, b = dimension(x), dimension(y)
    if a != b and a != NONE and b != NONE:
        raise DimensionError(
            f"cannot {doing} {describe(a)} and {describe(b)} ({show(x)}, {show(y)})", "both need the same kind of unit"
        )
    return a if a != NONE else b


def only_numbers(*values: object) -> None:
    """Raise DimensionError where a value is a vector."""
    if any(isinstance(v, tuple) for v in values):
        raise DimensionError("a number is needed here, found a vector (x, y, z)")


def _pairwise(function, x: object, y: object):
    if isinstance(x, tuple) and isinstance(y, tuple):
        if len(x) != len(y):
            raise DimensionError(f"these vectors have {len(x)} and {len(y)} numbers")
        return tuple(map(function, x, y))
    if isinstance(x, tuple) or isinstance(y, tuple):
        raise DimensionError("a vector and a number cannot be added", "write the number as a vector (x, y, z)")
    return function(x, y)


LARGEST_POWER = 100
"""No quantity has a unit to a higher power; chains of products would make exponents of any length."""


def _compound(value: float, dim: Dim) -> Scalar:
    """The result of a product or a power."""
    if any(abs(e) > LARGEST_POWER for e in dim):
        raise DimensionError(f"the unit of this value has a power above {LARGEST_POWER}")
    return quantity(value, dim)


def add(x, y):
    """x + y of two numbers or two vectors."""
    return _pairwise(lambda a, b: quantity(magnitude(a) + magnitude(b), same_kind(a, b, "add")), x, y)


def subtract(x, y):
    """x - y of two numbers or two vectors."""
    return _pairwise(lambda a, b: quantity(magnitude(a) - magnitude(b), same_kind(a, b, "subtract")), x, y)


def multiply(x, y):
    """x * y; one of the two may be a vector."""
    if isinstance(x, tuple) != isinstance(y, tuple):
        return tuple(multiply(a, y) for a in x) if isinstance(x, tuple) else tuple(multiply(x, b) for b in y)
    only_numbers(x, y)
    return _compound(magnitude(x) * magnitude(y), tuple(a + b for a, b in zip(dimension(x), dimension(y))))


def divide(x, y):
    """x / y; x may be a vector."""
    if isinstance(x, tuple):
        return tuple(divide(a, y) for a in x)
    only_numbers(x, y)
    return _compound(magnitude(x) / magnitude(y), tuple(a - b for a, b in zip(dimension(x), dimension(y))))


def modulo(x, y):
    """The remainder of x / y, with the sign of y."""
    only_numbers(x, y)
    return quantity(operator.mod(magnitude(x), magnitude(y)), same_kind(x, y, "take mod of"))


def power(x, y):
    """x ^ y for a plain number y."""
    only_numbers(x, y)
    if dimension(y) != NONE:
        raise DimensionError(f"an exponent is a plain number, found {show(y)}")
    result = magnitude(x) ** magnitude(y)
    if isinstance(result, complex):
        raise DimensionError(f"({show(x)}) ^ ({show(y)}) is not a real number")
    from fractions import Fraction  # loaded for scenes with powers alone

    exponent = Fraction(magnitude(y)).limit_denominator(12)
    if dimension(x) != NONE and abs(exponent - Fraction(magnitude(y))) > 1e-12:
        raise DimensionError(
            f"{describe(dimension(x))} cannot be raised to the power {show(y)}",
            "the exponent of a quantity is a whole number or a fraction such as 1/2 or 2/3",
        )
    return _compound(result, tuple(e * exponent for e in dimension(x)))


def negate(x):
    """-x of a number or a vector."""
    return tuple(map(negate, x)) if isinstance(x, tuple) else quantity(-magnitude(x), dimension(x))


def with_unit(x, u: Unit):
    """A number or vector measured in ``u``."""
    if isinstance(x, tuple):
        return tuple(with_unit(c, u) for c in x)
    if isinstance(x, Quantity):
        raise DimensionError(f"the value has a unit already: it is {describe(x.dim)}, {show(x)}", f"leave out '{u.text}'")
    return quantity(x * u.over / u.under, u.dim)
