# SPDX-License-Identifier: GPL-2.0-only
"""Runs the lets and repeats of a scene and works out every value: from statements to settings in SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from . import units
from .colors import color
from .expressions import SPOILED, Env
from .keywords import Rule, did_you_mean, example
from .limits import LIMITS, MOST_OBJECTS, MOST_ROUNDS
from .source import Fault, Problems, Source
from .statements import Shared, parse_override
from .tree import Broken, Entry, Group, Let, Name, Repeat, Value
from .wording import estimate, number, whole


@dataclass(slots=True, eq=False)
class Setting:
    """A setting with its values worked out."""

    entry: Entry
    values: tuple

    def span(self, n: int | None = None):
        """Place of the n-th value, or of the keyword and all values."""
        v = self.entry.values[n] if n is not None else None
        if v is None:
            ends = [v.last for v in self.entry.values if v is not None]
            return self.entry.source.span(self.entry.token, ends[-1] if ends else None)
        return self.entry.source.span(v.first, v.last)


@dataclass(slots=True, eq=False)
class Filled:
    """One block, or the scene itself, with its settings."""

    block: str
    group: Group | None = None
    name: str = ""
    settings: dict[str, list[Setting]] = field(default_factory=dict)
    blocks: list[Filled] = field(default_factory=list)
    broken: set[str] = field(default_factory=set)
    """Words whose statement could not be used; that was told already."""
    where: str = ""
    """``(i = 1, j = 2)``, in a repeat."""

    def excused(self, *words: str) -> bool:
        """Whether these words may be missing because something could not be read."""
        return not self.broken.isdisjoint((*words, "include", "repeat"))

    def first(self, word: str) -> Setting | None:
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
        self.loop_names: tuple[str, ...] = ()
        self.overrides = dict(overrides or {})
        self.used: set[str] = set()

    # -- the whole scene

    def scene(self, body: list) -> Filled | None:
        """Everything of a scene, the seed first: rand needs it. None for a scene without measure."""
        env = Env({}, (), self.seed(body), self.strict, self.shared.lets, self.shared.incomplete)
        self.check_overrides()
        if not self.estimate(body, env):
            return None
        out = Filled("")
        self.run(body, env, out)
        return out

    def seed(self, body: list) -> int:
        """``control seed``, worked out with the lets of the outermost level."""
        entry = next(
            (
                e
                for g in body
                if isinstance(g, Group) and g.block == "control"
                for e in g.body
                if isinstance(e, Entry) and e.keyword.name == "seed"
            ),
            None,
        )
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
                self.problems.add(
                    None,
                    f"--set {name}: the scene has no 'let {name}'",
                    did_you_mean(name, self.shared.lets) or "it has no let at all",
                    key=("--set", name),
                )

    def estimate(self, body: list, env: Env) -> bool:
        """Refuse a scene of too many objects before any is made."""
        quiet = Expander(Shared(Problems()), self.overrides, False)
        worst: list[Repeat] = []
        objects, rounds = quiet.count(body, Env({}, seed=env.seed), worst)
        if objects <= MOST_OBJECTS and rounds <= MOST_ROUNDS:
            return True
        place = worst[0] if worst else None
        span = place.source.span(place.token, place.variable) if place else None
        if objects > MOST_OBJECTS:
            self.problems.add(
                span,
                f"this scene has about {estimate(objects)} objects; the most is {whole(MOST_OBJECTS)}",
                "repeat less often",
                key="objects",
            )
        else:
            self.problems.add(
                span,
                f"the repeats of this scene run about {estimate(rounds)} rounds; the most is {whole(MOST_ROUNDS)}",
                "repeat less often",
                key="objects",
            )
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
                inner = env.child({**env.values, str(s.variable): float(low + (high - low) // 2)})
                o, r = self.count(s.body, inner, worst)
                if n * max(o, 1.0) > MOST_OBJECTS or n * (1.0 + r) > MOST_ROUNDS:
                    worst.append(s)
                objects, rounds = objects + n * o, rounds + n * (1.0 + r)
        return objects, rounds

    # -- statements

    def where(self, env: Env) -> str:
        """The repeat indices for messages."""
        if not env.loops:
            return ""
        return " (with " + ", ".join(f"{n} = {i}" for n, i in zip(self.loop_names, env.loops)) + ")"

    def run(self, body: list, env: Env, out: Filled) -> None:
        """Carry out statements; settings and blocks go to ``out``."""
        own: dict[str, Let] = {}
        for s in body:
            if isinstance(s, Entry):
                self.setting(s, env, out)
            elif isinstance(s, Group):
                self.group(s, env, out)
            elif isinstance(s, Repeat):
                self.repeat(s, env, out)
            elif isinstance(s, Broken):
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

    def let(self, s: Let, env: Env) -> None:
        """Work out a let; ``--set`` takes its place."""
        name = str(s.token)
        try:
            value = s.node.run(env)
            if not _finite(value):
                raise Fault(s.node.first, f"{name} is not a finite number", last=s.node.last)
        except Fault as fault:
            self.problems.fault(s.source, fault, self.where(env))
            value = SPOILED
        if name in self.overrides:
            value = self.override(name, s, value)
        env.values[name] = value

    def override(self, name: str, s: Let, original) -> object:
        """The value of ``--set name=value``, which must be of the kind of the let's."""
        given = self.overrides[name]
        source = Source(f"--set {name}", str(given).strip())
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

    def _same_kind(self, name: str, source: Source, node, value, original) -> None:
        one, other = _kinds(value), _kinds(original)
        if len(one) != len(other):
            raise Fault(node.first, f"{name} is {units.show(original)} in the scene, and a value of that kind is needed")
        for a, b in zip(one, other):
            if a != b and a != units.NONE and b != units.NONE:
                raise Fault(
                    node.first,
                    f"{name} is {units.describe(b)} in the scene, found {units.show(value)}",
                    f"units that fit: {' '.join(units.units_of(b))}",
                    node.last,
                )
            if a != b and a == units.NONE:
                self.problems.add(
                    source.span(node.first, node.last),
                    f"--set {name} has no unit and is read as {units.show(value)} {units.symbol(b)}; "
                    f"the scene has {units.show(original)}",
                    "write the unit",
                    "warning",
                )

    def bounds(self, s: Repeat, env: Env) -> tuple[int, int]:
        """First and last index of a repeat."""
        found = []
        for node in (s.low, s.high):
            v = node.run(env)
            if type(v) is not float or v != v or abs(v) > 1e15 or v != int(v):
                raise Fault(node.first, f"repeat counts in whole numbers, found {units.show(v)}", last=node.last)
            found.append(int(v))
        return found[0], found[1]

    def repeat(self, s: Repeat, env: Env, out: Filled) -> None:
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
            self.problems.add(
                s.source.span(s.token, s.variable),
                f"this repeat runs from {low} to {high}: not at all",
                "the first index is the smaller one",
                "warning",
            )
        outer, self.loop_names = self.loop_names, (*self.loop_names, name)
        for i in range(low, high + 1):
            self.rounds += 1
            if self.rounds > MOST_ROUNDS or self.objects > MOST_OBJECTS:
                self.problems.add(
                    s.source.span(s.token, s.variable),
                    f"this scene repeats without measure: more than {MOST_OBJECTS} objects or {MOST_ROUNDS} rounds",
                    "repeat less often",
                    key="objects",
                )
                break
            self.run(s.body, env.child({**env.values, name: float(i)}, (*env.loops, i)), out)
        self.loop_names = outer

    def group(self, s: Group, env: Env, out: Filled) -> None:
        """One block with a scope of its own."""
        try:
            name = self.name(s.name, env) if s.name else ""
        except Fault as fault:
            self.problems.fault(s.source, fault, self.where(env))
            out.broken.add(s.block)
            return
        filled = Filled(s.block, s, name, where=self.where(env))
        self.objects += 1
        self.run(s.body, env.child(dict(env.values)), filled)
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

    def setting(self, s: Entry, env: Env, out: Filled) -> None:
        """Work out a setting and put it into its block."""
        word = s.keyword.name
        given = out.settings.get(word)
        if given and not s.keyword.many:
            first = given[0].entry
            self.problems.add(
                s.source.span(s.token),
                f"{word} is given twice" + (f" in {out.block} {out.name}".rstrip()),
                f"first given at {first.source.span(first.token)}",
            )
            return
        if word == "seed":
            env = env.child(env.values)
            env.seed = None
        try:
            values = s.known if s.known is not None else self.values(s, env)
        except Fault as fault:
            self.problems.fault(s.source, fault, self.where(env))
            out.broken.add(word)
            return
        if given:
            given.append(Setting(s, values))
        else:
            out.settings[word] = [Setting(s, values)]

    def values(self, s: Entry, env: Env) -> tuple:
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
            return self.name(v.name, env), v.text
        if v.name is not None:
            return self.name(v.name, env)
        return v.text if v.node is None else v.node.run(env)

    def checked(self, s: Entry, v: Value, x):
        """A value as the slot wants it."""
        kind = v.slot.kind
        if kind == "color":
            return self._color(s, v, x)
        if kind in ("text", "choice", "check") or v.name is not None:
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

    def number(self, s: Entry, v: Value, x, what: str, first, last) -> float:
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
        limit = s.keyword.limit or LIMITS[v.slot.unit]
        least = limit.least if rule is Rule.POSITIVE else -limit.most
        if not least <= x <= limit.most:
            size = "small" if x < least else "large"
            least, most = (units.show(units.quantity(b, dim)) for b in (limit.least, limit.most))
            goes = f"goes from {least} to {most}" if rule is Rule.POSITIVE else f"goes up to {most}"
            raise Fault(
                first, f"{what} is too {size}: it {goes}, found {units.show(units.quantity(x, dim))}", limit.way_out, last
            )
        return x

    def _color(self, s: Entry, v: Value, x: str) -> str:
        try:
            return color(x)
        except ValueError as e:
            raise Fault(v.first, str(e.args[0]), e.args[1], v.last) from None

    def _half_units(self, s: Entry, raw: list) -> None:
        """``cylinder 10 20 cm`` is 10 m by 20 cm: hardly what was meant."""
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
        for v, x in measured:
            if v.slot.unit == "rad" and _bare(x) and max(map(abs, _floats(x))) > 2.0 * math.pi:
                self.problems.add(
                    s.source.span(v.first, v.last),
                    f"an angle without a unit is read in radians: {units.show(x)} rad",
                    "write deg after it if degrees are meant",
                    "warning",
                )


def label(s: Entry, v: Value) -> str:
    """How a value is called in messages: ``mass``, ``r of sphere``."""
    if len(s.values) == 1 and not s.words:
        return s.keyword.name
    if len(s.values) == 1 and v.slot.kind != "number":
        return " ".join((s.keyword.name, *s.words))
    before = s.words[0] if s.words and s.keyword.name == "shape" else s.keyword.name
    return f"{v.slot.text} of {before}" if v.slot.kind == "number" else f"{v.slot.text} in {before}"


def _found(s: Entry, v: Value, x) -> str:
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
