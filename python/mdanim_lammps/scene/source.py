# SPDX-License-Identifier: GPL-2.0-only
"""A scene file as text with places, and the list in which its problems are collected."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..errors import Problem, SceneError, Span

LARGEST_FILE = 64 * 2**20

MOST_PROBLEMS = 50
"""More than these help nobody; the rest is counted."""


class Fault(Exception):
    """Something wrong at a token; whoever knows the file turns it into a Problem."""

    def __init__(self, token, message: str, hint: str = "", last=None):
        super().__init__(message)
        self.token, self.message, self.hint, self.last = token, message, hint, last or token


class Silent(Fault):
    """Follows from something that was told already."""


@dataclass(eq=False)
class Source:
    """One file of a scene."""

    name: str
    """As shown in messages."""
    text: str
    path: Path | None = None
    """Absolute; None for text that came from no file."""
    included_from: tuple[Span, ...] = ()
    folder: Path | None = None
    """Where relative file names start; by default where the file is."""

    def __post_init__(self):
        self.text = self.text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
        self.lines = self.text.split("\n")
        if self.folder is None:
            self.folder = self.path.parent if self.path else Path.cwd()

    def span(self, first, last=None) -> Span:
        """The stretch from one token to another (cut at the end of the line of the first)."""
        line = self.lines[first.line - 1] if first.line <= len(self.lines) else ""
        last = last or first
        end = last.end_column if last.end_line == first.line else len(line) + 1
        return Span(self.name, first.line, first.column, max(1, end - first.column), line, self.included_from)

    def excerpt(self, first, last) -> str:
        """The text from one token to another, on one line."""
        return self.text[first.start_pos : last.end_pos].replace("\n", " ")


def read_text(path: Path) -> str:
    """Read a UTF-8 text file; raises ValueError with a message for people, or OSError."""
    if path.is_dir():
        raise ValueError("is a folder, not a scene file")
    if not path.is_file():
        raise ValueError("is not there" if not path.exists() else "is not an ordinary file")
    if path.stat().st_size > LARGEST_FILE:
        raise ValueError(f"is larger than {LARGEST_FILE >> 20} MB: this is hardly a scene")
    data = path.read_bytes()
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise ValueError("is UTF-16 text; save it as UTF-8")
    if b"\0" in data:
        raise ValueError("is a binary file, not a text")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as e:
        line = data.count(b"\n", 0, e.start) + 1
        raise ValueError(f"is not UTF-8 text (byte 0x{data[e.start]:02x} in line {line}); save it as UTF-8") from None


class Problems:
    """Everything found so far; one problem per key, so that a repeat tells its trouble once."""

    def __init__(self):
        self.found: list[Problem] = []
        self._keys = set()
        self._files: list[str] = []

    def begin(self, source: Source) -> None:
        """Tell the main file: its problems come first."""
        self._files.append(source.name)

    def add(self, span: Span | None, message: str, hint: str = "", severity: str = "error", key=None) -> None:
        """Note a problem unless one with this key (by default: this place and severity) is known."""
        key = (span and (span.file, span.line, span.column), severity) if key is None else key
        if key not in self._keys:
            self._keys.add(key)
            self.found.append(Problem(span, message, hint, severity))
            if span and span.file not in self._files:
                self._files.append(span.file)

    def fault(self, source: Source, fault: Fault, where: str = "", key=None) -> None:
        """Note a Fault of a file."""
        if not isinstance(fault, Silent):
            self.add(source.span(fault.token, fault.last), fault.message + where, fault.hint, key=key)

    def ordered(self) -> list[Problem]:
        """All problems in the order of the text."""
        order = {name: n for n, name in enumerate(self._files)}
        return sorted(self.found, key=lambda p: (order.get(p.file, -1), p.line, p.column))

    @property
    def errors(self) -> int:
        """How many are errors."""
        return sum(p.severity == "error" for p in self.found)

    def stop(self) -> None:
        """Raise SceneError if there are errors."""
        if not self.errors:
            return
        problems = self.ordered()
        if len(problems) > MOST_PROBLEMS:
            more = len(problems) - MOST_PROBLEMS
            problems = problems[:MOST_PROBLEMS] + [Problem(None, f"{more} more problems", "mend these first")]
        raise SceneError(problems)
