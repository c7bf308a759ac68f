# SPDX-License-Identifier: GPL-2.0-only
"""The tokens of a scene: words, numbers, texts, signs, ends of lines."""

from __future__ import annotations

import re
from collections.abc import Iterator

_PATTERNS = {
    "NUMBER": r"([0-9]+(\.(?!\.)[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?",
    "NAME": r"[^\W\d]\w*",
    "STRING": r'"[^"\n]*"',
    "BAD_STRING": r'"[^"\n]*',
    "NEWLINE": r"\n",
    "BLANK": r"[ \t\f\r\u00a0\u202f]+|\#[^\n]*",
    "PLUS_MINUS": r"\+-|±",
    "DOTS": r"\.\.",
    "RELATION": r"[<>]=?|[≤≥]",
    "BAD": r".",
}
_SIGNS = {
    "{": "LBRACE", "}": "RBRACE", "(": "LPAR", ")": "RPAR", "[": "LSQB", "]": "RSQB", ",": "COMMA", "+": "PLUS", "-": "MINUS",
    "*": "STAR", "/": "SLASH", "^": "CARET", "=": "EQUAL", ".": "DOT",
}  # fmt: skip
_TOKEN = re.compile("|".join(f"(?P<{name}>{pattern})" for name, pattern in _PATTERNS.items()))


class Token(str):
    """A stretch of text on one line; it compares as its text. Line and column count from 1."""

    __slots__ = ("column", "line", "start", "type")

    type: str
    start: int
    """Index of its first character in the text of the file."""
    line: int
    column: int

    def __new__(cls, type: str, text: str, start: int, line: int, column: int):
        """A token of this type and text at a place."""
        token = super().__new__(cls, text)
        token.type, token.start, token.line, token.column = type, start, line, column
        return token

    @property
    def end(self) -> int:
        """Index behind its last character."""
        return self.start + len(self)

    def found(self) -> str:
        """The token for messages."""
        return {"NEWLINE": "the end of the line", "END": "the end of the file"}.get(self.type, f"'{self}'")


def tokens(text: str, start: int = 0, line: int = 1) -> Iterator[Token]:
    """The tokens of a text from a place on that is in this line, at the end an END without end."""
    begin = text.rfind("\n", 0, start) + 1
    for match in _TOKEN.finditer(text, start):
        kind, word, start = match.lastgroup, match.group(), match.start()
        if kind == "BLANK":
            continue
        if kind == "BAD":
            kind = _SIGNS.get(word, kind)
        elif kind == "NAME" and word == "mod":
            kind = "MOD"
        yield Token(kind, word, start, line, start - begin + 1)
        if kind == "NEWLINE":
            line, begin = line + 1, match.end()
    while True:
        yield Token("END", "", len(text), line, len(text) - begin + 1)
