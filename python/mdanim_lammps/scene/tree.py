# SPDX-License-Identifier: GPL-2.0-only
"""The statements of a scene as they stand in the text: values are compiled, but nothing is worked out yet."""

from __future__ import annotations

from dataclasses import dataclass

from lark import Token

from .expressions import Node
from .forms import Slot
from .keywords import Keyword
from .source import Source


@dataclass(slots=True, eq=False)
class Name:
    """``ball`` or ``ball[index]``."""

    token: Token
    last: Token
    index: Node | None = None


@dataclass(slots=True, eq=False)
class Value:
    """What stands in one slot of a setting."""

    slot: Slot
    first: Token
    last: Token
    node: Node | None = None
    """Numbers and vectors."""
    text: str = ""
    """Texts, choices, colours, and the quantity of an expect."""
    name: Name | None = None
    """Object names."""


@dataclass(slots=True, eq=False)
class Let:
    source: Source
    token: Token
    node: Node


@dataclass(slots=True, eq=False)
class Repeat:
    source: Source
    token: Token
    variable: Token
    low: Node
    high: Node
    body: list


@dataclass(slots=True, eq=False)
class Entry:
    """One setting."""

    source: Source
    token: Token
    keyword: Keyword
    words: tuple[str, ...]
    """The literal words found, e.g. ``("axis", "angle")``."""
    values: tuple[Value | None, ...]
    """In the order of the form; None for what was left out."""
    known: tuple | None = None
    """The values, once worked out, if they are the same in every repeat."""

    @property
    def constant(self) -> bool:
        """Whether no variable is looked at."""
        return all(v is None or ((v.node is None or v.node.constant) and v.name is None) for v in self.values)


@dataclass(slots=True, eq=False)
class Group:
    """One block."""

    source: Source
    token: Token
    block: str
    name: Name | None
    body: list


@dataclass(slots=True, eq=False)
class Broken:
    """A statement that could not be read; keeps checks from complaining that something is missing."""

    word: str
    name: str = ""
    """What a broken let would have named."""
