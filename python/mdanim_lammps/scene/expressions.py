# SPDX-License-Identifier: GPL-2.0-only
"""Values as functions of the variables: built once by reader.py, run for every repeat."""

from __future__ import annotations

import math
import operator
from dataclasses import field, replace

from ..errors import Span
from ..records import dataclass
from . import functions, units
from .functions import FUNCTIONS
from .keywords import did_you_mean
from .limits import DEEPEST_EXPRESSION
from .source import Fault, NoValue, Silent
from .tokens import Token
from .units import DimensionError, Quantity

RESERVED = frozenset({*functions.RESERVED, "rand", "pi", "mod", "let", "repeat", "include", "in"})
"""Names that no ``let`` may take."""


SPOILED = object()
"""Stands for a let that could not be evaluated; that was reported where it happened."""


@dataclass(frozen=True, slots=True)
class Properties:
    """Settings of an object that a ``let`` gives a name."""

    settings: dict
    """Evaluated settings by word."""
    broken: set
    """Words whose setting could not be used; that was reported already."""
    depth: int
    """Groups that are placed around the let."""


@dataclass(slots=True)
class Env:
    """The values that an expression may depend on."""

    values: dict
    loops: tuple[int, ...] = ()
    """Indices of the enclosing repeats, outermost first."""
    seed: int | None = 1
    """None while the seed itself is evaluated."""
    strict: bool = False
    later: dict = field(default_factory=dict)
    """Names that some ``let`` of the scene defines, and the line where."""
    incomplete: bool = False
    """A part of the scene could not be read: a name without a value is not a new problem."""
    counters: tuple[str, ...] = ()
    """Names of the indices in ``loops``; empty for the number of a placed group."""
    prefix: str = ""
    """Name of the placed group around, ``cart[2]``; empty outside of all."""
    used_at: tuple[Span, ...] = ()
    """Where the groups around are placed, outermost first."""
    given: dict = field(default_factory=dict)
    """Values that the place of the group around gives to its lets, each behind its ``set``."""

    def within(self, counter: str, i: int) -> Env:
        """The same surroundings inside round ``i`` of a repeat."""
        return replace(self, loops=(*self.loops, i), counters=(*self.counters, counter))


class Node:
    """A compiled value: ``run(env)`` gives a float, a Quantity or a tuple of them; raises Fault."""

    __slots__ = ("constant", "depth", "first", "last", "name", "terms", "value")

    def __init__(self, parts, first: Token, last: Token, constant: bool = True):
        self.first, self.last = first, last
        self.terms = ()
        """Terms of a sum that is not in brackets, each with the sign before it."""
        self.value = None
        """Value of a literal."""
        self.name: Token | None = None
        """Name of a variable, with signs before it or without."""
        self.constant = constant and all(p.constant for p in parts)
        self.depth = 1 + max((p.depth for p in parts), default=0)
        if self.depth > DEEPEST_EXPRESSION:
            raise Fault(first, f"this expression has more than {DEEPEST_EXPRESSION} nested steps", "split it with let")


class Literal(Node):
    """A value that is known already."""

    __slots__ = ()

    def __init__(self, value, first: Token, last: Token):
        super().__init__((), first, last)
        self.value = value

    def run(self, env: Env):
        """The value."""
        return self.value


class Computed(Node):
    """A value that ``run`` computes."""

    __slots__ = ("run",)

    def __init__(self, run, parts, first: Token, last: Token, constant: bool = True):
        super().__init__(parts, first, last, constant)
        self.run = run


def guarded(token: Token, function, *values):
    """Run a piece of arithmetic; what goes wrong is a problem at its token."""
    try:
        return function(*values)
    except DimensionError as e:
        raise Fault(token, str(e), e.hint) from None
    except ZeroDivisionError:
        raise Fault(token, "division by zero") from None
    except (ArithmeticError, ValueError):
        raise Fault(token, "the result is not a finite number") from None


def random_unit(seed: int, site: int, loops: tuple[int, ...]) -> float:
    """A number in [0, 1) that depends on nothing but its arguments (splitmix64, Steele et al. 2014)."""
    mask = (1 << 64) - 1
    state = seed & mask
    for word in (site, *loops):
        state = (state ^ (word & mask)) + 0x9E3779B97F4A7C15 & mask
        state = (state ^ state >> 30) * 0xBF58476D1CE4E5B9 & mask
        state = (state ^ state >> 27) * 0x94D049BB133111EB & mask
        state ^= state >> 31
    return (state >> 11) * 2.0**-53


_BINARY = {
    "PLUS": (operator.add, units.add),
    "MINUS": (operator.sub, units.subtract),
    "STAR": (operator.mul, units.multiply),
    "SLASH": (operator.truediv, units.divide),
    "MOD": (None, units.modulo),
    "CARET": (None, units.power),
}


def combine(env: Env, token: Token, x, y):
    """x + y, or x - y; strict mode wants both with units or both without."""
    if env.strict and not isinstance(x, tuple) and not isinstance(y, tuple) and (type(x) is float) != (type(y) is float):
        raise Fault(token, "a bare number meets a quantity, and strict mode wants units", "write both with units")
    return guarded(token, units.subtract if token.type == "MINUS" else units.add, x, y)


def number(token: Token) -> Node:
    """A number as it stands."""
    value = float(token)
    if math.isinf(value):
        raise Fault(token, f"{token} is too large a number")
    return Literal(value, token, token)


def name(token: Token) -> Node:
    """A variable, or pi."""
    text = str(token)
    if text == "pi":
        return Literal(math.pi, token, token)

    def run(env):
        value = env.values.get(text)
        if value is None:
            raise _unknown(token, env)
        if value is SPOILED:
            raise Silent(token, "")
        if type(value) is Properties:
            raise Fault(token, f"'{text}' stands for settings of an object, and a number is needed here", f"write use {text}")
        return value

    node = Computed(run, (), token, token, constant=False)
    node.name = token
    return node


def binary(x: Node, token: Token, y: Node) -> Node:
    """Two floats take the short way; everything else is left to units.py."""
    fast, slow = _BINARY[token.type]
    f, g = x.run, y.run
    summing = token.type in ("PLUS", "MINUS")

    def run(env):
        a, b = f(env), g(env)
        if fast is not None and type(a) is float and type(b) is float:
            try:
                return fast(a, b)
            except ArithmeticError:
                pass
        return combine(env, token, a, b) if summing else guarded(token, slow, a, b)

    node = Computed(run, (x, y), x.first, y.last)
    if summing:
        node.terms = (*(x.terms or ((None, x),)), (token, y))
    return node


def negative(token: Token, x: Node) -> Node:
    """-x"""
    if x.value is not None:
        return Literal(units.negate(x.value), token, x.last)
    f = x.run
    node = Computed(lambda env: units.negate(f(env)), (x,), token, x.last)
    node.name = x.name
    return node


def vector(left: Token, parts: list[Node], right: Token) -> Node:
    """(x, y, ...)"""
    for p in parts:
        if isinstance(p.value, tuple):
            raise _nested(p)
    if all(p.value is not None for p in parts):
        return Literal(tuple([p.value for p in parts]), left, right)

    def run(env):
        value = tuple([p.run(env) for p in parts])
        for v, p in zip(value, parts):
            if isinstance(v, tuple):
                raise _nested(p)
        return value

    return Computed(run, parts, left, right)


def _nested(p: Node) -> Fault:
    return Fault(p.first, "a vector cannot stand inside a vector", last=p.last)


def call(token: Token, parts: list[Node], last: Token, site: int) -> Node:
    """A function. ``site`` is the number of a rand among those of the scene: a comment line must change nothing."""
    if token == "rand":
        return _rand(token, parts, last, site)
    if token not in FUNCTIONS:
        raise Fault(token, f"'{token}' is not a function", did_you_mean(str(token), [*FUNCTIONS, "rand"]))
    least, most, function = FUNCTIONS[token]
    if not least <= len(parts) <= most:
        numbers = "numbers" if least > 1 else "number"
        raise Fault(token, f"{token} takes {least} {numbers}, found {len(parts)}", last=last)
    return Computed(lambda env: guarded(token, function, *[p.run(env) for p in parts]), parts, token, last)


def _rand(token: Token, parts: list[Node], last: Token, site: int) -> Node:
    """rand(a, b): drawn from the seed, the place among the rands of the scene, and the repeat indices."""
    if len(parts) != 2:
        raise Fault(token, f"rand takes two numbers, rand(least, most), found {len(parts)}", last=last)
    low, high = (p.run for p in parts)

    def run(env):
        if env.seed is None:
            raise Fault(token, "the seed cannot be random", "give it as a whole number, e.g. seed 7", last=last)
        u = random_unit(env.seed, site, env.loops)
        a, b = low(env), high(env)
        return guarded(token, lambda: units.add(a, units.multiply(units.subtract(b, a), u)))

    return Computed(run, parts, token, last, constant=False)


def with_unit(x: Node, unit: units.Unit, last: Token) -> Node:
    """A value measured in a unit. Terms of a sum that have one keep theirs: ``a + 1 kg``, a = 500 g."""
    f, terms = x.run, x.terms
    if x.value is not None and _bare(x.value):
        return Literal(units.with_unit(x.value, unit), x.first, last)
    over, under, dim = unit.over, unit.under, unit.dim

    def run(env):
        if terms:
            values = [node.run(env) for _, node in terms]
            bare = [_bare(v) for v in values]
            for (_, node), v, without in zip(terms, values, bare):
                if without and node.name is not None and node.name not in env.counters:
                    _clear(node.name, v, unit)
            if any(bare) and not all(bare):
                values = [guarded(last, units.with_unit, v, unit) if b else v for v, b in zip(values, bare)]
                total = values[0]
                for (token, _), v in zip(terms[1:], values[1:]):
                    total = combine(env, token, total, v)
                return total
        value = f(env)
        if type(value) is float and dim != units.NONE:
            return Quantity(value * over / under, dim)
        return guarded(last, units.with_unit, value, unit)

    return Computed(run, (x,), x.first, last)


def _clear(name: Token, value, unit: units.Unit) -> None:
    """Refuse a ``let`` without unit as a term of a sum before a unit other than that of SI: with ``let gap = 5`` the sum
    ``gap + 20 cm`` would be 25 cm, and with ``let gap = 5 m`` 5.2 m."""
    if unit.over == unit.under or not any(value if isinstance(value, tuple) else (value,)):
        return
    u, si = unit.text, units.symbol(unit.dim)
    cause = f"{name} has no unit and stands in a sum before {u}: it could be in {u} or in {si}"
    way_out = f"write ({name} + ...) {u}, or {name} {si} + ... {u}; or give {name} a unit in its let"
    raise Fault(name, cause, way_out)


def joined(x: Node, tail: Node) -> Node:
    """``1 m - 20 cm``: the tail carries its sign."""
    f, g = x.run, tail.run
    plus = Token("PLUS", "+", tail.first.start, tail.first.line, tail.first.column)
    return Computed(lambda env: combine(env, plus, f(env), g(env)), (x, tail), x.first, tail.last)


def _bare(x) -> bool:
    return all(type(c) is float for c in x) if isinstance(x, tuple) else type(x) is float


def _unknown(token: Token, env: Env) -> Fault:
    name = str(token)
    if env.incomplete:
        return Silent(token, "")
    if name in env.later:
        return Fault(token, f"'{name}' is used before its let", f"it stands at line {env.later[name]}; move it up")
    if name in units.UNITS:
        return Fault(token, f"'{name}' is a unit, and a number is needed here", f"write a number before it: 1 {name}")
    names = [n for n in env.values if n.isidentifier()]
    hint = did_you_mean(name, names) if names else ""
    return NoValue(token, f"'{name}' has no value", hint if "did you" in hint else f"give it one before: let {name} = ...")
