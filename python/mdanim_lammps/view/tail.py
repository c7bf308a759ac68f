# SPDX-License-Identifier: GPL-2.0-only
"""Follows the output folder of a run: how far it is, what it says of itself, its trajectory."""

from __future__ import annotations

import math
import os
import threading
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from ..errors import MdanimError, OutputError, SceneError
from ..records import dataclass
from ..results.files import in_use
from ..results.ledger import Ledger
from ..results.progress import ENDED, ProgressTail
from ..results.stored import read_facts
from ..results.timeline import Timeline
from ..results.trajectory_file import find_trajectory, trajectory_names
from ..run.folder import stored_scene
from ..scene.render import Render
from .feed import Feed
from .told import ShownQuantities

LOOK = 0.02
"""Wall time between two looks at the folder [s]."""
LOOK_FOR_LIFE = 1.0
"""The same between two looks whether the processes of a run are alive [s]."""
MOST_ROWS = 2000
"""Rows of the ledger in one message: of more, every n-th is sent."""
LIVE = ("preparing", "running", "paused")
"""States in which a run has not ended."""


@dataclass
class Known:
    """How much of a run a page has been told."""

    life: tuple[int, int] = (-1, -1)
    """Which files, and which life of their run."""
    rows: int = 0
    owners: int = 0
    last: dict | None = None


class Tail:
    """The known part of a run, kept up to date by a thread. All public methods may be called by several threads.

    Args:
        folder: output folder, where a run is going on, has ended or is about to begin.

    Raises:
        OutputError: there is no run, or the files that it has left are damaged.
    """

    def __init__(self, folder: Path):
        self.folder = folder
        self._stored()
        read_facts(folder)
        self.changed = threading.Condition()
        """Notified whenever there is something new."""
        self.changes = 0
        """How often there was something new."""
        self._progress = ProgressTail(folder)
        self._feed: Feed | None = None
        self._told: ShownQuantities | None = None
        self._files = 0
        self._state = "preparing"
        self._message = ""
        self._awaited = False
        """Whether a run is about to begin whose processes have not claimed the folder yet."""
        self._before: int | None = None
        """Descriptor of the progress.jsonl of an earlier run, which the one that is about to begin will replace: while it is
        open, no other file is given its number."""
        self._facts: dict = {}
        self._looked = -LOOK_FOR_LIFE
        self._closing = threading.Event()
        self._look()
        self._thread = threading.Thread(target=self._follow, daemon=True)

    def __enter__(self) -> Tail:
        self._thread.start()
        return self

    def __exit__(self, *_) -> None:
        self._closing.set()
        self._thread.join()
        self._progress.close()
        self._forget_before()
        if self._feed:
            self._feed.close()

    def turn_to(self, folder: Path) -> None:
        """Follow another folder from now on, in which a run is about to begin; all pages are told."""
        with self.changed:
            self._progress.close()
            self.folder, self._progress = folder, ProgressTail(folder)
            self._begin_anew()
            self._state, self._message, self._awaited = "preparing", "", True
            self._forget_before()
            with suppress(OSError):
                self._before = os.open(self._progress.path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK)
            self.changes += 1
            self.changed.notify_all()

    def say(self, message: str) -> None:
        """Tell all pages that the run which was about to begin has failed."""
        with self.changed:
            if self._state == "preparing":
                self._state, self._message = "failed", message
                self.changes += 1
                self.changed.notify_all()

    @property
    def live(self) -> bool:
        """Whether the run has not ended."""
        return self._state in LIVE

    def feed(self) -> Feed:
        """Scene and frames. Raises OutputError as long as there are none."""
        with self.changed:
            if self._feed is None:
                find_trajectory(self.folder)
                self._feed = Feed(self.folder, *self._stored(), finished=self._state == "done")
            elif self._state == "done" and not self._feed.finished:
                self._feed.finished = True
                for known in ("action", "_path", "_added", "_added_counts"):
                    self._feed.__dict__.pop(known, None)
            return self._feed

    def told(self) -> ShownQuantities:
        """Quantities of the run, of one that goes on those of the frames that there are. Raises OutputError before the first."""
        with self.changed:
            p, columns = self._progress, None
            if self.live:
                if not p.count:
                    raise OutputError("the run has no frame yet")
                table = np.array(p.rows[: p.count * len(p.columns)]).reshape(p.count, -1)
                columns = dict(zip(p.columns, table.T))
            if self._told is None:
                self._told = ShownQuantities(self.folder, columns)
            told = self._told
        if columns is not None:
            told.renew(columns)  # outside: while it waits for a curve, the run is followed
        return told

    def read_ahead(self) -> None:
        """Make the scene, where there is one, before a page asks for it: it takes half a second, as a browser does to begin."""
        with suppress(MdanimError, OSError):
            self.feed().scene()

    @property
    def count(self) -> int:
        """Frames that can be asked for: those that the run tells of and the trajectory has room for."""
        with self.changed:
            return min(self._progress.count, self._feed.frames.total) if self._feed else self._progress.count

    def news(self, known: Known) -> dict:
        """News for a page, which are then known; empty without any."""
        with self.changed:
            p, told = self._progress, {}
            if known.life != (life := (self._files, p.lives)):
                kept = min(known.rows, p.keep) if known.life[0] == self._files else 0
                known.life, known.rows, known.owners = life, kept, 0
                told |= {"columns": p.columns, "energies": p.energies, "executors": p.executors, "keep": known.rows}
            width, new = len(p.columns), p.count - known.rows
            if new:
                step = -(-new // MOST_ROWS)
                rows = (p.rows[r * width : (r + 1) * width] for r in range(known.rows, p.count, step))
                # JSON has no NaN, which a ledger.csv may hold.
                told["rows"] = [[value if math.isfinite(value) else None for value in row] for row in rows]
                known.rows = p.count
            if len(p.owners) > known.owners:
                told["owners"] = p.owners[known.owners :]
                known.owners = len(p.owners)
            last = {
                "file": self._files,
                "count": p.count,
                "total": p.total,
                "seconds": p.seconds,
                "state": self._state,
                "message": self._message,
                "cost": p.cost,
                "facts": self._facts,
            }
            told |= {key: value for key, value in last.items() if known.last is None or known.last[key] != value}
            known.last = last
            return told

    # --- the thread -----------------------------------------------------------------------------------------------

    def _follow(self) -> None:
        while not self._closing.wait(LOOK):
            with suppress(OSError, MdanimError):  # the folder may be emptied or deleted while it is looked at
                self._look()

    def _look(self) -> None:
        with self.changed:
            if self._before is not None and self._progress.is_at(self._before):
                return
            self._forget_before()
            before = (self._progress.count, self._progress.lives, self._state)
            if self._progress.read() or (self._feed and not self._is_there(self._feed)):
                self._begin_anew()
            if not self._progress.lives and time.monotonic() - self._looked > LOOK_FOR_LIFE:
                self._looked = time.monotonic()
                self._take_old()
            state = self._progress.state
            if not self._progress.lives:
                pass
            elif state in ENDED:
                self._set(state, self._progress.message)
            elif time.monotonic() - self._looked > LOOK_FOR_LIFE or state != self._state:
                self._looked = time.monotonic()
                self._set(*((state, self._progress.message) if in_use(self.folder) else ("killed", "")))
            if before != (self._progress.count, self._progress.lives, self._state):
                self.changes += 1
                self.changed.notify_all()

    def _is_there(self, feed: Feed) -> bool:
        return any(feed.frames.is_at(name) for name in trajectory_names(self.folder))

    def _forget_before(self) -> None:
        if self._before is not None:
            os.close(self._before)
            self._before = None

    def _begin_anew(self) -> None:
        # Another thread may be reading a frame of it: its file is closed when nothing has it any more.
        self._feed, self._told, self._files, self._facts = None, None, self._files + 1, {}

    def _set(self, state: str, message: str) -> None:
        if state != self._state and state == "done":
            try:
                self._facts = read_facts(self.folder)
            except OutputError as error:
                message = str(error)
        if (state in LIVE) != self.live:
            self._told = None
        self._state, self._message = state, message

    def _take_old(self) -> None:
        """A run of a version that has left no progress.jsonl, or one that has not begun to write it."""
        if self._awaited or in_use(self.folder):
            return
        try:
            frames = self.feed().frames.on_disk()
            ledger = Ledger.read(self.folder / "ledger.csv", most=frames)
            p, rows = self._progress, ledger.rows
            p.columns, p.energies, p.total = list(ledger.columns), len(ledger.terms), self.feed().frames.total
            p.rows.extend(row[column] for row in rows for column in ledger.columns)
            p.count, p.lives = len(rows), 1
            if timeline := Timeline.left_in(self.folder):
                p.owners, p.executors = timeline.owners, timeline.executors
            p.state = "done" if (self.folder / "summary.json").exists() else "stopped"
        except OutputError as error:
            self._set("failed", str(error))

    def _stored(self) -> tuple[str, Render]:
        """Title, or name, and ``render`` block of the scene."""
        try:
            scene = stored_scene(self.folder)
            return scene.title or scene.name, scene.render
        except SceneError:
            return self.folder.resolve().stem, Render()  # a scene of an older version of the language can be seen all the same
