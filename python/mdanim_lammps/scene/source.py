# SPDX-License-Identifier: GPL-2.0-only
"""A scene file as text with places, and the list in which its problems are collected."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import Problem, SceneError, Span
from ..records import dataclass
from .limits import MOST_PROBLEMS
from .tokens import Token

if TYPE_CHECKING:
    from .tree import SettingNode


class Fault(Exception):
    """Something wrong at a token; the reader of the file turns it into a Problem."""

    def __init__(self, token: Token, message: str, hint: str = "", last: Token | None = None):
        super().__init__(message)
        self.token, self.message, self.hint, self.last = token, message, hint, last or token
        self.behind: SettingNode | None = None
        """The setting that is complete before the token."""


class NoValue(Fault):
    """A name for which there is no value."""


class Silent(Fault):
    """Follows from a problem that was reported already."""


@dataclass(eq=False)
class SceneFile:
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

    def span(self, first: Token, last: Token | None = None, used_at: tuple[Span, ...] = ()) -> Span:
        """The stretch from one token to another (cut at the end of the line of the first)."""
        line = self.lines[first.line - 1] if first.line <= len(self.lines) else ""
        last = last or first
        end = last.column + len(last) if last.line == first.line else len(line) + 1
        return Span(self.name, first.line, first.column, max(1, end - first.column), line, self.included_from, used_at)

    def excerpt(self, first: Token, last: Token) -> str:
        """The text from one token to another, on one line."""
        return self.text[first.start : last.end].replace("\n", " ")


class UnreadableFile(ValueError):
    """A file that holds no scene; ``span`` is the place in it, where there is one."""

    def __init__(self, message: str, span: Span | None = None):
        super().__init__(message)
        self.span = span


def read_text(path: Path, most: int, shown: str = "") -> str:
    """Read a UTF-8 text file of at most ``most`` bytes; ``shown`` is its name in messages.

    All but files on a disk are refused before they are opened: pipes, devices, what the kernel shows below /proc and /sys.
    Raises UnreadableFile, or OSError.
    """
    if os.path.isdir(path):
        raise UnreadableFile("is a folder, not a scene file")
    if not os.path.exists(path):
        raise UnreadableFile("is not there")
    if not ordinary(path):
        raise UnreadableFile("is not an ordinary file")
    with open(path, "rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size > most:
            raise UnreadableFile(f"is larger than {most >> 20} MB: this is hardly a scene")
        data = file.read(size)
    shown = shown or str(path)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise UnreadableFile("is UTF-16 text; save it as UTF-8", Span(shown, 1, 1))
    if (at := data.find(b"\0")) >= 0:
        raise UnreadableFile("is a binary file, not a text", _place(shown, data, at))
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as e:
        place = _place(shown, data, e.start)
        found = f"byte 0x{data[e.start]:02x} in line {place.line}"
        raise UnreadableFile(f"is not UTF-8 text ({found}); save it as UTF-8", place) from None


def ordinary(path: Path) -> bool:
    """Whether a path leads, through any links, to a file on a disk."""
    target = Path(os.path.realpath(path))
    return target.is_file() and not any(target.is_relative_to(folder) for folder in ("/proc", "/sys"))


def _place(shown: str, data: bytes, at: int) -> Span:
    """The place of a byte; bytes that are not text are shown as one sign each."""
    start = data.rfind(b"\n", 0, at) + 1
    line = data[start : at + 100].split(b"\n")[0].decode("utf-8", "replace")
    column = len(data[start:at].decode("utf-8", "replace")) + 1
    return Span(shown, data.count(b"\n", 0, at) + 1, column, 1, line)


class Problems:
    """Everything found so far; one problem per key, so that a repeat reports a problem once."""

    def __init__(self):
        self.found: list[Problem] = []
        self._keys = set()

    def add(self, span: Span | None, message: str, hint: str = "", severity: str = "error", key=None) -> None:
        """Note a problem unless one with this key (by default: this place and severity) is known."""
        key = (span and (span.file, span.line, span.column), severity) if key is None else key
        if key not in self._keys:
            self._keys.add(key)
            self.found.append(Problem(span, message, hint, severity))

    def fault(self, source: SceneFile, fault: Fault, where: str = "", used_at: tuple[Span, ...] = ()) -> None:
        """Note a Fault of a file."""
        if not isinstance(fault, Silent):
            self.add(source.span(fault.token, fault.last, used_at), fault.message + where, fault.hint)

    def ordered(self) -> list[Problem]:
        """All problems in the order of the text."""
        return sorted(self.found, key=lambda problem: problem.order)

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
            problems = problems[:MOST_PROBLEMS] + [Problem(None, f"{more} more problems", "fix these first")]
        raise SceneError(problems)
