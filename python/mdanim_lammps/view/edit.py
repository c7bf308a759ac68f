# SPDX-License-Identifier: GPL-2.0-only
"""Editing a scene in the page and running it again, with ``--edit`` only.

The run is a process of its own, `main` with the arguments FOLDER NAME OUT and the text on its standard input. It writes into a
folder beside the one that is viewed, which keeps its results.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from pathlib import Path

from ..children import DEVNULL, PIPE, Child, TimeoutExpired, command, start
from ..errors import SceneError
from ..scene.limits import MOST_BYTES_OF_LOCK
from ..scene.parse import parse_scene
from ..scene.source import read_text
from .tail import Tail

LONGEST_TEXT = 1 << 20
"""Bytes of a message with a scene at most."""
ENDING = 10.0
"""Seconds that a run has to end when another one takes its place."""


class Editor:
    """The text that is edited, and the run that was started last.

    Args:
        folder: output folder that is viewed.
        scene: file of the scene, whose folder holds its includes and meshes; None takes scene.lock.txt of the folder.
    """

    def __init__(self, folder: Path, scene: Path | None = None):
        source = scene or folder / "scene.lock.txt"
        self.text = read_text(source.absolute(), MOST_BYTES_OF_LOCK, str(source))
        self.name, self._home = (scene or folder).stem, source.absolute().parent
        self.out = folder.absolute().with_name(f"{folder.stem}.edited.out")
        self._process: Child | None = None
        self._turn = threading.Lock()

    def problems(self, text: str) -> list[dict]:
        """What is wrong with a text, each with its line (0 where it has none), message, way out and severity."""
        try:
            found = parse_scene(text, self.name, folder=self._home).warnings
        except SceneError as error:
            found = error.problems
        return [
            {"line": p.line if p.file == self.name else 0, "message": p.message, "hint": p.hint, "severity": p.severity}
            for p in found
        ]

    def run(self, text: str, tail: Tail) -> None:
        """Run a text, which the tail follows from now on; a run that was started before ends. What the program says if it fails
        is said by the tail."""
        with self._turn:
            self.end()
            tail.turn_to(self.out)  # between two runs: what lies there now is of the earlier one
            self.text = text
            edited = command(__name__, self._home, self.name, self.out)
            self._process = start(edited, stdin=PIPE, stdout=DEVNULL, stderr=PIPE, start_new_session=True)
            threading.Thread(target=self._wait, args=(self._process, text, tail.say), daemon=True).start()

    def end(self) -> None:
        """End the run that was started last: after its frame, with a checkpoint."""
        if self._process and self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(ENDING)
            except TimeoutExpired:
                self._process.kill()
                self._process.wait()

    @staticmethod
    def _wait(process: Child, text: str, told: Callable[[str], None]) -> None:
        said = process.communicate(text)[1]
        if process.returncode not in (0, -15, 130):
            told(said.strip() or f"the run ended with code {process.returncode}")


def main() -> None:
    """Run the scene on standard input into a folder, which is emptied if it is one of ours."""
    from ..api import open_run, run_frames
    from ..results.files import write_whole
    from ..run.prepare import prepare
    from ..terminal import documented_exit, open_streams, stop_on_sigterm

    open_streams()
    stop_on_sigterm()
    home, name, out = sys.argv[1:]
    with documented_exit(debug=False):
        text = sys.stdin.read()
        ready = prepare(parse_scene(text, name, folder=home))
        with open_run(ready, Path(out), force=True) as folder:
            write_whole(folder / "edited.txt", text)
            run_frames(ready, folder)
