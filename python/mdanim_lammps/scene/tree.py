# SPDX-License-Identifier: GPL-2.0-only
"""The statements of a scene as they stand in the text: values are compiled, but nothing is evaluated yet."""

from __future__ import annotations

from ..records import dataclass
from .expressions import Node
from .forms import Slot
from .schema import Keyword
from .source import SceneFile
from .tokens import Token


@dataclass(slots=True, eq=False)
class Name:
    """``ball``, ``ball[index]``, ``ball[index][index]``, or with the group that it is in, ``cart[index].ball``."""

    token: Token
    last: Token
    indices: tuple[Node, ...] = ()
    inner: Name | None = None
    """The part behind a point."""


@dataclass(slots=True, eq=False)
class Value:
    """The value in one slot of a setting."""

    slot: Slot
    first: Token
    last: Token
    node: Node | None = None
    """Numbers and vectors."""
    text: str = ""
    """Texts, choices, colours, and the quantity of an expect."""
    name: Name | None = None
    """Object names."""
    argument: Value | None = None
    """Argument of the quantity of an expect."""


@dataclass(slots=True, eq=False)
class Let:
    """``let name = value``, or ``let name = { settings of an object }``."""

    source: SceneFile
    token: Token
    node: Node | None
    body: list | None = None
    """Statements in braces; None for a value."""


@dataclass(slots=True, eq=False)
class Repeat:
    source: SceneFile
    token: Token
    variable: Token
    low: Node
    high: Node
    body: list


@dataclass(slots=True, eq=False)
class SettingNode:
    """One setting."""

    source: SceneFile
    token: Token
    keyword: Keyword
    choice: int
    """Which alternative of the form was found."""
    words: tuple[str, ...]
    """The words of the form that were found, e.g. ``("axis", "angle")``."""
    values: tuple[Value | None, ...]
    """In the order of the form; None for what was left out."""
    known: tuple | None = None
    """The values, once they are evaluated, if they are the same in every repeat."""

    @property
    def constant(self) -> bool:
        """Whether no variable is looked at."""
        return all(v is None or ((v.node is None or v.node.constant) and v.name is None) for v in self.values)


@dataclass(slots=True, eq=False)
class Group:
    """One block."""

    source: SceneFile
    token: Token
    block: str
    names: tuple[Name, ...]
    body: list
    of: Token | None = None
    """The group that a ``place`` puts somewhere."""
    raw: tuple[Token, ...] = ()
    """Lines of a block that holds the text of another language."""
    kind: str = ""
    """The word before its names, of a block that has such words."""


@dataclass(slots=True, eq=False)
class Template:
    """``group NAME { ... }``: objects that are placed together."""

    source: SceneFile
    name: Token
    body: list


@dataclass(slots=True, eq=False)
class Set:
    """``set name = value``, in a place."""

    source: SceneFile
    token: Token
    node: Node


@dataclass(slots=True, eq=False)
class Use:
    """``use name``: the settings of a let stand here, too."""

    source: SceneFile
    token: Token


@dataclass(slots=True, eq=False)
class UnreadableStatement:
    """A statement that could not be read; keeps checks from complaining that something is missing."""

    word: str
    name: str = ""
    """The name that an unreadable let would have defined."""
