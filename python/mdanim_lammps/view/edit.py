# SPDX-License-Identifier: GPL-2.0-only
"""Editing a scene in the page and running it again, with ``--edit`` only.

The run is a process of its own, `main` with the arguments FOLDER NAME OUT. Its standard input has the length of the text in
bytes, a line of its own, then the text, and stays open: the run ends when the server does, however that ends. It writes into a
folder beside the one that is viewed, which keeps its results.
"""

from __future__ import annotations

import hashlib
import os
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from ..children import DEVNULL, PIPE, Child, TimeoutExpired, command, start
from ..errors import OutputError, UsageError
from ..results.stored import read_manifest
from ..scene.source import UnreadableFile, ordinary, read_text
from .check import Checker
from .tail import Tail

LONGEST_TEXT = 1 << 20
"""Bytes of a text at most."""
ENDING = 10.0
"""Seconds that a run has to end when another one takes its place."""


class Editor:
    """The text that is edited, and the run that was started last.

    Args:
        folder: output folder that is viewed.
        scene: file of the scene, whose folder holds its includes and meshes; None takes that from which the run was made, or
            scene.lock.txt of the folder where it is another one now.

    Raises UsageError for a text that is too long, or cannot be read.
    """

    def __init__(self, folder: Path, scene: Path | None = None):
        folder = folder.resolve()
        scene = scene or scene_of(folder)
        source = scene or folder / "scene.lock.txt"
        try:
            self.text = read_text(source.absolute(), LONGEST_TEXT - 1, str(source))
        except (UnreadableFile, OSError) as error:
            raise UsageError(f"--edit: {source} {error}; a page edits texts of less than {LONGEST_TEXT >> 20} MB") from error
        self.name, self._home = (scene or folder).stem, source.absolute().parent
        self.out = folder.with_name(f"{folder.stem}.edited.out")
        self._checker = Checker(self.name, self._home)
        self.problems = self._checker.problems
        self._process: Child | None = None
        self._turn = threading.Lock()
        self._asked, self._closed = 0, False

    def run(self, text: str, tail: Tail) -> None:
        """Run a text, which the tail follows from now on; a run that was started before ends. What the program says if it fails
        is said by the tail. Of several texts that wait for that, the last one is run."""
        self._asked += 1
        mine = self._asked
        with self._turn:
            if self._closed or mine != self._asked:
                return
            self._end_run()
            if self._closed:
                return
            tail.turn_to(self.out)  # between two runs: what lies there now is of the earlier one
            self.text = text
            edited = command(__name__, self._home, self.name, self.out)
            self._process = start(edited, text=False, stdin=PIPE, stdout=DEVNULL, stderr=PIPE, start_new_session=True)
            threading.Thread(target=self._wait, args=(self._process, text, tail.say), daemon=True).start()

    def end(self) -> None:
        """Check and run no more; the run that was started last ends after its frame, with a checkpoint."""
        self._closed = True
        self._checker.close()
        with self._turn:
            self._end_run()

    def _end_run(self) -> None:
        if self._process and self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(ENDING)
            except TimeoutExpired:
                self._process.kill()
                self._process.wait()

    @staticmethod
    def _wait(process: Child, text: str, told: Callable[[str], None]) -> None:
        data = text.encode()
        with process:
            with suppress(BrokenPipeError):
                process.stdin.write(b"%d\n" % len(data) + data)
                process.stdin.flush()
            said = process.stderr.read().decode(errors="replace")
            process.wait()
        if process.returncode not in (0, -15, 130):
            told(said.strip() or f"the run ended with code {process.returncode}")


def scene_of(folder: Path) -> Path | None:
    """The file of the scene from which the run of a folder was made; None where it is not there, or another one now."""
    try:
        made = read_manifest(folder)
        path, digest = Path(made.get("scene") or ""), (made.get("sha256") or {}).get("scene")
        if ordinary(path) and path.stat().st_size < LONGEST_TEXT and hashlib.sha256(path.read_bytes()).hexdigest() == digest:
            return path
    except (OutputError, OSError, ValueError):
        pass
    return None


def main() -> None:
    """Run the scene on standard input into a folder, which is emptied if it is one of ours."""
    from ..parallel.frames import run_frames
    from ..results.files import write_whole
    from ..run.folder import open_run
    from ..run.prepare import prepare
    from ..scene.parse import parse_scene
    from ..terminal import documented_exit, open_streams, stop_on_sigterm

    open_streams()
    stop_on_sigterm()
    home, name, out = sys.argv[1:]
    with documented_exit(debug=False):
        with open(os.dup(0), "rb") as given:
            text = given.read(int(given.readline())).decode()
        threading.Thread(target=_end_with_parent, daemon=True).start()
        ready = prepare(parse_scene(text, name, folder=home))
        with open_run(ready, Path(out), force=True) as folder:
            write_whole(folder / "edited.txt", text)
            run_frames(ready, folder)


def _end_with_parent() -> None:
    """Stop as SIGTERM does when nobody holds the other end of standard input any more, and for certain a little later."""
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)
    threading.Event().wait(ENDING)
    os._exit(1)
