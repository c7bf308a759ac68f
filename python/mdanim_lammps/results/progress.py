# SPDX-License-Identifier: GPL-2.0-only
"""progress.jsonl: what a run says of itself while it goes on, a line of JSON at a time (docs/view.md)."""

from __future__ import annotations

import json
import os
from array import array
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..errors import ExitCode, OutputError
from .files import disk_errors
from .forms import many, number, strict_json, table, text, whole

PROGRESS = "progress.jsonl"
"""Name of the file in the output folder."""
ENDED = ("done", "stopped", "failed")
"""States after which a run writes no more."""
_LOT = 1 << 20
LONGEST = 1 << 24
"""Bytes of a line at most."""
MOST_BYTES = 1 << 30
"""Largest size of the file [bytes]: a frame takes some 300."""
MOST_EXECUTORS = 1_000_000


class ProgressLog:
    """Appends to progress.jsonl; a context manager whose end says how the run has ended.

    Every line reaches the file at once, in one write, so that a killed run leaves whole lines but for the last one.

    Args:
        folder: of the run.
        columns: of the ledger.
        energies: how many of the columns after the time are energies.
        frames: of the whole run, the first included.
        executors: processes that simulate.
        resumed: frame from which the run goes on: what the file says of later ones no longer holds. None begins a new file.

    Raises:
        OutputError: the file cannot be written; so do all methods.
    """

    def __init__(
        self, folder: Path, *, columns: Sequence[str], energies: int, frames: int, executors: int, resumed: int | None = None
    ):
        self.path, self.columns = folder / PROGRESS, tuple(columns)
        flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC
        with disk_errors(self.path):
            self._file = os.open(self.path, flags | (os.O_TRUNC if resumed is None else 0), 0o666)
        begin = {"columns": list(columns), "energies": energies, "frames": frames, "executors": executors}
        if resumed is not None:
            begin["resumed"] = resumed
            with disk_errors(self.path):
                os.write(self._file, b"\n")  # ends a line that a killed run has not ended
        self._write(begin | {"state": "running"})

    def frame(self, frame: int, row: Mapping[str, float], seconds: float, owners: Sequence[tuple[int, int]] = ()) -> None:
        """A frame that is in the trajectory: its row of the ledger, the wall seconds of the simulation so far, and
        (object, executor) of objects that now belong to another executor."""
        line = {"frame": frame, "row": [row[column] for column in self.columns], "seconds": round(seconds, 4)}
        if owners:
            line["owners"] = owners
        self._write(line)

    def cost(self, parts: Mapping[str, float]) -> None:
        """Seconds of each effect and of each other piece of work so far."""
        self._write({"cost": {name: round(seconds, 4) for name, seconds in parts.items()}})

    def state(self, state: str, message: str = "") -> None:
        """Note the present state of the run: ``running``, ``paused`` or one of `ENDED`."""
        self._write({"state": state} | ({"message": message} if message else {}))

    def __enter__(self) -> ProgressLog:
        return self

    def __exit__(self, kind, error, traceback) -> None:
        try:
            if error is None:
                self.state("done")
            else:
                stopped = getattr(error, "exit_code", None) is ExitCode.INTERRUPTED
                self.state("stopped" if stopped else "failed", str(error) or kind.__name__)
        except Exception:
            if error is None:
                raise  # else the first error is the one to tell
        finally:
            os.close(self._file)

    def _write(self, line: dict) -> None:
        data = json.dumps(line, ensure_ascii=False, check_circular=False).encode() + b"\n"
        with disk_errors(self.path):
            while data:
                data = data[os.write(self._file, data) :]


class ProgressTail:
    """Follows progress.jsonl of a run, which may be another's: lines that no run writes are left out.

    What is known so far is in the attributes; `read` takes what has come since.
    """

    def __init__(self, folder: Path):
        self.path = folder / PROGRESS
        self._file: int | None = None
        self._forget()

    def _forget(self) -> None:
        self.columns: list[str] = []
        self.energies = 0
        """How many of the columns after the time are energies."""
        self.total = 0
        """Frames of the whole run; 0 while unknown."""
        self.executors = 1
        self.count = 0
        """Frames that are in the trajectory."""
        self.rows = array("d")
        """The ledger so far, row by row, shape (count, columns)."""
        self.owners: list[tuple[int, int, int]] = []
        """(frame, object, executor) as in `Timeline.owners`."""
        self.cost: dict[str, float] = {}
        self.seconds = 0.0
        """Wall time of the simulation so far [s]."""
        self.state, self.message = "", ""
        """The last state, empty while there is none, and what was said with it."""
        self.lives = 0
        """How often the run has begun or was resumed: a reader that knows frames of an earlier life forgets those after it."""
        self.keep = 0
        """Frames of earlier lives that still hold."""
        self._rest: list[bytes] = []
        """The begin of a line whose end has not come."""

    def read(self) -> bool:
        """Take what has come; returns whether the file is another one than before, as of a run begun anew.

        Raises OSError, and OutputError for a file that is too large, or has a line that is too long, to be that of a run.
        """
        anew = self._reopen()
        if self._file is not None and os.fstat(self._file).st_size > MOST_BYTES:
            raise OutputError(f"{self.path} has more than {MOST_BYTES} bytes: no run of this program writes that")
        while self._file is not None and (data := os.read(self._file, _LOT)):
            first, *lines = data.split(b"\n")
            self._rest.append(first)
            if sum(map(len, self._rest)) > LONGEST:
                self._rest = []
                os.lseek(self._file, 0, os.SEEK_END)
                raise OutputError(f"{self.path} is damaged: a line has more than {LONGEST} bytes")
            if lines:
                self._take(b"".join(self._rest))
                self._rest = [lines.pop()]
                for line in lines:
                    self._take(line)
        return anew

    def is_at(self, descriptor: int) -> bool:
        """Whether the folder's file is this one, which is open."""
        try:
            return os.path.samestat(os.lstat(self.path), os.fstat(descriptor))
        except FileNotFoundError:
            return False

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def _reopen(self) -> bool:
        try:
            there = os.lstat(self.path)
        except FileNotFoundError:
            return False
        if self._file is not None:
            now = os.fstat(self._file)
            if os.path.samestat(there, now) and now.st_size >= os.lseek(self._file, 0, os.SEEK_CUR):
                return False
        anew = self._file is not None
        self.close()
        self._forget()
        self._file = os.open(self.path, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK)
        return anew

    def _take(self, line: bytes) -> None:
        try:
            said = strict_json(line) if line else {}
            if "columns" in said:
                self._begin(said)
            if "frame" in said:
                self._frame(said)
            if "cost" in said:
                self.cost = table(number)(said["cost"])
            if "state" in said:
                self.state, self.message = text(said["state"]), text(said.get("message", ""))
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError, OverflowError):
            return

    def _begin(self, said: dict) -> None:
        columns = many(text)(said["columns"])
        resumed = whole(said["resumed"]) + 1 if "resumed" in said else 0
        keep = min(self.count, resumed) if columns == self.columns else 0
        energies, total, executors = (whole(said.get(name, 1)) for name in ("energies", "frames", "executors"))
        if not (len(columns) > energies and executors <= MOST_EXECUTORS):
            raise ValueError("not those of a run")
        self.columns, self.energies, self.total, self.executors = columns, energies, total, executors
        self.count, self.keep, self.lives = keep, keep, self.lives + 1
        del self.rows[keep * len(columns) :]
        self.owners = [change for change in self.owners if change[0] < keep]

    def _frame(self, said: dict) -> None:
        row, seconds = [float(number(value)) for value in said["row"]], float(number(said["seconds"]))
        owners = [(self.count, whole(m), whole(executor + 1) - 1) for m, executor in said.get("owners", ())]
        if said["frame"] != self.count or len(row) != len(self.columns) or self.count == self.total:
            return
        self.rows.extend(row)
        self.owners += owners
        self.seconds = seconds
        self.count += 1
