# SPDX-License-Identifier: GPL-2.0-only
"""From tokens of grammar.lark to functions of the variables, compiled once, run for every repeat."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass, field
from functools import lru_cache
from importlib import resources

from lark import Lark, Token, Transformer, v_args

from . import units
from .keywords import did_you_mean
from .limits import DEEPEST_EXPRESSION
from .source import Fault, Silent
from .units import DimensionError, Quantity

RESERVED = frozenset({*units.FUNCTIONS, "rand", "pi", "mod", "let", "repeat", "include", "in"})
"""Names that no ``let`` may take."""


SPOILED = object()
"""Stands for a let whose value could not be worked out; that was told where it happened."""


@dataclass(slots=True)
class Env:
    """What an expression may look at."""

    values: dict
    loops: tuple[int, ...] = ()
    """Indices of the enclosing repeats, outermost first."""
    seed: int | None = 1
    """None while the seed itself is being worked out."""
    strict: bool = False
    later: dict = field(default_factory=dict)
    """Names that some ``let`` of the scene defines, and the line where."""
    incomplete: bool = False
    """A part of the scene could not be read: a name without a value is no news."""

    def child(self, values: dict, loops: tuple[int, ...] | None = None) -> Env:
        """The same surroundings with other variables."""
        loops = self.loops if loops is None else loops
        return Env(values, loops, self.seed, self.strict, self.later, self.incomplete)


class Rand(Token):
    """The word ``rand`` and its number among the rands of a scene: a comment line must change nothing."""

    site: int


class Node:
    """A compiled expression."""

    __slots__ = ("constant", "depth", "first", "last", "run", "terms")

    def __init__(self, run, parts, first, last, constant=True):
        self.run = run
        self.terms = ((None, self),)
        """Of a sum that is not in brackets: its terms, each with the sign before it."""
        self.first, self.last = first, last
        self.constant = constant and all(p.constant for p in parts)
        self.depth = 1 + max((p.depth for p in parts), default=0)
        if self.depth > DEEPEST_EXPRESSION:
            raise Fault(first, f"this expression has more than {DEEPEST_EXPRESSION} nested steps", "split it with let")


def guarded(token: Token, function, *values):
    """Run a piece of arithmetic; what goes wrong is told at its token."""
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


@v_args(inline=True)
class Compiler(Transformer):
    """Builds a Node at each reduction of the LALR parser; no tree is kept."""

    def number(self, token):
        """A literal."""
        value = float(token)
        if math.isinf(value):
            raise Fault(token, f"{token} is too large a number")
        return Node(lambda env: value, (), token, token)

    def name(self, token):
        """A variable, or pi."""
        text = str(token)
        if text == "pi":
            return Node(lambda env: math.pi, (), token, token)

        def run(env):
            try:
                value = env.values[text]
            except KeyError:
                raise _unknown(token, env) from None
            if value is SPOILED:
                raise Silent(token, "")
            return value

        return Node(run, (), token, token, constant=False)

    def binary(self, x, token, y):
        """Two floats take the short way; everything else asks units.py."""
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

        node = Node(run, (x, y), x.first, y.last)
        if summing:
            node.terms = (*x.terms, (token, y))
        return node

    def negative(self, token, x):
        """-x"""
        f = x.run
        return Node(lambda env: units.negate(f(env)), (x,), token, x.last)

    def positive(self, token, x):
        """+x"""
        x.first = token
        return x

    def bracket(self, left, x, right):
        """Brackets change the place, and make one term of a sum."""
        x.first, x.last = left, right
        x.terms = ((None, x),)
        return x

    def vector(self, left, *rest):
        """(x, y, ...)"""
        parts = rest[:-1:2]
        runs = tuple(p.run for p in parts)

        def run(env):
            value = tuple([f(env) for f in runs])
            for v, p in zip(value, parts):
                if isinstance(v, tuple):
                    raise Fault(p.first, "a vector cannot stand inside a vector", last=p.last)
            return value

        return Node(run, parts, left, rest[-1])

    def call(self, token, left, *rest):
        """A function."""
        name, parts = str(token), rest[:-1:2]
        if name == "rand":
            return self._rand(token, parts, rest[-1])
        if name not in units.FUNCTIONS:
            raise Fault(token, f"'{name}' is not a function", did_you_mean(name, [*units.FUNCTIONS, "rand"]))
        least, most, function = units.FUNCTIONS[name]
        if not least <= len(parts) <= most:
            raise Fault(token, f"{name} takes {least} number, found {len(parts)}", last=rest[-1])
        runs = tuple(p.run for p in parts)
        return Node(lambda env: guarded(token, function, *[f(env) for f in runs]), parts, token, rest[-1])

    def _rand(self, token, parts, last):
        """rand(a, b): drawn from the seed, the place among the rands of the scene, and the repeat indices."""
        if len(parts) != 2:
            raise Fault(token, f"rand takes two numbers, rand(least, most), found {len(parts)}", last=last)
        low, high = (p.run for p in parts)
        site = token.site

        def run(env):
            if env.seed is None:
                raise Fault(token, "the seed cannot be random", "give it as a whole number, e.g. seed 7", last=last)
            u = random_unit(env.seed, site, env.loops)
            a, b = low(env), high(env)
            return guarded(token, lambda: units.add(a, units.multiply(units.subtract(b, a), u)))

        return Node(run, parts, token, last, constant=False)

    def factor(self, token, *rest):
        """One unit with its power."""
        sign = -1 if len(rest) == 3 else 1
        power = rest[-1] if rest else "1"
        if not (power.isascii() and power.isdigit() and 1 <= int(power[:3]) <= 9):
            raise Fault(rest[-1], f"the power of a unit is a whole number from 1 to 9, found {power}")
        return token, sign * int(power), rest[-1] if rest else token

    def unit(self, first, *rest):
        """A product or quotient of units."""
        result, sign = units.ONE, 1
        text = str(first[0])
        factors = [(None, first), *zip(rest[::2], rest[1::2])]
        for mark, (token, power, _) in factors:
            sign = -1 if mark is not None and mark.type == "UNIT_SLASH" else 1
            known = units.ONE if token.type == "ONE" else units.UNITS.get(str(token))
            if known is None and token == "h" and sign < 0:
                known = units.HOUR
            if known is None:
                raise Fault(token, f"'{token}' is not a unit", units.suggest_unit(str(token)))
            result = result.times(known, sign * power)
            text = text if mark is None else f"{text}{mark}{token}"
        return factors[-1][1][2], units.Unit(text, result.over, result.under, result.dim)

    def with_unit(self, x, u):
        """A value measured in a unit. Terms of a sum that have one keep theirs: ``a + 1 kg``, a = 500 g."""
        last, unit = u
        f, terms = x.run, x.terms
        over, under, dim = unit.over, unit.under, unit.dim

        def run(env):
            if len(terms) > 1:
                values = [node.run(env) for _, node in terms]
                bare = [_bare(v) for v in values]
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

        return Node(run, (x,), x.first, last)

    def joined(self, x, tail):
        """``1 m - 20 cm``: the tail carries its sign."""
        f, g = x.run, tail.run
        plus = Token.new_borrow_pos("PLUS", "+", tail.first)
        return Node(lambda env: combine(env, plus, f(env), g(env)), (x, tail), x.first, tail.last)

    def joined_with_unit(self, x, tail, u):
        """``1 m - 20 cm`` with the unit of the tail."""
        return self.joined(x, self.with_unit(tail, u))


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
    return Fault(token, f"'{name}' has no value", hint if "did you" in hint else f"give it one before: let {name} = ...")


@lru_cache(maxsize=1)
def language() -> Lark:
    """The parser of grammar.lark, built once."""
    grammar = resources.files(__package__).joinpath("grammar.lark").read_text("utf-8")
    return Lark(grammar, parser="lalr", lexer="basic", start=["value", "tokens"], transformer=Compiler())


def compile_value(tokens: list[Token]) -> Node:
    """Compile the tokens of one value; raises Fault, and lark's UnexpectedInput where they are none."""
    parser = language().parse_interactive(start="value")
    for token in tokens:
        parser.feed_token(token)
    return parser.feed_eof(tokens[-1])
