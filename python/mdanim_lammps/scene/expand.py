# SPDX-License-Identifier: GPL-2.0-only
"""Runs the lets and repeats of a scene and evaluates every value: from statements to settings in SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from . import units
from .colors import color
from .expressions import SPOILED, Env
from .formatting import estimate, number, whole
from .keywords import did_you_mean, example
from .limits import MOST_OBJECTS, MOST_ROUNDS
from .schema import Rule, limit_of
from .source import Fault, Problems, SceneFile
from .statements import Shared, parse_override
from .tree import Group, Let, Name, Repeat, SettingNode, UnreadableStatement, Value

LARGE = 5.0
"""Size of a shape [m] from which on a number without unit gets a note."""


@dataclass(slots=True, eq=False)
class EvaluatedSetting:
    """A setting with its values."""

    entry: SettingNode
    values: tuple

    def span(self, n: int | None = None):
        """Place of the n-th value, or of the keyword and all values."""
        v = self.entry.values[n] if n is not None else None
        if v is None:
            ends = [v.last for v in self.entry.values if v is not None]
            return self.entry.source.span(self.entry.token, ends[-1] if ends else None)
        return self.entry.source.span(v.first, v.last)


@dataclass(slots=True, eq=False)
class EvaluatedBlock:
    """One block, or the scene itself, with its settings."""

    block: str
    group: Group | None = None
    names: tuple[str, ...] = ()
    settings: dict[str, list[EvaluatedSetting]] = field(default_factory=dict)
    blocks: list[EvaluatedBlock] = field(default_factory=list)
    broken: set[str] = field(default_factory=set)
    """Words whose statement could not be used; that was reported already."""
    where: str = ""
    """``(i = 1, j = 2)``, in a repeat."""

    @property
    def name(self) -> str:
        """``ball[3]``, or the names of both objects."""
        return " ".join(self.names)

    def excused(self, *words: str) -> bool:
        """Whether these words may be missing because something could not be read."""
        return not self.broken.isdisjoint((*words, "include", "repeat"))

    def first(self, word: str) -> EvaluatedSetting | None:
        """The setting of a keyword, if there is one."""
        found = self.settings.get(word)
        return found[0] if found else None

    def value(self, word: str, default=None):
        """The first value of a keyword's setting; the default where it is absent or ``auto``."""
        found = self.settings.get(word)
        return found[0].values[0] if found and found[0].values else default


class Expander:
    """Walks the statements with an environment of variables."""

    def __init__(self, shared: Shared, overrides: Mapping[str, str | float] | None, strict: bool):
        self.problems: Problems = shared.problems
        self.strict = strict
        self.shared = shared
        self.rounds = self.objects = 0
        self.overrides = dict(overrides or {})
        self.used: set[str] = set()

    # -- the whole scene

    def scene(self, body: list) -> EvaluatedBlock | None:
        """Everything of a scene, the seed first: rand needs it. None for a scene of too many objects."""
        self.strict |= any(
            isinstance(s, SettingNode) and s.keyword.name == "language" and s.values[0].text == "strict" for s in body
        )
        env = Env({}, (), self.seed(body), self.strict, self.shared.lets, self.shared.incomplete)
        self.check_overrides()
        if not self.estimate(body, env):
            return None
        out = EvaluatedBlock("")
        self.run(body, env, out)
        return out

    def seed(self, body: list) -> int:
        """``control seed``, evaluated with the lets of the outermost level."""
        controls = (g for g in body if isinstance(g, Group) and g.block == "control")
        entry = next((e for g in controls for e in g.body if isinstance(e, SettingNode) and e.keyword.name == "seed"), None)
        if entry is None:
            return 1
        env, quiet = Env({}, seed=None), Expander(Shared(Problems()), self.overrides, False)
        for statement in body:
            if isinstance(statement, Let):
                quiet.let(statement, env)
        try:
            return int(quiet.values(entry, env)[0])
        except Fault:
            env.seed = None
            return 1

    def check_overrides(self) -> None:
        """Every ``--set`` must name a let."""
        for name in self.overrides:
            if name not in self.shared.lets:
                hint = did_you_mean(name, self.shared.lets) or "it has no let at all"
                self.problems.add(None, f"--set {name}: the scene has no 'let {name}'", hint, key=("--set", name))

    def estimate(self, body: list, env: Env) -> bool:
        """Refuse a scene of too many objects before any is made."""
        quiet = Expander(Shared(Problems()), self.overrides, False)
        worst: list[Repeat] = []
        objects, rounds = quiet.count(body, Env({}, seed=env.seed), worst)
        if objects <= MOST_OBJECTS and rounds <= MOST_ROUNDS:
            return True
        span = worst[0].source.span(worst[0].token, worst[0].variable) if worst else None
        if objects > MOST_OBJECTS:
            cause = f"this scene has about {estimate(objects)} objects; the most is {whole(MOST_OBJECTS)}"
        else:
            cause = f"the repeats of this scene run about {estimate(rounds)} rounds; the most is {whole(MOST_ROUNDS)}"
        self.problems.add(span, cause, "repeat less often", key="objects")
        return False

    def count(self, body: list, env: Env, worst: list) -> tuple[float, float]:
        """About how many objects and rounds a body makes; inner repeats at the middle of the outer one."""
        objects = rounds = 0.0
        for s in body:
            if isinstance(s, Group):
                objects += 1
            elif isinstance(s, Let):
                self.let(s, env)
            elif isinstance(s, Repeat):
                try:
                    low, high = self.bounds(s, env)
                except Fault:
                    continue
                if high < low:
                    continue
                n = high - low + 1.0
                known = len(env.values)
                env.values.setdefault(str(s.variable), float(low + (high - low) // 2))
                o, r = self.count(s.body, replace(env, counters=(*env.counters, str(s.variable))), worst)
                while len(env.values) > known:
                    env.values.popitem()
                if n * max(o, 1.0) > MOST_OBJECTS or n * (1.0 + r) > MOST_ROUNDS:
                    worst.append(s)
                objects, rounds = objects + n * o, rounds + n * (1.0 + r)
        return objects, rounds

    # -- statements

    def where(self, env: Env) -> str:
        """The indices of the repeats for messages."""
        if not env.loops:
            return ""
        return " (with " + ", ".join(f"{n} = {i}" for n, i in zip(env.counters, env.loops)) + ")"

    def run(self, body: list, env: Env, out: EvaluatedBlock) -> None:
        """Carry out statements; settings and blocks go to ``out``."""
        own: dict[str, Let] = {}
        for s in body:
            if isinstance(s, SettingNode):
                self.setting(s, env, out)
            elif isinstance(s, Group):
                self.group(s, env, out)
            elif isinstance(s, Repeat):
                self.repeat(s, env, out)
            elif isinstance(s, UnreadableStatement):
                out.broken.add(s.word)
                if s.name:
                    env.values.setdefault(s.name, SPOILED)
            elif s.token in env.values:
                first = own.get(str(s.token))
                place = f"first given at {first.source.span(first.token)}" if first else "it is known outside already"
                self.problems.add(s.source.span(s.token), f"'{s.token}' is given twice", place)
            else:
                own[str(s.token)] = s
                self.let(s, env)

    def scope(self, body: list, env: Env, out: EvaluatedBlock) -> None:
        """Carry out the statements in braces; names that they give end there."""
        known = len(env.values)
        self.run(body, env, out)
        while len(env.values) > known:
            env.values.popitem()  # the name given last: none hides another

    def let(self, s: Let, env: Env) -> None:
        """Evaluate a let; ``--set`` takes its place."""
        name = str(s.token)
        try:
            value = s.node.run(env)
            if not _finite(value):
                raise Fault(s.node.first, f"{name} is not a finite number", last=s.node.last)
        except Fault as fault:
            self.problems.fault(s.source, fault, self.where(env))
            value = SPOILED
        if name in self.overrides:
            value = self.override(name, value)
        env.values[name] = value

    def override(self, name: str, original) -> object:
        """The value of ``--set name=value``, which must be of the kind of the let's."""
        given = self.overrides[name]
        source = SceneFile(f"--set {name}", str(given).strip())
        node = parse_override(source, self.problems)
        if node is None:
            return SPOILED
        try:
            value = node.run(Env({}, seed=1, strict=self.strict))
            if not _finite(value):
                raise Fault(node.first, f"{name} is not a finite number")
            if original is not SPOILED:
                self._same_kind(name, source, node, value, original)
        except Fault as fault:
            self.problems.fault(source, fault)
            return SPOILED
        return value

    def _same_kind(self, name: str, source: SceneFile, node, value, original) -> None:
        one, other = _kinds(value), _kinds(original)
        if len(one) != len(other):
            raise Fault(node.first, f"{name} is {units.show(original)} in the scene, and a value of that kind is needed")
        for a, b in zip(one, other):
            if a != b and a != units.NONE and b != units.NONE:
                cause = f"{name} is {units.describe(b)} in the scene, found {units.show(value)}"
                raise Fault(node.first, cause, f"units that fit: {' '.join(units.units_of(b))}", node.last)
            if a != b and a == units.NONE:
                cause = f"--set {name} has no unit and is read as {units.show(value)} {units.symbol(b)}"
                cause += f"; the scene has {units.show(original)}"
                self.problems.add(source.span(node.first, node.last), cause, "write the unit", "warning")

    def bounds(self, s: Repeat, env: Env) -> tuple[int, int]:
        """First and last index of a repeat."""
        found = []
        for node in (s.low, s.high):
            v = node.run(env)
            if type(v) is not float or v != v or abs(v) > 1e15 or v != int(v):
                raise Fault(node.first, f"repeat counts in whole numbers, found {units.show(v)}", last=node.last)
            found.append(int(v))
        return found[0], found[1]

    def repeat(self, s: Repeat, env: Env, out: EvaluatedBlock) -> None:
        """Run the body once for every index."""
        name = str(s.variable)
        if name in env.values:
            self.problems.add(s.source.span(s.variable), f"'{name}' is given twice", "take another name for this repeat")
            return
        try:
            low, high = self.bounds(s, env)
        except Fault as fault:
            self.problems.fault(s.source, fault, self.where(env))
            return
        if high < low:
            cause = f"this repeat runs from {low} to {high}: not at all"
            self.problems.add(s.source.span(s.token, s.variable), cause, "the first index is the smaller one", "warning")
        for i in range(low, high + 1):
            self.rounds += 1
            if self.rounds > MOST_ROUNDS or self.objects > MOST_OBJECTS:
                cause = f"this scene has more than {whole(MOST_OBJECTS)} objects or {whole(MOST_ROUNDS)} rounds of repeats"
                self.problems.add(s.source.span(s.token, s.variable), cause, "repeat less often", key="objects")
                break
            env.values[name] = float(i)
            self.scope(s.body, env.within(name, i), out)
        env.values.pop(name, None)

    def group(self, s: Group, env: Env, out: EvaluatedBlock) -> None:
        """One block with a scope of its own."""
        try:
            names = tuple(self.name(name, env) for name in s.names)
        except Fault as fault:
            self.problems.fault(s.source, fault, self.where(env))
            out.broken.add(s.block)
            return
        filled = EvaluatedBlock(s.block, s, names, where=self.where(env))
        self.objects += 1
        self.scope(s.body, env, filled)
        out.blocks.append(filled)

    def name(self, name: Name, env: Env) -> str:
        """``ball[12]``"""
        if name.index is None:
            return str(name.token)
        v = name.index.run(env)
        if type(v) is not float or v != v or abs(v) > 1e15 or abs(v - round(v)) > 1e-9:
            raise Fault(name.index.first, f"an index is a whole number, found {units.show(v)}", last=name.index.last)
        return f"{name.token}[{round(v)}]"

    # -- settings

    def setting(self, s: SettingNode, env: Env, out: EvaluatedBlock) -> None:
        """Evaluate a setting and put it into its block."""
        word = s.keyword.name
        given = out.settings.get(word)
        if given and not s.keyword.many:
            first = given[0].entry
            cause = f"{word} is given twice" + f" in {out.block} {out.name}".rstrip()
            self.problems.add(s.source.span(s.token), cause, f"first given at {first.source.span(first.token)}")
            return
        if word == "seed":
            env = replace(env, seed=None)
        try:
            values = s.known if s.known is not None else self.values(s, env)
        except Fault as fault:
            self.problems.fault(s.source, fault, self.where(env))
            out.broken.add(word)
            return
        if given:
            given.append(EvaluatedSetting(s, values))
        else:
            out.settings[word] = [EvaluatedSetting(s, values)]

    def values(self, s: SettingNode, env: Env) -> tuple:
        """All values of a setting in SI units; raises Fault."""
        raw = [None if v is None else self.raw(v, env) for v in s.values]
        result = tuple([None if v is None else self.checked(s, v, x) for v, x in zip(s.values, raw)])
        self._half_units(s, raw)
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
        if kind in ("text", "choice", "relation") or v.name is not None:
            return x
        what = label(s, v)
        if kind == "number":
            if isinstance(x, tuple):
                raise Fault(v.first, f"{what} is a number, found the vector {units.show(x)}", last=v.last)
            return x if v.slot.unit == "?" else self.number(s, v, x, what, v.first, v.last)
        if not isinstance(x, tuple) or len(x) != v.slot.length:
            found = f"{len(x)} numbers" if isinstance(x, tuple) else f"the number {units.show(x)}"
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
        rule = s.keyword.rule
        if type(x) is not float:
            if x.dim != dim:
                raise Fault(
                    first,
                    f"{what} must be {units.describe(dim)}, found {_found(s, v, x)}, {units.describe(x.dim)}",
                    _unit_hint(dim, x.dim),
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
            raise Fault(first, f"{what} must be {rule.value}, found {_found(s, v, units.quantity(x, dim))}", last=last)
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

    def _color(self, v: Value, x: str) -> str:
        try:
            return color(x)
        except ValueError as e:
            raise Fault(v.first, str(e.args[0]), e.args[1], v.last) from None

    def _half_units(self, s: SettingNode, raw: list) -> None:
        """``cylinder 10 20 cm`` is 10 m by 20 cm, and ``sphere 10`` a ball of 10 m: most likely not what was meant."""
        measured = [
            (v, x) for v, x in zip(s.values, raw) if v is not None and v.slot.unit not in ("1", "?") and not isinstance(x, str)
        ]
        bare = [v for v, x in measured if _bare(x)]
        if bare and len(bare) < len(measured):
            unit = bare[0].slot.unit
            self.problems.add(
                s.source.span(bare[0].first, bare[0].last),
                f"this value of {s.keyword.name} has no unit and is read in {unit}, the other one has a unit",
                "write a unit after each value",
                "warning",
            )
            return
        for v, x in measured if s.keyword.name == "shape" else ():
            if v.slot.unit == "m" and (largest := max(_floats(x))) >= LARGE and _bare(x):
                told = f"this size has no unit and is read in metres: {units.show(units.quantity(largest, v.slot.dim))}"
                self.problems.add(s.source.span(v.first, v.last), told, "write its unit: 10 cm, or 10 m", "note")
        for v, x in measured:
            if v.slot.unit == "rad" and _bare(x) and max(map(abs, _floats(x))) > 2.0 * math.pi:
                self.problems.add(
                    s.source.span(v.first, v.last),
                    f"an angle without a unit is read in radians: {units.show(x)} rad",
                    "write deg after it if degrees are meant",
                    "warning",
                )


def label(s: SettingNode, v: Value) -> str:
    """How a value is called in messages: ``mass``, ``r of sphere``."""
    if len(s.values) == 1 and not s.words:
        return s.keyword.name
    if len(s.values) == 1 and v.slot.kind != "number":
        return " ".join((s.keyword.name, *s.words))
    before = s.words[0] if s.words and s.keyword.name == "shape" else s.keyword.name
    return f"{v.slot.text} of {before}" if v.slot.kind == "number" else f"{v.slot.text} in {before}"


def _found(s: SettingNode, v: Value, x) -> str:
    """A value for messages, together with the expression that it comes from."""
    if v.node.constant and v.slot.length == 1:
        return units.show(x)
    text = s.source.excerpt(v.first, v.last)
    return text if v.node.constant else f"{text} = {units.show(x)}" if v.slot.length == 1 else f"{units.show(x)} in {text}"


def _unit_hint(dim: units.Dim, found: units.Dim) -> str:
    if dim == units.NONE:
        return "leave out the unit"
    if dim == units.unit("rad/s").dim and found == units.unit("1/s").dim:
        return "write rad/s or rpm: one turn is 2*pi rad"
    return f"units that fit: {' '.join(units.units_of(dim))}"


def _kinds(x) -> list:
    return [units.dimension(c) for c in x] if isinstance(x, tuple) else [units.dimension(x)]


def _floats(x) -> list[float]:
    return [units.magnitude(c) for c in x] if isinstance(x, tuple) else [units.magnitude(x)]


def _finite(x) -> bool:
    return all(math.isfinite(c) for c in _floats(x))


def _bare(x) -> bool:
    """No unit, and not merely zeros (zero needs none)."""
    return all(d == units.NONE for d in _kinds(x)) and any(_floats(x))
