# SPDX-License-Identifier: GPL-2.0-only
"""The language in the fields of a record: keyword, form, unit, range, default, example.

`setting` gives a field its keyword. Parser, range checks, messages, docs/language.md, records and scene.lock.txt follow from it.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from typing import Any, NamedTuple

from ..errors import UsageError
from ..features import facets
from ..records import dataclass, extended
from .formatting import number
from .forms import Slot, alternatives, write
from .limits import LIMITS, OTHER_UNIT, Limit
from .units import unit

Vector = tuple[float, float, float]


BOX = "from <(x0, y0, z0):m> to <(x1, y1, z1):m>"
"""Two corners of a box of the world, the lower one first."""
COLOR = 'a CSS name or "#rrggbb". Absent: chosen automatically.'
"""How a colour is given."""


class Rule(Enum):
    """Conditions on a number."""

    ANY = "any number"
    POSITIVE = "> 0"
    NOT_NEGATIVE = ">= 0"
    COUNT = "a whole number >= 1"
    WHOLE = "a whole number >= 0"
    SEVERAL = "a whole number >= 2"

    def holds(self, x: float) -> bool:
        """Whether a finite number obeys the rule."""
        if self is Rule.ANY:
            return True
        if self is Rule.POSITIVE:
            return x > 0.0
        if self is Rule.NOT_NEGATIVE:
            return x >= 0.0
        return x == int(x) and int(self.value[-1]) <= x < 2**53


class Observable(NamedTuple):
    """A quantity that ``expect`` can check."""

    unit: str
    """``1`` for plain numbers."""
    about: str
    needs: str = ""
    """The effect that must be on; it has the name of the block that brings it into a scene."""
    takes: str = ""
    """Its argument: ``object``, another object; ``joined``, that or ``world``; ``touched``, that or ``ground`` or ``walls``;
    ``place``, a point (x, y) [m]; ``cut``, where a plane is [m]; or nothing."""
    bound: bool = False
    """Whether an ``expect`` says how large it may be, and nothing of what is true."""
    alone: bool = False
    """Whether it also stands without its argument."""
    narrows: bool = False
    """Whether it only says of what kind is meant: the page of the language has no row for it."""


def meaning(subject: str, quantity: Observable) -> str:
    """In words, with what it needs besides its subject."""
    return quantity.about + (f"; needs the effect `{quantity.needs}`" if quantity.needs not in ("", subject) else "")


class Codec:
    """How the values of a setting become what the record holds, and back. This one: a value, or None for ``auto``."""

    def read(self, k: Keyword, choice: int, values: tuple) -> Any:
        """The value of the record's field, from the values of one alternative. Raises ValueError(message, hint, index of the
        value)."""
        if not values:
            return None
        if k.rule in (Rule.COUNT, Rule.WHOLE, Rule.SEVERAL):
            return tuple(map(int, values[0])) if isinstance(values[0], tuple) else int(values[0])
        return values[0] if len(values) == 1 else values

    def gather(self, values: tuple) -> Any:
        """The value of the record's fields, from those of all times that a setting is given. Raises ValueError(message, hint,
        number of the one that is wrong)."""
        return values

    def scatter(self, value: Any) -> tuple:
        """The same back."""
        return value

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple] | None:
        """Alternative and values that are read as this; None where nothing is written."""
        for choice, parts in enumerate(alternatives(k.form)):
            slots = sum(isinstance(p, Slot) for p in parts)
            if (value is None) == (slots == 0):
                return choice, () if value is None else value if slots > 1 else (value,)
        return None


PLAIN = Codec()


@dataclass(frozen=True, slots=True)
class Words(Codec):
    """A member of an enumeration, named by its value: as a choice, or as an alternative of its own."""

    kind: type[Enum]

    def read(self, k: Keyword, choice: int, values: tuple) -> Any:
        return self.kind(values[0])

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple] | None:
        return None if value is None else (0, (value.value,))


class OneOf(Codec):
    """A record of one of several classes; ``FORMS`` of a class are its alternatives, with slots in the order of its fields."""

    def __init__(self, *kinds: type):
        self.kinds = kinds
        self.rows = [kind for kind in kinds for _ in kind.FORMS]
        self.form = " | ".join(form for kind in kinds for form in kind.FORMS)

    def kind(self, choice: int, values: tuple) -> type:
        """The class of the record that values become."""
        return self.rows[choice]

    def read(self, k: Keyword, choice: int, values: tuple) -> Any:
        kind = self.rows[choice]
        if hasattr(kind, "read"):
            return kind.read(choice - self.rows.index(kind), values)
        return kind(**{name: v for name, v in zip(fields_in_order(kind), values) if v is not None})

    def write(self, k: Keyword, value: Any) -> tuple[int, tuple] | None:
        if value is None:
            return None
        kind = type(value)
        own, values = value.write() if hasattr(kind, "write") else (0, tuple(getattr(value, n) for n in fields_in_order(kind)))
        return self.rows.index(kind) + own, values


class Worded:
    """A record whose enumerations may be given by their words in Python: ``Render(quality="final")``. Raises UsageError."""

    __slots__ = ()

    def __post_init__(self):
        for field in dataclasses.fields(self):
            kind, value = type(field.default), getattr(self, field.name)
            if issubclass(kind, Enum) and not isinstance(value, kind):
                try:
                    object.__setattr__(self, field.name, kind(value))
                except ValueError:
                    words = ", ".join(member.value for member in kind)
                    raise UsageError(f"{type(self).__name__}({field.name}={value!r}): it is one of {words}") from None


def brought(record: Any) -> tuple[str, ...]:
    """Settings of a record that follow from its others: what the values of these say by ``BRINGS``."""
    return tuple(name for f in dataclasses.fields(record) for name in getattr(getattr(record, f.name), "BRINGS", ()))


def fields_in_order(kind: type) -> tuple[str, ...]:
    """Fields of a class as its form has them."""
    return getattr(kind, "ORDER", None) or tuple(f.name for f in dataclasses.fields(kind))


@dataclass(frozen=True, slots=True, eq=False)
class Keyword:
    """One setting of the language."""

    form: str
    """Text after the word: literal words, ``<slot:unit>``, ``[optional]``, `` | `` between alternatives; ``<@slot:unit>`` is a
    place, for which the rule does not hold."""
    about: str
    example: str
    """An example of the text after the word."""
    rule: Rule = Rule.ANY
    """Holds for every number of the setting."""
    limit: Limit | None = None
    """Holds for every number of the setting; None is the limit of its unit."""
    codec: Codec = PLAIN
    many: bool = False
    """May be given several times."""
    gone: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """Choices that there were, by their first word, each with the way out."""
    one_of: tuple[str, ...] = ()
    """Exactly one of these is given."""
    also: tuple[str, ...] = ()
    """Further fields that the values fill, after the first."""
    shared: bool = False
    """Whether blocks that are `of` its block have it, too."""
    needed: bool = False
    absent: Any = None
    """Value of the record's field where the keyword is not given."""
    default: str = ""
    """The same, as it would be written in a scene."""
    block: str = ""
    """Block it stands in; the empty string is the scene itself."""
    name: str = ""
    field: str = ""
    """The first field of the record that it fills."""

    def read(self, choice: int, values: tuple) -> dict[str, Any]:
        """Fields of the record. Raises ValueError(message, hint, value's number)."""
        value = self.codec.read(self, choice, values)
        return dict(zip((self.field, *self.also), value)) if self.also and not self.many else {self.field: value}

    def gathered(self, reads: list[dict[str, Any]]) -> dict[str, Any]:
        """Fields of the record, from all times that the setting is given. Raises ValueError(message, hint, number of one)."""
        if not self.many:
            return reads[0]
        value = self.codec.gather(tuple(read[self.field] for read in reads))
        return dict(zip((self.field, *self.also), value)) if self.also else {self.field: value}

    def lines(self, record: Any, number: Callable[[float], str] = repr) -> list[str]:
        """Text after the keyword, once for every time it is given."""
        if self.name in brought(record):
            return []
        value = getattr(record, self.field)
        if self.also:
            value = (value, *(getattr(record, name) for name in self.also))
        found = [self.codec.write(self, v) for v in (self.codec.scatter(value) if self.many else (value,))]
        return [write(alternatives(self.form)[c], values, number) for c, values in filter(None, found)]


@dataclass(frozen=True, slots=True)
class Block:
    """One kind of block in braces."""

    name: str
    record: type | None
    """The record that it becomes; None for ``effects``, which becomes a mapping."""
    field: str
    """The field of SceneRecord that holds it, a tuple of all where there may be many; empty where it becomes something else."""
    about: str
    names: tuple[str, ...] = ()
    """Fields of the record that take the names after its word."""
    kinds: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """Words of which one stands before the names, ``joint hinge``, each with its meaning; the field ``kind`` of the record takes
    it."""
    indexed: bool = False
    """Whether a name may have an index, ``ball[3]``."""
    of_objects: bool = False
    """Whether the names are those of objects, repeats and planes of the scene, not a name of its own."""
    instead: tuple[str, ...] = ()
    """Words that may stand for an object in it, in place of those of planes."""
    many: bool = False
    holds: tuple[str, ...] = ()
    """Blocks that may stand in it."""
    of: str = ""
    """The block whose shared settings it has, to give them to others; it becomes no record, and has names of its own."""
    in_group: bool = False
    """Whether it may stand in a group."""
    raw: bool = False
    """Whether it holds lines of another language; its record is made of each command."""
    enough: bool = False
    """Whether a scene with such a block has something to compute."""
    order: int = 0
    """Place among the blocks of features, ascending."""
    form: str = ""
    """Its names, where they are not as many as the fields."""

    @property
    def head(self) -> str:
        """The word and what follows it up to the brace: ``object NAME[index]``."""
        if self.form:
            return f"{self.name} {self.form}"
        kinds = ["|".join(self.kinds)] if self.kinds else []
        return " ".join((self.name, *kinds, *(["NAME[index]" if self.indexed else "NAME"] * len(self.names))))


def setting(
    form: str | None,
    about: str,
    example: str,
    rule: Rule = Rule.ANY,
    *,
    default: Any = dataclasses.MISSING,
    name: str = "",
    absent: Any = dataclasses.MISSING,
    codec: Codec | None = None,
    after: str = "",
    compare: bool = True,
    **facts: Any,
) -> Any:
    """A field of a record together with its keyword, which is called as the field unless ``name`` says otherwise.

    ``default`` is that of the field, ``absent`` one that the field itself does not have; without both the keyword must be given.
    ``after`` is the field behind which a setting that a feature adds is told. Without ``compare`` records that differ in it alone
    are equal.
    ``facts`` are further fields of Keyword.
    """
    codec = codec or PLAIN
    if form is None:
        form = codec.form if isinstance(codec, OneOf) else f"<{'|'.join(m.value for m in codec.kind)}>"
    value = default if absent is dataclasses.MISSING else absent
    needed = value is dataclasses.MISSING and not facts.get("one_of")
    keyword = Keyword(
        form, about, example, rule, codec=codec, name=name, needed=needed,
        absent=None if value is dataclasses.MISSING else value, **facts,
    )  # fmt: skip
    return dataclasses.field(default=default, compare=compare, metadata={"keyword": keyword, "after": after})


def with_words(record: type, kind: str) -> type:
    """A record with the settings that features add to it: those in the class ``kind`` of their words, each with a default."""
    found = [getattr(words, kind) for words in facets("words") if hasattr(words, kind)]
    fields = [(name, of, vars(words)[name]) for words in found for name, of in vars(words)["__annotations__"].items()]
    typed = {name for name, _, _ in fields}
    for name in (n for words in found for n, value in vars(words).items() if isinstance(value, dataclasses.Field)):
        if name not in typed:
            raise TypeError(f"the setting {name} of {kind} has no type: write {name}: TYPE = setting(...)")
    if not fields:
        return record
    return extended(record, fields)


def keywords(block: str, record: type | None) -> dict[str, Keyword]:
    """The keywords of a record's fields by name, defaults written out."""
    found = {}
    for field in _in_order(dataclasses.fields(record) if record else ()):
        if (k := field.metadata.get("keyword")) is not None:
            k = dataclasses.replace(k, block=block, field=field.name, name=k.name or field.name.replace("_", "-"))
            if not k.needed and (not k.many or k.also) and not k.one_of:
                k = dataclasses.replace(k, default=_default(k, record))
            found[k.name] = k
    return found


def _in_order(fields: Iterable[dataclasses.Field]) -> list[dataclasses.Field]:
    """The fields of a record, those of features where they are told."""
    found: list[dataclasses.Field] = []
    for field in fields:
        behind = next((n for n, f in enumerate(found, 1) if f.name == field.metadata.get("after")), len(found))
        found.insert(behind, field)
    return found


def of_features(record: Any, name: str) -> Any:
    """Settings that features add to a record, for those who check types."""


def _default(k: Keyword, record: type) -> str:
    """The text for the value of an absent keyword; empty where none is defined."""
    rest = {f.name: f.default for f in dataclasses.fields(record)}
    value = (k.absent, *(rest[name] for name in k.also)) if k.also else k.absent
    if k.many:
        if not (several := k.codec.scatter(value)):
            return ""
        value = several[0]
        return write(alternatives(k.form)[0], k.codec.write(k, value)[1], number)
    if value is None or (k.also and None in value):
        written = k.codec.write(k, None) if not k.also else None
    else:
        written = k.codec.write(k, value)
    return write(alternatives(k.form)[written[0]], written[1], number) if written else ""


_BY_DIMENSION = {unit(text).dim: limit for text, limit in LIMITS.items()}


def limit_of(keyword: Keyword, slot: Slot) -> Limit:
    """Limit of a number in this slot: that of the keyword, or else that of its unit."""
    return keyword.limit or _BY_DIMENSION.get(slot.dim, OTHER_UNIT)


def syntax(keyword: Keyword) -> str:
    """A form for people: ``box (lx, ly, lz) | sphere r``, without units."""

    def shown(match: re.Match) -> str:
        text, _, u = match[1].removeprefix("@").partition(":")
        u, _, other = u.partition(" or ")
        return text + (f"|{other}" if other == "NAME" else "")

    return re.sub(r"<([^>]*)>", shown, keyword.form)


def units_shown(keyword: Keyword) -> str:
    """The SI units of a keyword's values, e.g. ``Pa, N/m``."""
    found = re.findall(r":([^>]+)>", keyword.form)
    return ", ".join(dict.fromkeys(u for text in found for u in text.split(" or ") if u not in ("?", "1", "NAME")))
