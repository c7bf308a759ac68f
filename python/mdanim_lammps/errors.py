# SPDX-License-Identifier: GPL-2.0-only
"""Problems that know their place, and the few exceptions of this package, each with its exit code."""

from __future__ import annotations

import re
from enum import IntEnum

from .records import dataclass

_WINDOW = 100


class ExitCode(IntEnum):
    """Exit codes of the command line (docs/command-line.md)."""

    DONE = 0
    USAGE = 2
    SCENE = 3
    REFUSED = 4
    ENVIRONMENT = 5
    DIVERGED = 6
    IO = 7
    INTERRUPTED = 130


@dataclass(frozen=True, slots=True)
class Span:
    """A stretch of text on one line of a scene file; line and column count from 1."""

    file: str
    line: int
    column: int
    width: int = 1
    text: str = ""
    """The whole source line, for the caret picture; empty where there is no text (``--set``)."""
    included_from: tuple[Span, ...] = ()
    """The ``include`` lines that lead to this file, outermost first."""
    used_at: tuple[Span, ...] = ()
    """Where what stands here is used, outermost first: the ``place`` of its group, the ``use`` of its properties."""

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


CONTROL = r"\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff"
"""Signs that command a terminal or turn the direction of a text, and bytes that are not UTF-8, as in a class of a pattern."""
_CONTROL = re.compile(f"[{CONTROL}\t\n\r]")


def escaped(name: str) -> str:
    """A name of a file with such signs as ``_x1b``. It is what messages, pages, files and LAMMPS's input are given."""
    return _CONTROL.sub(lambda found: f"_x{ord(found[0]) & (0xFF if found[0] >= chr(0xD800) else 0xFFFF):02x}", name)


_ENDLESS = re.compile(r"\S{500,}")
"""A token that is not a word, as of a binary file."""


def _cut(word: re.Match) -> str:
    return f"{word[0][:40]}... ({len(word[0])} characters)"


@dataclass(frozen=True, slots=True)
class Problem:
    """An error or a doubt in a scene: its place, its cause, the value found, and a way out."""

    span: Span | None
    message: str
    """The cause with the value found, e.g. ``mass must be > 0, found -2 kg``."""
    hint: str = ""
    """The way out, e.g. ``did you mean 'kg'?``."""
    severity: str = "error"
    """``error``, ``warning`` or ``note``."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "message", _ENDLESS.sub(_cut, self.message))

    @property
    def file(self) -> str:
        """Name of the scene file; the empty string where the problem has no place."""
        return self.span.file if self.span else ""

    @property
    def line(self) -> int:
        """Line, counted from 1; 0 without a place."""
        return self.span.line if self.span else 0

    @property
    def column(self) -> int:
        """Column, counted from 1; 0 without a place."""
        return self.span.column if self.span else 0

    @property
    def order(self) -> tuple[tuple[int, int], ...]:
        """Key by which problems are in the order of the text: lines and columns of the includes that lead to it, then its own."""
        return tuple((s.line, s.column) for s in self.span.included_from) + ((self.line, self.column),) if self.span else ()

    def __str__(self) -> str:
        """The message, the source line, a caret below the bad word, the way out beside it, the includes."""
        place = f"{self.span}: " if self.span else ""
        head = f"{place}{self.severity}: {self.message}"
        if self.span is None or not self.span.text:
            return head + (f"\n  {self.hint}" if self.hint else "")
        text, start = _window(self.span.text, self.span.column - 1)
        gutter = f"{self.span.line:>5} | "
        # Tabs are kept so that the caret stays below its word in any terminal.
        pad = "".join(c if c == "\t" else " " for c in text[:start])
        caret = "^" + "~" * (min(max(1, self.span.width), max(1, len(text) - start)) - 1)
        picture = f"{gutter}{text}\n{' ' * (len(gutter) - 2)}| {pad}{caret}"
        hint = f"  {self.hint}" if self.hint else ""
        chain = "".join(f"\n        included from {s}" for s in reversed(self.span.included_from))
        chain += "".join(f"\n        used at {s}" for s in reversed(self.span.used_at))
        return f"{head}\n{picture}{hint}{chain}"


def problem_json(problem: Problem) -> dict:
    """A problem for programs: place (line and column from 1, 0 without a place), severity, message, hint."""
    return {
        "file": problem.file,
        "line": problem.line,
        "column": problem.column,
        "width": problem.span.width if problem.span else 0,
        "severity": problem.severity,
        "message": problem.message,
        "hint": problem.hint,
        "used_at": [str(span) for span in reversed(problem.span.used_at)] if problem.span else [],
    }


def _window(text: str, start: int) -> tuple[str, int]:
    """Cut a long line down to the part around offset ``start``; returns it with the offset moved along."""
    text = "".join(c if c.isprintable() or c == "\t" else "\N{REPLACEMENT CHARACTER}" for c in text.rstrip())
    if len(text) <= _WINDOW:
        return text, start
    first = max(0, start - _WINDOW // 2)
    left = "..." if first else ""
    right = "..." if first + _WINDOW < len(text) else ""
    return left + text[first : first + _WINDOW] + right, start - first + len(left)


_VERBATIM = re.compile(r"mdanim-lammps [^;\n']*|^ *\d+ \| .*$", re.MULTILINE)
"""Parts of a text that are not respelled: commands for a shell, and lines of a scene."""
_IN_PYTHON = tuple(
    (re.compile(option), spelling)
    for option, spelling in (
        (r" with -o\b( DIR| FILE)?", ""),
        (r"\banother -o folder", "another folder"),
        (r"\bwhat -o said", "what `run` was given"),
        (r"-o (?=\S)", ""),
        (r"-n (\d+)", r"executors=\1"),
        (r"--no-movie", "movie=False"),
        (r"--(force|springs|names)\b", r"\1=True"),
        (r"--to (\w+)", r"'\1'"),
        (r"--(every|size) (\d\w*)", r"\1=\2"),
        (r"--frames (\w+):(\w+)", r"frames=slice(\1, \2)"),
        (r"--(frames|objects|every|size|budget)\b", r"\1=..."),
        (r"--set (?=\w)", ""),
    )
)
"""Options of the command line as Python has them."""
_spelled_for_a_shell = [False]


def for_a_shell(yes: bool = True) -> bool:
    """Have messages name options as the command line does, or, as at the start, as Python does; returns how it was before."""
    before, _spelled_for_a_shell[0] = _spelled_for_a_shell[0], yes
    return before


def in_python(text: str) -> str:
    """A message with ``force=True`` in place of ``--force``, and so on; commands for a shell stay."""
    parts, at = [], 0
    for kept in (*_VERBATIM.finditer(text), None):
        part = text[at : kept.start() if kept else None]
        for option, spelling in _IN_PYTHON:
            part = option.sub(spelling, part)
        parts += [part, kept[0] if kept else ""]
        at = kept.end() if kept else at
    return "".join(parts)


class MdanimError(Exception):
    """Base of all errors that end the program with one message and an exit code."""

    exit_code = ExitCode.USAGE

    def __str__(self) -> str:
        """The message, with options as they are written where it is read: in a shell or in Python."""
        return self.told() if _spelled_for_a_shell[0] else in_python(self.told())

    def told(self) -> str:
        """The message with the options of the command line."""
        return super().__str__()


class UsageError(MdanimError):
    """An argument of the command line is not valid."""

    exit_code = ExitCode.USAGE


class SceneError(MdanimError):
    """A scene cannot be used; ``problems`` holds everything found in one pass."""

    exit_code = ExitCode.SCENE

    def __init__(self, problems: list[Problem]):
        self.problems = list(problems)
        super().__init__("\n".join(map(str, self.problems)))

    def __reduce__(self):
        # From another process: an exception is made anew from its arguments.
        return SceneError, (self.problems,)


class RefusedError(MdanimError):
    """The run is refused before step 0, e.g. for a time step above the certified bound."""

    exit_code = ExitCode.REFUSED


class SetupError(MdanimError):
    """LAMMPS, MPI or the plugin is missing, of another version, or cannot be loaded."""

    exit_code = ExitCode.ENVIRONMENT


class ExecutorLost(MdanimError):
    """A rank of a distributed run has died: killed, out of memory, a host gone, or an unforeseen error."""

    exit_code = ExitCode.ENVIRONMENT


class DivergedError(MdanimError):
    """The run diverged, the ledger broke or an ``expect`` was missed; the last good state is kept."""

    exit_code = ExitCode.DIVERGED

    def __init__(self, why: str, kept: str = ""):
        super().__init__(why, kept)
        self.why, self.kept = why, kept

    def told(self) -> str:
        """When and why, and in a line of its own what is kept and how to go on."""
        return f"{self.why}\n  {self.kept}" if self.kept else self.why


_NO_ROOM = re.compile("failed to (?:re)?allocate|cannot allocate memory|bad_alloc|failed to map segment", re.IGNORECASE)
"""Words of LAMMPS, the kernel, C++ and the loader of libraries where memory has run out."""


def out_of_memory(error: BaseException) -> bool:
    """Whether an error says that memory has run out, whichever library has met it."""
    return isinstance(error, MemoryError) or _NO_ROOM.search(str(error)) is not None


_NO_FILES = re.compile("too many open files(?! in system)", re.IGNORECASE)
"""Words of the kernel for EMFILE; libraries in C and C++ pass them on."""


def out_of_files(error: BaseException) -> bool:
    """Whether an error says that this process may open no more files, whichever library has met it."""
    return _NO_FILES.search(str(error)) is not None


class OutputError(MdanimError):
    """Disk full, output folder in the way, file not readable."""

    exit_code = ExitCode.IO
