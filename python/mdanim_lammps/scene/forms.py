# SPDX-License-Identifier: GPL-2.0-only
"""What may follow a keyword, from its form in words.py: literal words, slots for values, optional parts."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

from .units import NONE, Dim, unit


@dataclass(frozen=True, slots=True)
class Literal:
    """A word or sign that stands as it is."""

    text: str


@dataclass(frozen=True, slots=True)
class Slot:
    """A place for a value."""

    kind: str
    """number, vector, text, choice, color, place or check."""
    text: str
    """As shown to people: ``r``, ``(x, y, z)``."""
    unit: str = "1"
    """SI unit; ``?`` is that of the quantity checked."""
    length: int = 1
    """Numbers of a vector."""
    choices: tuple[str, ...] = ()
    dim: Dim = NONE
    """The dimension that the value must have."""


@dataclass(frozen=True, slots=True)
class Optional:
    """Parts that may be left out together."""

    parts: tuple


def _slot(text: str) -> Slot:
    shown, _, u = text.partition(":")
    u, _, other = u.partition(" or ")
    u = u or "1"
    dim = NONE if u == "?" else unit(u).dim
    if shown.startswith("("):
        return Slot("place" if other else "vector", shown, u, shown.count(",") + 1, dim=dim)
    if shown.startswith('"'):
        return Slot("text", shown)
    if "|" in shown:
        return Slot("choice", shown, choices=tuple(shown.split("|")))
    if shown == "color":
        return Slot("color", shown)
    if shown == "NAME.QUANTITY":
        return Slot("check", shown)
    return Slot("number", shown, u, dim=dim)


@cache
def alternatives(form: str) -> tuple[tuple, ...]:
    """A form as alternatives, each a tuple of Literal, Slot and Optional."""
    result, parts, outer = [], [], []
    for part in re.findall(r"<[^>]*>|\[|\]|[^\s\[\]<]+", form):
        if part == "|":
            result.append(tuple(parts))
            parts = []
        elif part == "[":
            outer.append(parts)
            parts = []
        elif part == "]":
            outer[-1].append(Optional(tuple(parts)))
            parts = outer.pop()
        else:
            parts.append(_slot(part[1:-1]) if part.startswith("<") else Literal(part))
    return (*result, tuple(parts))


def literals(form: str) -> frozenset[str]:
    """Every literal word of a form."""

    def words(parts):
        for p in parts:
            if isinstance(p, Literal):
                yield p.text
            elif isinstance(p, Optional):
                yield from words(p.parts)

    return frozenset(w for a in alternatives(form) for w in words(a))


def slots(form: str) -> tuple[Slot, ...]:
    """Every slot of a form."""

    def found(parts):
        for p in parts:
            if isinstance(p, Slot):
                yield p
            elif isinstance(p, Optional):
                yield from found(p.parts)

    return tuple(s for a in alternatives(form) for s in found(a))
