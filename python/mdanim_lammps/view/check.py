# SPDX-License-Identifier: GPL-2.0-only
"""Checks of texts that are edited, in a process of their own that has an end."""

from __future__ import annotations

import re
import threading
from concurrent.futures import TimeoutError as Timeout
from pathlib import Path

from ..children import ChildLost, Workers
from ..errors import Problem, SceneError

CHECKING = 10.0
"""Seconds that a check may take."""
_SURROGATE = re.compile("[\ud800-\udfff]")
"""Half of a character, as JSON can hold it; no text has one."""


class Checker:
    """Finds what is wrong with texts of scenes, one after the other.

    Args:
        name: of the scene, in messages.
        home: folder of its includes and meshes.
    """

    def __init__(self, name: str, home: Path):
        self.name, self._home = name, home
        self._workers: Workers | None = None
        self._turn = threading.Lock()
        self._closed = False

    def problems(self, text: str) -> list[dict]:
        """Problems of a text, each with its line (0 where it has none), message, way out and severity."""
        if half := _SURROGATE.search(text):
            line = text.count("\n", 0, half.start()) + 1
            return [_problem(line, "half of a character of two parts stands here, which is not text", "delete it")]
        with self._turn:
            if self._closed:
                return [_problem(0, "the server ends")]
            self._workers = self._workers or Workers(1)
            try:
                return self._workers.submit(found_problems, text, self.name, self._home).result(CHECKING)
            except Timeout:
                self._end()
                way_out = "write fewer objects and repeats, or run it in a terminal"
                return [_problem(0, f"the text takes more than {CHECKING:g} s to be read", way_out)]
            except ChildLost:
                self._end()
                return [_problem(0, "the text could not be checked: its process has ended, perhaps for lack of memory")]

    def close(self) -> None:
        """Check no more; what is being checked is broken off."""
        self._closed = True
        if workers := self._workers:
            for child in workers.children:
                child.kill()
        with self._turn:
            self._end()

    def _end(self) -> None:
        if self._workers:
            self._workers.shutdown(wait=False)
            self._workers = None


def found_problems(text: str, name: str, home: Path) -> list[dict]:
    """See `Checker.problems`."""
    from ..scene.parse import parse_scene

    try:
        found: list[Problem] = parse_scene(text, name, folder=home).warnings
    except SceneError as error:
        found = error.problems
    return [_problem(p.line if p.file == name else 0, p.message, p.hint, p.severity) for p in found]


def _problem(line: int, message: str, hint: str = "", severity: str = "error") -> dict:
    return {"line": line, "message": message, "hint": hint, "severity": severity}
