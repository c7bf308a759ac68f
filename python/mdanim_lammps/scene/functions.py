# SPDX-License-Identifier: GPL-2.0-only
"""Functions of expressions: of numbers, of quantities with a unit, and of vectors."""

from __future__ import annotations

import math
from fractions import Fraction

from .units import (
    NONE,
    UNITS,
    DimensionError,
    add,
    describe,
    dimension,
    magnitude,
    multiply,
    only_numbers,
    quantity,
    same_kind,
    show,
    subtract,
    symbol,
)


def _angle(x) -> float:
    """A plain number or an angle, in radians."""
    only_numbers(x)
    if dimension(x) not in (NONE, UNITS["rad"].dim):
        raise DimensionError(f"an angle is needed here, found {describe(dimension(x))}, {show(x)}")
    return magnitude(x)


def root(x):
    """Square root; halves the dimension."""
    only_numbers(x)
    if magnitude(x) < 0.0:
        raise DimensionError(f"sqrt needs a number >= 0, found {show(x)}")
    return quantity(math.sqrt(magnitude(x)), tuple(Fraction(e) / 2 for e in dimension(x)))


def _extreme(choose):
    def function(*values):
        only_numbers(*values)
        dim = NONE
        for v in values:
            dim = same_kind(quantity(1.0, dim), v, "compare")
        return quantity(choose(map(magnitude, values)), dim)

    return function


def _absolute(x):
    only_numbers(x)
    return quantity(abs(magnitude(x)), dimension(x))


def _plain(function, name: str):
    """A function of a plain number."""

    def of_plain(x):
        only_numbers(x)
        if dimension(x) != NONE:
            raise DimensionError(
                f"{name} needs a plain number, found {describe(dimension(x))}, {show(x)}",
                f"divide it by a unit first: {name}(x/(1 {symbol(dimension(x))}))",
            )
        return function(magnitude(x))

    return of_plain


def _angle_of(function, name: str):
    """A function whose value is an angle: of a plain number in [-1, 1], or of any."""

    def angle(x):
        _plain(float, name)(x)
        if name != "atan" and abs(magnitude(x)) > 1.0:
            raise DimensionError(f"{name} needs a number from -1 to 1, found {show(x)}")
        return quantity(function(magnitude(x)), UNITS["rad"].dim)

    return angle


def _logarithm(x: float) -> float:
    if x <= 0.0:
        raise DimensionError(f"log needs a number > 0, found {show(x)}")
    return math.log(x)


def _direction(y, x):
    """Angle of the point (x, y) from the x axis, -pi to pi."""
    only_numbers(y, x)
    same_kind(y, x, "compare")
    return quantity(math.atan2(magnitude(y), magnitude(x)), UNITS["rad"].dim)


def _vectors(name: str, *values) -> None:
    for v in values:
        if not isinstance(v, tuple):
            raise DimensionError(f"{name} needs a vector, (x, y, z), found {show(v)}")
        if len(v) != len(values[0]):
            raise DimensionError(f"{name} needs vectors of the same length, found {len(values[0])} and {len(v)} numbers")


def _dot(a, b):
    _vectors("dot", a, b)
    total = multiply(a[0], b[0])
    for x, y in zip(a[1:], b[1:]):
        total = add(total, multiply(x, y))
    return total


def _norm(a):
    _vectors("norm", a)
    return root(_dot(a, a))


def _cross(a, b):
    _vectors("cross", a, b)
    if len(a) != 3:
        raise DimensionError(f"cross needs vectors of three numbers, found {len(a)}")
    pairs = ((1, 2), (2, 0), (0, 1))
    return tuple(subtract(multiply(a[i], b[j]), multiply(a[j], b[i])) for i, j in pairs)


FUNCTIONS = {
    "sqrt": (1, 1, root),
    "sin": (1, 1, lambda x: math.sin(_angle(x))),
    "cos": (1, 1, lambda x: math.cos(_angle(x))),
    "tan": (1, 1, lambda x: math.tan(_angle(x))),
    "min": (1, 99, _extreme(min)),
    "max": (1, 99, _extreme(max)),
    "abs": (1, 1, _absolute),
    "floor": (1, 1, _plain(lambda x: float(math.floor(x)), "floor")),
    "ceil": (1, 1, _plain(lambda x: float(math.ceil(x)), "ceil")),
    "round": (1, 1, _plain(lambda x: float(math.floor(x + 0.5)), "round")),
    "exp": (1, 1, _plain(math.exp, "exp")),
    "log": (1, 1, _plain(_logarithm, "log")),
    "asin": (1, 1, _angle_of(math.asin, "asin")),
    "acos": (1, 1, _angle_of(math.acos, "acos")),
    "atan": (1, 1, _angle_of(math.atan, "atan")),
    "atan2": (2, 2, _direction),
    "norm": (1, 1, _norm),
    "dot": (2, 2, _dot),
    "cross": (2, 2, _cross),
}
"""Functions: fewest arguments, most arguments, function. ``rand`` is in expressions.py: its value depends on its place."""
RESERVED = frozenset({"sqrt", "sin", "cos", "tan", "min", "max", "abs"})
"""Functions whose names no ``let`` may take. Scenes may have taken the names of the others before these were functions: a
call has brackets."""
