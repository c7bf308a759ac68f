# SPDX-License-Identifier: GPL-2.0-only
"""Runs the lets and repeats of a scene and evaluates every value: from statements to settings in SI units."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import replace

from ..errors import Span
from . import units
from .evaluated import EvaluatedBlock, around
from .expressions import SPOILED, Env, Properties
from .formatting import estimate, whole
from .keywords import BLOCKS, KEYWORDS, did_you_mean
from .limits import DEEPEST_GROUP, MOST_OBJECTS, MOST_PLACES, MOST_ROUNDS
from .setting_reader import Shared
from .source import Fault, Problems, SceneFile
from .statements import parse_override
from .tree import Group, Let, Repeat, Set, SettingNode, Template, UnreadableStatement, Use
from .values import Evaluator, finite, kinds


class Expander(Evaluator):
    """Walks the statements with an environment of variables."""

    def __init__(self, shared: Shared, overrides: Mapping[str, str | float] | None, strict: bool):
        super().__init__(shared.problems, strict)
        self.shared = shared
        self.rounds = self.objects = self.places = 0
        self.templates: dict[str, tuple[Template, Env]] = {}
        """Groups by name, each with what is known where it stands."""
        self.inside: EvaluatedBlock | None = None
        """The place of the group whose body is carried out."""
        self.placed: set[str] = set()
        """Groups that are placed somewhere."""
        self.overrides = dict(overrides or {})

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
        for name, (s, _) in self.templates.items():
            if name not in self.placed and not self.problems.errors:
                cause = f"the group {name} is not placed, so it is not a part of the scene"
                self.problems.add(s.source.span(s.name), cause, f"write place {name} {{ }}", "warning")
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
        worst: list[Span] = []
        objects, rounds = quiet.count(body, Env({}, seed=env.seed), worst)
        if objects <= MOST_OBJECTS and rounds <= MOST_ROUNDS:
            return True
        span = worst[0] if worst else None
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
            if isinstance(s, Group) and s.of is not None:
                o, r = self.count_placed(s, env, worst)
                objects, rounds = objects + o, rounds + r
            elif isinstance(s, Group):
                objects += 1
            elif isinstance(s, Template):
                self.define(s, env)
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
                    worst.append(s.source.span(s.token, s.variable))
                objects, rounds = objects + n * o, rounds + n * (1.0 + r)
        return objects, rounds

    def count_placed(self, s: Group, env: Env, worst: list) -> tuple[float, float]:
        """The same of a placed group. Groups that place each other too often are stopped while they are made."""
        self.places += 1
        if self.places > MOST_PLACES or str(s.of) not in self.templates or len(env.used_at) == DEEPEST_GROUP:
            return 0.0, 1.0
        template, within = self.surroundings(s, env, "")
        o, r = self.count(template.body, within, worst)
        if o > MOST_OBJECTS or r > MOST_ROUNDS:
            worst.append(s.source.span(s.of))
        return o, 1.0 + r

    # -- statements

    def run(self, body: list, env: Env, out: EvaluatedBlock) -> None:
        """Carry out statements; settings and blocks go to ``out``."""
        own: dict[str, Let] = {}
        for s in body:
            if isinstance(s, SettingNode):
                self.setting(s, env, out)
            elif isinstance(s, Group):
                (self.group if s.of is None else self.place)(s, env, out)
            elif isinstance(s, Template):
                self.define(s, env)
            elif isinstance(s, Repeat):
                self.repeat(s, env, out)
            elif isinstance(s, Set):
                pass  # `surroundings` has seen to it
            elif isinstance(s, Use):
                out.uses.append(s)
            elif isinstance(s, UnreadableStatement):
                out.broken.add(s.word)
                if s.name:
                    env.values.setdefault(s.name, SPOILED)
            elif s.token in env.values:
                first = own.get(str(s.token))
                place = f"first given at {first.source.span(first.token)}" if first else "it is known outside already"
                self.problems.add(s.source.span(s.token, None, env.used_at), f"'{s.token}' is given twice", place)
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
        value = self.value_of(s, env)
        if name in self.overrides:
            value = self.override(name, value)
        if name in env.given:
            value = self.replaced(*env.given[name], value)
        env.values[name] = value

    def value_of(self, s: Let | Set, env: Env) -> object:
        """The value of a let or a set; SPOILED after a problem."""
        if s.node is None:
            return self.properties(s, env)
        if (name := s.node.name) is s.node.first and type(value := env.values.get(str(name))) is Properties:
            return value
        try:
            value = s.node.run(env)
            if not finite(value):
                raise Fault(s.node.first, f"{s.token} is not a finite number", last=s.node.last)
            return value
        except Fault as fault:
            self.fault(s.source, fault, env)
            return SPOILED

    def replaced(self, s: Set, value: object, original: object) -> object:
        """The value of a ``set`` of a place, which must be of the kind of the let's."""
        try:
            if SPOILED not in (value, original):
                self._same_kind(f"set {s.token}", s.source, s.node, value, original)
        except Fault as fault:
            self.problems.fault(s.source, fault)
            return SPOILED
        return value

    def override(self, name: str, original) -> object:
        """The value of ``--set name=value``, which must be of the kind of the let's."""
        given = self.overrides[name]
        if type(original) is Properties:
            cause = f"--set {name}: in the scene it stands for settings of an object, which no --set can give"
            self.problems.add(None, cause, "give a value inside it a let of its own", key=("--set", name))
            return original
        source = SceneFile(f"--set {name}", str(given).strip())
        node = parse_override(source, self.problems)
        if node is None:
            return SPOILED
        try:
            value = node.run(Env({}, seed=1, strict=self.strict))
            if not finite(value):
                raise Fault(node.first, f"{name} is not a finite number")
            if original is not SPOILED:
                self._same_kind(f"--set {name}", source, node, value, original)
        except Fault as fault:
            self.problems.fault(source, fault)
            return SPOILED
        return value

    def properties(self, s: Let, env: Env) -> Properties:
        """Settings in braces, evaluated where the let stands."""
        found = EvaluatedBlock("let", names=(str(s.token),), used_at=env.used_at)
        self.scope(s.body, env, found)
        self.take_uses(found, env)
        return Properties(found.settings, found.broken, len(env.used_at))

    def take_uses(self, out: EvaluatedBlock, env: Env) -> None:
        """Give a block the settings that it uses, where it has none of its own."""
        own, origin = out.words(), {}
        for s in out.uses:
            found = env.values.get(str(s.token))
            if type(found) is not Properties:
                self.no_properties(s, found, env, out)
                continue
            out.broken |= found.broken
            for word, given in found.settings.items():
                if word in own:
                    continue
                if (first := origin.setdefault(word, s)) is not s:
                    cause = f"both {first.token} and {s.token} give {word}"
                    self.told(env, s.source, s.token, cause, f"write {word} in the {out.block} itself, or use one of them")
                else:
                    place = s.source.span(s.token)
                    used_at = [(*env.used_at, place, *one.used_at[found.depth :]) for one in given]
                    out.settings[word] = [replace(one, used_at=at) for one, at in zip(given, used_at)]

    def no_properties(self, s: Use, found: object, env: Env, out: EvaluatedBlock) -> None:
        """Say why a name cannot be used; nothing may be missing in the block that uses it."""
        out.broken |= set(KEYWORDS["object"])
        if found is SPOILED or (found is None and env.incomplete):
            return
        known = [name for name, value in env.values.items() if type(value) is Properties]
        line = env.later.get(str(s.token))
        if found is not None:
            cause, hint = (
                f"{s.token} is {units.show(found)}, not settings of an object",
                f"write let {s.token} = {{ density ... }}",
            )
        elif line is not None and line > s.token.line:
            cause, hint = f"'{s.token}' is used before its let", f"it stands at line {line}; move it up"
        else:
            cause = f"no let gives settings the name {s.token}"
            hint = did_you_mean(str(s.token), known) if known else f"write let {s.token} = {{ density ... }} above"
        self.told(env, s.source, s.token, cause, hint)

    def _same_kind(self, how: str, source: SceneFile, node, value, original) -> None:
        if Properties in (type(value), type(original)):
            if type(value) is type(original):
                return
            is_, one = ("settings", "such a let") if type(original) is Properties else ("a value", "a value")
            raise Fault(node.first, f"{how.split()[1]} stands for {is_} in the scene, and {one} is needed", last=node.last)
        one, other, name = kinds(value), kinds(original), how.split()[1]
        if len(one) != len(other):
            raise Fault(node.first, f"{name} is {units.show(original)} in the scene, and a value of that kind is needed")
        for a, b in zip(one, other):
            if a != b and a != units.NONE and b != units.NONE:
                cause = f"{name} is {units.describe(b)} in the scene, found {units.show(value)}"
                raise Fault(node.first, cause, f"units that fit: {' '.join(units.units_of(b))}", node.last)
            if a != b and a == units.NONE:
                cause = f"{how} has no unit and is read as {units.show(value)} {units.symbol(b)}"
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
            hint = "take another name for this repeat"
            self.problems.add(s.source.span(s.variable, None, env.used_at), f"'{name}' is given twice", hint)
            return
        try:
            low, high = self.bounds(s, env)
        except Fault as fault:
            self.fault(s.source, fault, env)
            return
        span = s.source.span(s.token, s.variable, env.used_at)
        if high < low:
            cause = f"this repeat runs from {low} to {high}: not at all"
            self.problems.add(span, cause, "the first index is the smaller one", "warning")
        for i in range(low, high + 1):
            if self.too_many(span):
                break
            env.values[name] = float(i)
            self.scope(s.body, env.within(name, i), out)
        env.values.pop(name, None)

    def too_many(self, span: Span) -> bool:
        """Whether one more round, of a repeat or a placed group, is more than a scene may have."""
        self.rounds += 1
        if self.rounds <= MOST_ROUNDS and self.objects <= MOST_OBJECTS:
            return False
        cause = f"this scene has more than {whole(MOST_OBJECTS)} objects or {whole(MOST_ROUNDS)} rounds of repeats"
        self.problems.add(span, cause, "repeat less often", key="objects")
        return True

    # -- blocks and groups

    def group(self, s: Group, env: Env, out: EvaluatedBlock) -> EvaluatedBlock | None:
        """One block with a scope of its own; None where it has no name."""
        try:
            names = tuple(self.name(name, env) for name in s.names)
        except Fault as fault:
            self.fault(s.source, fault, env)
            out.broken.add(s.block)
            return None
        if env.prefix and not BLOCKS[s.block].of_objects:  # names of a contact block may be of other objects
            names = tuple(f"{env.prefix}.{name}" for name in names)
        filled = EvaluatedBlock(s.block, s, names, where=self.where(env), used_at=env.used_at, inside=self.inside)
        self.objects += s.of is None
        self.scope(s.body, env, filled)
        if filled.uses:
            self.take_uses(filled, env)
        out.blocks.append(filled)
        return filled

    def define(self, s: Template, env: Env) -> None:
        """Keep a group with the names that are known where it stands."""
        if str(s.name) in self.templates:
            first = self.templates[str(s.name)][0]
            cause = f"the group {s.name} is given twice"
            self.problems.add(s.source.span(s.name), cause, f"first given at {first.source.span(first.name)}")
        else:
            self.templates[str(s.name)] = s, replace(env, values=dict(env.values))

    def place(self, s: Group, env: Env, out: EvaluatedBlock) -> None:
        """Carry out the body of a group under a name of its own."""
        name, span = str(s.of), s.source.span(s.of, None, env.used_at)
        self.places += 1
        if self.places > MOST_PLACES:
            cause = f"this scene places groups more than {whole(MOST_PLACES)} times"
            self.problems.add(span, cause, "place fewer, or put more into one group", key="objects")
            return
        if self.too_many(span):
            return
        filled = self.group(s, env, out)
        self.placed.add(name)
        if name not in self.templates:
            if not out.excused("group"):
                hint = did_you_mean(name, self.templates) or f"write group {name} {{ ... }} above it"
                self.told(env, s.source, s.of, f"no group is called {name}", hint)
            out.broken.add("object")
        elif any(block.group.of == name for block in around(self.inside)):
            self.told(env, s.source, s.of, f"the group {name} places itself", "take this place out of it")
        elif len(env.used_at) == DEEPEST_GROUP:
            self.told(env, s.source, s.of, f"groups are placed more than {DEEPEST_GROUP} levels deep in each other")
        elif filled is not None:
            template, within = self.surroundings(s, env, filled.name)
            outer, self.inside = self.inside, filled
            self.run(template.body, within, out)
            self.inside = outer

    def surroundings(self, s: Group, env: Env, prefix: str) -> tuple[Template, Env]:
        """A placed group, and what its body knows: names from where the group stands, and what the place gives to its lets.

        ``rand`` in it depends on the name under which it is placed, so that one more place does not change the others.
        """
        template, known = self.templates[str(s.of)]
        lets = [str(t.token) for t in template.body if isinstance(t, Let)]
        given: dict[str, tuple[Set, object]] = {}
        for v in (v for v in s.body if isinstance(v, Set)):
            name = str(v.token)
            if name in given:
                self.told(env, v.source, v.token, f"{name} is set twice", "remove one of them")
            elif name not in lets:
                hint = did_you_mean(name, lets) if lets else "what a place may set are the lets of its group"
                self.told(env, v.source, v.token, f"the group {s.of} has no 'let {name}'", hint)
            else:
                given[name] = v, self.value_of(v, env)
        within = replace(
            known,
            values=dict(known.values),
            loops=(zlib.crc32(prefix.encode()),),
            counters=("",),
            prefix=prefix,
            used_at=(*env.used_at, s.source.span(s.of)),
            given=given,
        )
        return template, within
