# SPDX-License-Identifier: GPL-2.0-only
"""Hands of a page on a run that goes on: asked for by a file, kept as lines of a scene (docs/view.md, "Hands").

Once before each frame the file ``hand.json`` is read, which the server of a view writes. What follows of it, the place of the
hand at the end of the frame, is given to LAMMPS and added to ``hands.txt``, in the words of a scene. So a scene with these lines
has the same bits.
"""

from __future__ import annotations

import os
import stat
import time
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Protocol

import numpy as np

from ..effects.steered import Steering
from ..errors import OutputError, SceneError, UsageError
from ..results.files import HAND, HANDS, PAUSE, disk_errors, sync, write_whole
from ..results.forms import Misfit, many, number, record, strict_json, text
from ..results.untrusted import check_plain
from ..scene.limits import MOST_BYTES as MOST_BYTES_OF_LINES
from ..scene.parse import parse_scene
from .prepare import Prepared

MOST_BYTES = 4096
"""Bytes of ``hand.json`` at most."""
SILENT = 2.0
"""Seconds after which a hand lets go of which nothing is heard."""
FARTHEST = 1e9
"""From the origin [m]."""
FORM = record({"object": text, "at": many(number), "to": many(number)})
HEAD = '# What hands did in this run, by mdanim-lammps; the scene with the line  include "{}"  gives the same run.\nhands on\n'
SUM, BYTES = "hand_lines", "hand_bytes"
"""Names of what a checkpoint has of the lines so far."""


class TakesCommands(Protocol):
    """A frame source that takes commands between two frames."""

    def steer(self, command: str) -> None:
        """Give LAMMPS a command."""

    def places(self, rows: np.ndarray) -> np.ndarray:
        """Places of particles of the system [m], shape (P, 3)."""


class PageHands:
    """Hands in a run, and those from before it was resumed.

    Args:
        ready: the scene.
        folder: of the run.
        source: of its frames.
        live: whether a page may pull; else only what was kept is done again.

    Raises UsageError for a page at a scene that is not made for it.
    """

    def __init__(self, ready: Prepared, folder: Path, source: TakesCommands, live: bool):
        if live and not any(effect.steers(ready.scene) for effect in ready.plan.effects):
            raise UsageError(
                "--hands: this run was begun without it, or nothing in it can move; run the scene again with --hands"
            )
        self.ready, self.folder, self.source, self.live = ready, folder, source, live
        self._asked: tuple = ()
        """Object and point that are held."""
        self._held: Steering | None = None
        self._place = np.zeros(3)
        self._again = 0.0
        """Up to this time hands of before the resume act [s]."""
        self._next = 0.0
        self._lines = b""
        """Bytes of ``hands.txt``, without the end of the last hand."""
        self._end = b""
        """The end of the last hand."""

    def begin(self, resumed: int | None, carried: dict[str, float]) -> None:
        """Begin the file of a new run, or go on behind a step with what its checkpoint has `kept`: what hands did later is done
        again. A page has the run begin. Raises OutputError where the file is not the one of the checkpoint, or is damaged."""
        path = self.folder / HANDS
        with disk_errors(path):
            (self.folder / HAND).unlink(missing_ok=True)
        if resumed is None:
            self._lines = HEAD.format(HANDS).encode()
            write_whole(path, self._lines.decode())
        else:
            self._do_again(path, resumed * self.ready.certificate.timestep, carried)
        if self.live:
            with disk_errors(self.folder / PAUSE):
                (self.folder / PAUSE).touch()

    def _do_again(self, path: Path, after: float, carried: dict[str, float]) -> None:
        check_plain(path)
        with disk_errors(path), open(path, "rb") as file:
            self._lines = file.read(MOST_BYTES_OF_LINES + 1)
        if len(self._lines) > MOST_BYTES_OF_LINES:
            most = f"more than {MOST_BYTES_OF_LINES >> 20} MiB, which no scene may have"
            raise OutputError(f"{path} is damaged: it has {most}; run the scene again with --force")
        size, known = int(carried.pop(BYTES, -1.0)), carried.pop(SUM, -1.0)
        if zlib.crc32(self._lines[: max(size, 0)]) != known:
            raise OutputError(f"{path} is damaged: it is not the one of the checkpoint; run the scene again with --force")
        try:
            lines = self._lines.decode().removeprefix(HEAD.format(HANDS))
            scene = parse_scene(f"{self.ready.lock}\n{lines}", self.ready.scene.name, folder=self.folder)
        except (UnicodeDecodeError, SceneError) as wrong:
            known = self._lines[:size].count(b"\n")
            way_out = "close the last hand with a line } and resume again"
            raise OutputError(f"{path} is damaged: keep its first {known} lines, those of the checkpoint, {way_out}") from wrong
        for effect in self.ready.plan.effects:
            for end, command in effect.steered(self.ready.context, scene, after):
                self._again = max(self._again, end)
                self.source.steer(command)

    def kept(self) -> dict[str, float]:
        """For a checkpoint, which is of use only with the lines so far: they are on the disk. Raises OutputError."""
        with disk_errors(self.folder / HANDS):
            sync(self.folder / HANDS)
        return {SUM: float(zlib.crc32(self._lines)), BYTES: float(len(self._lines))}

    def frame(self, first: int, last: int) -> None:
        """Do what is asked for from one step to another, no sooner than the film gets there. Raises OutputError."""
        dt = self.ready.certificate.timestep
        begin, end = first * dt, last * dt
        if not self.live:
            return
        self._wait(end - begin)
        if begin < self._again - 0.5 * dt:
            return
        asked = read_request(self.folder / HAND)
        if asked is None:
            self._asked, self._held = (), None
            return
        name, at, to = asked
        if self._asked != (name, at):
            self._take(name, at, begin)
        if (held := self._held) is None:
            return
        way = np.array(to) - self._place
        most, far = held.speed * (end - begin), float(np.linalg.norm(way))
        self._place = self._place + (way if far <= most else most / far * way)
        place = self._place.tolist()
        self.source.steer(held.key(end, place))
        self._write(held.line(end, place), held.tail)

    def _take(self, name: str, at: tuple[float, ...], when: float) -> None:
        self._asked = (name, at)
        found = (effect.steering(self.ready.context, name, at) for effect in self.ready.plan.effects)
        self._held = held = next((one for one in found if one is not None), None)
        if held is None:
            return
        self._place = held.weights @ self.source.places(held.rows)
        place = self._place.tolist()
        self.source.steer(held.begin)
        self.source.steer(held.key(when, place))
        self._lines += self._end
        self._write(held.head + held.line(when, place), held.tail)

    def _write(self, lines: str, tail: str) -> None:
        """Add lines to the file; it always ends with the end of a hand."""
        path, at = self.folder / HANDS, len(self._lines)
        self._lines, self._end = self._lines + lines.encode(), tail.encode()
        with disk_errors(path), open(os.open(path, os.O_WRONLY | os.O_NOFOLLOW | os.O_CLOEXEC), "wb") as file:
            file.seek(at)
            file.write(self._lines[at:] + self._end)

    def _wait(self, seconds: float) -> None:
        """No sooner than this after the last call: a hand moves in the time of the one whose hand it is."""
        if (rest := self._next - time.perf_counter()) > 0.0:
            time.sleep(rest)
        self._next = max(self._next, time.perf_counter()) + seconds


def read_request(path: Path) -> tuple[str, tuple[float, ...], tuple[float, ...]] | None:
    """The object that is held, the point of it as it is at the start [m], and where the hand is [m]; None for no hand, for one of
    which nothing was heard for `SILENT` seconds, and for a file that has anything else."""
    with suppress(OSError, ValueError, Misfit):
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK)
        with open(handle, "rb") as file:
            found = os.fstat(handle)
            if not stat.S_ISREG(found.st_mode) or found.st_size > MOST_BYTES or time.time() - found.st_mtime > SILENT:
                return None
            asked = FORM(strict_json(file.read(MOST_BYTES)))
        at, to = tuple(asked["at"]), tuple(asked["to"])
        if len(at) == len(to) == 3 and all(abs(x) <= FARTHEST for x in (*at, *to)):
            return asked["object"], at, to
    return None
