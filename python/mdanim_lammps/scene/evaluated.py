# SPDX-License-Identifier: GPL-2.0-only
"""Blocks and settings of a scene with their values in SI units, and the places that they come from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from typing import Any

from ..errors import Span
from ..records import dataclass
from .keywords import KEYWORDS
from .schema import Keyword
from .tokens import Token
from .tree import Group, SettingNode, Use


@dataclass(slots=True, eq=False)
class EvaluatedSetting:
    """A setting with its values."""

    entry: SettingNode
    values: tuple
    used_at: tuple[Span, ...] = ()
    """Where the groups are placed that it stands in."""

    def span(self, n: int | None = None) -> Span:
        """Place of the n-th value, or of the keyword and all values."""
        v = self.entry.values[n] if n is not None else None
        if v is None:
            ends = [v.last for v in self.entry.values if v is not None]
            return self.between(self.entry.token, ends[-1] if ends else None)
        return self.between(v.first, v.last)

    def between(self, first: Token, last: Token | None = None) -> Span:
        """The stretch from one token of it to another."""
        return self.entry.source.span(first, last, self.used_at)

    def record(self) -> Any:
        """The value of the record's field. Raises ValueError as Codec.read."""
        keyword = self.entry.keyword
        return keyword.codec.read(keyword, self.entry.choice, self.values)

    @property
    def kind(self) -> type:
        """The class of the record that it becomes, of a keyword with forms of several classes."""
        return self.entry.keyword.codec.kind(self.entry.choice, self.values)

    def following(self, keyword: Keyword, value: Any) -> EvaluatedSetting:
        """A setting that follows from this one, at its place, with this value of the record's field."""
        choice, values = keyword.codec.write(keyword, value)
        places = (next(iter(self.entry.values), None),) * max(1, len(values))
        node = SettingNode(self.entry.source, self.entry.token, keyword, choice, (), places)
        return EvaluatedSetting(node, tuple(values), self.used_at)


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
    """``(with i = 1, j = 2)``, in a repeat."""
    used_at: tuple[Span, ...] = ()
    """Where the groups are placed that it stands in."""
    uses: list[Use] = field(default_factory=list)
    """Settings that it takes from lets."""
    inside: EvaluatedBlock | None = None
    """The ``place`` block of the group that it stands in."""

    @property
    def name(self) -> str:
        """``ball[3]``, or the names of both objects."""
        return " ".join(self.names)

    @property
    def head(self) -> Span:
        """Place of its names, or of its word."""
        g = self.group
        if g.of is not None:
            return g.source.span(g.of, g.names[-1].last, self.used_at)
        return g.source.span(g.names[0].token if g.names else g.token, g.names[-1].last if g.names else None, self.used_at)

    def excused(self, *words: str) -> bool:
        """Whether these words may be missing because something could not be read."""
        return not self.broken.isdisjoint((*words, "include", "repeat", "use"))

    def words(self) -> set[str]:
        """Words that it says itself, and those that these exclude."""
        own = KEYWORDS[self.block] if self.block in KEYWORDS else KEYWORDS["object"]
        return {other for word in self.settings for other in (word, *own[word].one_of)}

    def first(self, word: str) -> EvaluatedSetting | None:
        """The setting of a keyword, if there is one."""
        found = self.settings.get(word)
        return found[0] if found else None

    def value(self, word: str, default=None):
        """The first value of a keyword's setting; the default where it is absent or ``auto``."""
        found = self.settings.get(word)
        return found[0].values[0] if found and found[0].values else default


def around(block: EvaluatedBlock | None) -> Iterator[EvaluatedBlock]:
    """The place of a group, and those of the groups around it, from the inside out."""
    while block is not None:
        yield block
        block = block.inside
