# SPDX-License-Identifier: GPL-2.0-only
"""Evaluates settings: each value as its slot wants it, in SI units, within its limits."""

from __future__ import annotations

import math
from dataclasses import replace

from ..errors import Span
from . import units
from .colors import color
from .evaluated import EvaluatedBlock, EvaluatedSetting
from .expressions import Env, Node
from .formatting import number
from .keywords import beginnings, example
from .schema import Rule, limit_of, syntax
from .source import Fault, NoValue, Problems, SceneFile
from .tokens import Token
from .tree import Name, SettingNode, Value

LARGE = 5.0
"""Size of a shape [m] from which on a number without unit gets a note."""


class Evaluator:
    """Evaluates names and settings in their surroundings."""

    def __init__(self, problems: Problems, strict: bool):
        self.problems = problems
        self.strict = strict

    def where(self, env: Env) -> str:
        """The placed group and the indices of the repeats, for messages."""
        told = ", ".join(f"{n} = {i}" for n, i in zip(env.counters, env.loops) if n)
        parts = [f"in {env.prefix}"] * bool(env.prefix) + [f"with {told}"] * bool(told)
        return f" ({', '.join(parts)})" if parts else ""

    def fault(self, source: SceneFile, fault: Fault, env: Env) -> None:
        """Note a fault where it stands, with the places where the groups around are placed."""
        self.problems.fault(source, fault, self.where(env), env.used_at)

    def told(self, env: Env, source: SceneFile, token: Token, message: str, hint: str = "", severity: str = "error") -> None:
        """Note a problem at a token likewise."""
        self.problems.add(source.span(token, None, env.used_at), message + self.where(env), hint, severity)

    def name(self, name: Name, env: Env) -> str:
        """``ball[12]``, ``brick[3][4]``, ``cart[2].wheel``"""
        inner = f".{self.name(name.inner, env)}" if name.inner is not None else ""
        return str(name.token) + "".join(f"[{self.index(node, env)}]" for node in name.indices) + inner

    def index(self, node: Node, env: Env) -> int:
        """The number in one bracket of a name."""
        v = node.run(env)
        if type(v) is not float or v != v or abs(v) > 1e15 or abs(v - round(v)) > 1e-9:
            raise Fault(node.first, f"an index is a whole number, found {units.show(v)}", last=node.last)
        return round(v)

    # -- settings

    def setting(self, s: SettingNode, env: Env, out: EvaluatedBlock) -> None:
        """Evaluate a setting and put it into its block."""
        word = s.keyword.name
        given = out.settings.get(word)
        if given and not s.keyword.many:
            first = given[0].entry
            cause = f"{word} is given twice" + f" in {out.block} {out.name}".rstrip() * bool(out.block)
            self.problems.add(
                s.source.span(s.token, None, env.used_at), cause, f"first given at {first.source.span(first.token)}"
            )
            return
        if word == "seed":
            env = replace(env, seed=None)
        try:
            values = s.known if s.known is not None else self.values(s, env)
        except Fault as fault:
            if isinstance(fault, NoValue) and beginnings(s.keyword):  # a word may be meant
                fault.hint += f"; {word} is written as {word} {syntax(s.keyword)}"
            self.fault(s.source, fault, env)
            out.broken.add(word)
            return
        out.settings.setdefault(word, []).append(EvaluatedSetting(s, values, env.used_at))

    def values(self, s: SettingNode, env: Env) -> tuple:
        """All values of a setting in SI units; raises Fault."""
        raw = [None if v is None else self.raw(v, env) for v in s.values]
        result = tuple([None if v is None else self.checked(s, v, x) for v, x in zip(s.values, raw)])
        self._half_units(s, raw, env.used_at)
        if s.constant:
            s.known = result
        return result

    def raw(self, v: Value, env: Env):
        """A value before its unit is checked."""
        if v.slot.kind == "check":
            return self.name(v.name, env), v.text, v.argument and self.raw(v.argument, env)
        if v.name is not None:
            return self.name(v.name, env)
        return v.text if v.node is None else v.node.run(env)

    def checked(self, s: SettingNode, v: Value, x):
        """A value as the slot wants it."""
        kind = v.slot.kind
        if kind == "color":
            return self._color(v, x)
        if kind == "check":
            subject, quantity, argument = x
            return subject, quantity, v.argument and self.checked(s, v.argument, argument)
        if kind in ("text", "choice", "name", "relation") or v.node is None:
            return x
        what = label(s, v)
        if kind == "number":
            if isinstance(x, tuple):
                raise Fault(v.first, f"{what} is a number, found the vector {units.show(x)}", last=v.last)
            if v.slot.other:
                return self.of_two_units(s, v, x, what)
            return x if v.slot.unit == "?" else self.number(s, v, x, what, v.first, v.last)
        if not isinstance(x, tuple) or len(x) != v.slot.length:
            found = f"{len(x)} numbers" if isinstance(x, tuple) else f"the number {units.show(x, v.slot.unit)}"
            hint = (
                "a decimal number is written with a point: 0.5, not 0,5"
                if isinstance(x, tuple) and len(x) > v.slot.length
                else ""
            )
            raise Fault(
                v.first,
                f"{what} is a vector {v.slot.text}, found {found}",
                hint or (f"write {v.slot.text}" if " | " in s.keyword.form else example(s.keyword)),
                v.last,
            )
        names = v.slot.text.strip("()").split(", ")
        return tuple([self.number(s, v, c, f"{n} of {what}", v.first, v.last) for c, n in zip(x, names)])

    def number(self, s: SettingNode, v: Value, x, what: str, first, last) -> float:
        """One number in SI units that has the right dimension and obeys the rule."""
        dim = v.slot.dim
        rule = Rule.ANY if v.slot.anywhere or v.slot.or_text else s.keyword.rule  # what counts from 1 on says so itself
        if type(x) is not float:
            if x.dim != dim:
                raise Fault(
                    first,
                    f"{what} must be {units.describe_unit(v.slot.unit)}, found {_found(s, v, x)}, {units.describe(x.dim)}",
                    _unit_hint(v.slot.unit, x.dim),
                    last,
                )
            x = x.value
        elif self.strict and dim != units.NONE:
            raise Fault(
                first, f"{what} has no unit: {number(x, 6)}", f"write {number(x, 6)} {units.symbol(dim)} (strict mode)", last
            )
        if x - x != 0.0:
            raise Fault(first, f"{what} is not a finite number", "a calculation in it overflows", last)
        if rule is not Rule.ANY and not rule.holds(x):
            way_out = f"write {v.slot.text} {rule.value}" if " | " in s.keyword.form else example(s.keyword)
            raise Fault(first, f"{what} must be {rule.value}, found {_found(s, v, units.quantity(x, dim))}", way_out, last)
        limit = limit_of(s.keyword, v.slot)
        least = limit.least if rule is Rule.POSITIVE else -limit.most
        if not least <= x <= limit.most:
            size = "small" if x < least else "large"
            least, most = (units.show(units.quantity(b, dim)) for b in (limit.least, limit.most))
            goes = f"goes from {least} to {most}" if rule is Rule.POSITIVE else f"goes up to {most}"
            raise Fault(
                first, f"{what} is too {size}: it {goes}, found {units.show(units.quantity(x, dim))}", limit.way_out, last
            )
        return x

    def of_two_units(self, s: SettingNode, v: Value, x, what: str):
        """A number that may have either of two dimensions, which it keeps."""
        for text in (v.slot.unit, v.slot.other):
            if units.dimension(x) in (units.unit(text).dim, units.NONE):
                one = replace(v, slot=replace(v.slot, unit=text, dim=units.unit(text).dim))
                self.number(s, one, x, what, v.first, v.last)
                return x
        one, other = v.slot.unit, v.slot.other
        cause = f"{what} must be {units.describe_unit(one)} or {units.describe_unit(other)}, found {_found(s, v, x)}"
        raise Fault(v.first, cause, f"units that fit: {' '.join([*units.fitting(one), *units.fitting(other)])}", v.last)

    def _color(self, v: Value, x: str) -> str:
        try:
            return color(x)
        except ValueError as e:
            raise Fault(v.first, str(e.args[0]), e.args[1], v.last) from None

    def _half_units(self, s: SettingNode, raw: list, used_at: tuple[Span, ...]) -> None:
        """``cylinder 10 20 cm`` is 10 m by 20 cm, and ``sphere 10`` a ball of 10 m: most likely not what was meant."""
        measured = [
            (v, x) for v, x in zip(s.values, raw) if v is not None and v.slot.unit not in ("1", "?") and not isinstance(x, str)
        ]
        without = [v for v, x in measured if bare(x)]
        if without and len(without) < len(measured):
            unit = without[0].slot.unit
            self.problems.add(
                s.source.span(without[0].first, without[0].last, used_at),
                f"this value of {s.keyword.name} has no unit and is read in {unit}, the other one has a unit",
                "write a unit after each value",
                "warning",
            )
            return
        for v, x in measured if s.keyword.name == "shape" else ():
            if v.slot.unit == "m" and (largest := max(floats(x))) >= LARGE and bare(x):
                told = f"this size has no unit and is read in metres: {units.show(units.quantity(largest, v.slot.dim))}"
                self.problems.add(s.source.span(v.first, v.last, used_at), told, "write its unit: 10 cm, or 10 m", "note")
        for v, x in measured:
            if v.slot.unit == "rad" and bare(x) and max(map(abs, floats(x))) > 2.0 * math.pi:
                self.problems.add(
                    s.source.span(v.first, v.last, used_at),
                    f"an angle without a unit is read in radians: {units.show(x)} rad",
                    "write deg after it if degrees are meant",
                    "warning",
                )


def label(s: SettingNode, v: Value) -> str:
    """How a value is called in messages: ``mass``, ``r of sphere``, ``the place of height``."""
    if asks := next((one for one in s.values if one is not None and one.argument is v), None):
        return f"the place of {asks.text}"
    alone = sum(given is not None for given in s.values) == 1
    if alone and not s.words:
        return s.keyword.name
    if alone and v.slot.kind != "number":
        return " ".join((s.keyword.name, *s.words))
    before = s.words[0] if s.words and s.keyword.name == "shape" else s.keyword.name
    return f"{v.slot.text} of {before}" if v.slot.kind == "number" else f"{v.slot.text} in {before}"


def _found(s: SettingNode, v: Value, x) -> str:
    """A value for messages, together with the expression that it comes from."""
    if v.node.constant and v.slot.length == 1:
        return units.show(x)
    text = s.source.excerpt(v.first, v.last)
    return text if v.node.constant else f"{text} = {units.show(x)}" if v.slot.length == 1 else f"{units.show(x)} in {text}"


def _unit_hint(wanted: str, found: units.Dim) -> str:
    dim = units.unit(wanted).dim
    if dim == units.NONE:
        return "leave out the unit"
    if dim == units.unit("rad/s").dim and found == units.unit("1/s").dim:
        return "write rad/s or rpm: one turn is 2*pi rad"
    return f"units that fit: {' '.join(units.fitting(wanted))}"


def kinds(x) -> list:
    """Dimensions of a number or of the parts of a vector."""
    return [units.dimension(c) for c in x] if isinstance(x, tuple) else [units.dimension(x)]


def floats(x) -> list[float]:
    """The numbers themselves, in SI units."""
    return [units.magnitude(c) for c in x] if isinstance(x, tuple) else [units.magnitude(x)]


def finite(x) -> bool:
    """Whether all of them are finite."""
    return all(math.isfinite(c) for c in floats(x))


def bare(x) -> bool:
    """Whether it has no unit and is not merely zeros (zero needs none)."""
    return all(d == units.NONE for d in kinds(x)) and any(floats(x))
