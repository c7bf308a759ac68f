# SPDX-License-Identifier: GPL-2.0-only
"""The text after a keyword, from its form: words that stand as they are, slots for values, optional parts."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from ..records import dataclass
from .units import NONE, Dim, dimension, magnitude, symbol, unit


@dataclass(frozen=True, slots=True)
class Word:
    """A word or sign that stands as it is."""

    text: str


@dataclass(frozen=True, slots=True)
class Slot:
    """A place for a value."""

    kind: str
    """number, vector, text, choice, name, object, color, place, check or relation."""
    text: str
    """As shown to people: ``r``, ``(x, y, z)``."""
    unit: str = "1"
    """SI unit; ``?`` is that of the quantity checked."""
    length: int = 1
    """Numbers of a vector."""
    choices: tuple[str, ...] = ()
    dim: Dim = NONE
    """The dimension that the value must have."""
    anywhere: bool = False
    """Whether the rule of the setting does not hold for it: a place."""
    other: str = ""
    """A second SI unit that a number may have; such a number keeps its unit."""
    or_text: bool = False
    """Whether a text in quotes may stand for the number."""


@dataclass(frozen=True, slots=True)
class OptionalPart:
    """Parts that may be left out together."""

    parts: tuple


KINDS = {"color": "color", "MATERIAL": "name", "NAME": "object", "NAME.QUANTITY": "check", "RELATION": "relation"}
"""Kinds of slots that have a reader of their own, by what they show."""


def _slot(text: str) -> Slot:
    anywhere = text.startswith("@")
    shown, _, u = text.removeprefix("@").partition(":")
    u, _, other = u.partition(" or ")
    u = u or "1"
    dim = NONE if u == "?" else unit(u).dim
    if shown.startswith("("):
        return Slot("place" if other else "vector", shown, u, shown.count(",") + 1, dim=dim, anywhere=anywhere)
    if shown.startswith('"'):
        return Slot("number", shown, or_text=True) if "|" in shown else Slot("text", shown)
    if "|" in shown:
        return Slot("choice", shown, choices=tuple(shown.split("|")))
    if shown in KINDS:
        return Slot(KINDS[shown], shown)
    return Slot("number", shown, u, dim=dim, anywhere=anywhere, other=other)


@cache
def alternatives(form: str) -> tuple[tuple, ...]:
    """A form as alternatives, each a tuple of Word, Slot and OptionalPart."""
    result, parts, outer = [], [], []
    for part in re.findall(r"<[^>]*>|\[|\]|[^\s\[\]<]+", form):
        if part == "|":
            result.append(tuple(parts))
            parts = []
        elif part == "[":
            outer.append(parts)
            parts = []
        elif part == "]":
            outer[-1].append(OptionalPart(tuple(parts)))
            parts = outer.pop()
        else:
            parts.append(_slot(part[1:-1]) if part.startswith("<") else Word(part))
    return (*result, tuple(parts))


def pieces(parts: tuple) -> Iterator[Word | Slot]:
    """Words and slots of an alternative, optional ones among them."""
    for p in parts:
        if isinstance(p, OptionalPart):
            yield from pieces(p.parts)
        else:
            yield p


def slots(form: str) -> tuple[Slot, ...]:
    """Every slot of a form."""
    return tuple(p for a in alternatives(form) for p in pieces(a) if isinstance(p, Slot))


@cache
def literals(form: str) -> frozenset[str]:
    """Every word of a form that stands as it is."""
    return frozenset(p.text for a in alternatives(form) for p in pieces(a) if isinstance(p, Word))


def write(parts: tuple, values: tuple, number: Callable[[float], str] = repr) -> str:
    """The text of one alternative with these values, in SI units; optional parts without values are left out."""
    rest = iter(values)

    def text(p) -> str | None:
        if isinstance(p, Word):
            return p.text
        if isinstance(p, OptionalPart):
            taken = [text(q) for q in p.parts] if any(isinstance(q, Slot) for q in pieces(p.parts)) else []
            absent = any(t is None and not isinstance(q, OptionalPart) for q, t in zip(p.parts, taken))
            return None if absent else " ".join(filter(None, taken))
        return _value(p, next(rest), number)

    return " ".join(filter(None, map(text, parts)))


def _value(slot: Slot, x: Any, number: Callable[[float], str]) -> str | None:
    """One value as the language has it. Raises ValueError for a text that it cannot hold."""
    if x is None:
        return None
    if slot.kind in ("text", "color") or (slot.or_text and isinstance(x, str)):
        text = str(x)
        if any(c in text for c in '"\n\r'):
            raise ValueError(f"a text of the scene language holds no quote and no line break: {text!r}")
        return f'"{text}"'
    if isinstance(x, str):
        return x
    if slot.other:
        return f"{number(magnitude(x))} {symbol(dimension(x))}".rstrip()
    unit = "" if slot.unit in ("1", "?") else f" {slot.unit}"
    return (f"({', '.join(map(number, x))})" if isinstance(x, tuple) else number(x)) + unit
