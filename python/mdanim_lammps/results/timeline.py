# SPDX-License-Identifier: GPL-2.0-only
"""The activities of executors in a run, and their objects over time: timeline.json."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, field
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..records import dataclass
from .files import read_json, write_json
from .forms import number, whole
from .untrusted import check_room

TIMELINE = "timeline.json"
"""Name of the file in the output folder."""
MOST_EXECUTORS = 1_000_000
MOST_BYTES = 1 << 32
"""Largest size of the file: 70 bytes for each span of each executor."""
KINDS = ("simulating", "moving", "waiting", "frozen", "held")
"""Activities of an executor: running LAMMPS; handing objects on and building instances; waiting for the others at the frame;
frozen at the end of a window that others do again; held by the supervisor, which has not yet taken the frames before."""


@dataclass
class Timeline:
    """The log of a run on several executors."""

    executors: int
    control: str
    """``central`` or ``peers``."""
    names: tuple[str, ...]
    """Names of the objects."""
    frames: list[int] = field(default_factory=list)
    moves: list[int] = field(default_factory=list)
    """Objects that changed their executor on the way to each frame."""
    retries: list[int] = field(default_factory=list)
    """How often windows on the way to each frame were begun again."""
    teams: list[tuple[int, tuple[int, ...]]] = field(default_factory=list)
    """(frame, executors, the leading one first) of every team that has run on the way to a frame."""
    owners: list[tuple[int, int, int]] = field(default_factory=list)
    """(frame, object, executor) whenever an object is first owned, or by another; what never moves has no owner."""
    spans: list[tuple[int, str, int, float, float]] = field(default_factory=list)
    """(executor, kind, frame, begin, end), times in seconds since all executors began; kinds are `KINDS`."""
    cpu: list[float] = field(default_factory=list)
    """Processor time of each executor since all began [s]; 0 for one that did not come to its end."""
    supervisor_cpu: float = 0.0
    """The same of the supervisor, without that of looking for messages while there is none [s]."""

    def __post_init__(self) -> None:
        self.cpu = self.cpu or [0.0] * self.executors
        self._now = np.full(len(self.names), -1)  # owners at the last frame

    def add(
        self, frame: int, objects: Sequence[np.ndarray], moves: int, retries: int, teams: Sequence[tuple[int, ...]] = ()
    ) -> None:
        """Take note of a frame; ``objects`` are those of each executor, in their order."""
        now = np.full(len(self.names), -1)
        for executor, mine in enumerate(objects):
            now[mine] = executor
        self.owners += [(frame, int(m), int(now[m])) for m in np.flatnonzero(now != self._now)]
        self._now = now
        self.frames.append(frame)
        self.moves.append(moves)
        self.retries.append(retries)
        self.teams += [(frame, team) for team in teams]

    def after(self, before: Timeline, frame: int) -> Timeline:
        """This log of a run that was resumed at a frame, with what the log before tells up to there.

        Times go on from the last of those that are kept. With other numbers of executors they are those of the larger one, and
        processor times are sums of both, with what came after that frame and is done again; the control is that of now.
        """
        kept = int(np.searchsorted(before.frames, frame, side="right"))
        spans = [span for span in before.spans if span[2] <= frame]
        begun = max((end for *_, end in spans), default=0.0)
        frames, table = [*before.frames[:kept], *self.frames], np.concatenate([before.owner()[:kept], self.owner()])
        changed = np.argwhere(np.diff(table, axis=0, prepend=-1))
        executors = max(self.executors, before.executors)
        cpu = [sum(log.cpu[e] for log in (before, self) if e < log.executors) for e in range(executors)]
        return Timeline(
            executors,
            self.control,
            self.names,
            frames,
            [*before.moves[:kept], *self.moves],
            [*before.retries[:kept], *self.retries],
            teams=[*(team for team in before.teams if team[0] <= frame), *self.teams],
            owners=[(frames[row], int(m), int(table[row, m])) for row, m in changed],
            spans=[*spans, *((*what, begin + begun, end + begun) for *what, begin, end in self.spans)],
            cpu=cpu,
            supervisor_cpu=before.supervisor_cpu + self.supervisor_cpu,
        )

    def owner(self) -> np.ndarray:
        """Executor of every object at every frame, -1 for none, int64, shape (F, M)."""
        table = np.full((len(self.frames), len(self.names)), -1)
        since = np.full_like(table, -1)
        if self.owners:
            frame, m, executor = np.array(self.owners).T
            row = np.searchsorted(self.frames, frame)
            table[row, m], since[row, m] = executor, row
        since = np.maximum.accumulate(since, axis=0)
        return np.where(since < 0, -1, np.take_along_axis(table, np.maximum(since, 0), axis=0))

    @property
    def seconds(self) -> float:
        """Wall time from the begin to the last end of all spans [s]."""
        return max((end for *_, end in self.spans), default=0.0)

    def spent(self) -> np.ndarray:
        """Wall time of each executor by `KINDS` [s], shape (K, kinds)."""
        spent = np.zeros((self.executors, len(KINDS)))
        for executor, kind, _, begin, end in self.spans:
            spent[executor, KINDS.index(kind)] += end - begin
        return spent

    def busy(self) -> np.ndarray:
        """Part of the wall time that each executor was simulating, shape (K,)."""
        return self.spent()[:, KINDS.index("simulating")] / (self.seconds or 1.0)

    def frame_ends(self) -> dict[int, float]:
        """When the last executor was done with a frame [s]."""
        ends: dict[int, float] = {}
        for _, _, frame, _, end in self.spans:
            ends[frame] = max(end, ends.get(frame, 0.0))
        return ends

    def write(self, folder: Path) -> None:
        """Write timeline.json. Raises OutputError."""
        write_json(folder / TIMELINE, asdict(self))

    @classmethod
    def left_in(cls, folder: Path) -> Timeline | None:
        """The timeline that a run has left in its folder; None without any, as all of the run was sequential. Raises
        OutputError."""
        return cls.read(folder) if (folder / TIMELINE).exists() else None

    @classmethod
    def read(cls, folder: Path) -> Timeline:
        """Read timeline.json of an output folder. Raises OutputError."""
        data = read_json(folder / TIMELINE, most=MOST_BYTES)
        try:
            if not 1 <= whole(data["executors"]) <= MOST_EXECUTORS:
                raise ValueError("its executors are not those of a run")
            rows = {k: [tuple(row) for row in data[k]] for k in ("owners", "spans")}
            teams = [(frame, tuple(members)) for frame, members in data["teams"]]
            read = cls(**data | rows | {"names": tuple(data["names"]), "teams": teams})
            read._check()
        except (KeyError, TypeError, ValueError, IndexError, OverflowError) as error:
            raise OutputError(f"{folder / TIMELINE} is damaged ({error}); run the scene again") from error
        return read

    def _check(self) -> None:
        """Raises ValueError, TypeError where numbers name what is not there."""
        executors, objects = self.executors, len(self.names)
        frames, spans = np.array(self.frames, np.int64), np.array([s[3:] for s in self.spans], float).reshape(-1, 2)
        owners = np.array(self.owners, np.int64).reshape(-1, 3)
        for what, holds in (
            ("executors", len(self.cpu) == executors and isinstance(self.control, str)),
            ("processor times", all(number(seconds) >= 0.0 for seconds in (*self.cpu, self.supervisor_cpu))),
            ("moves", all(type(n) is int and n >= 0 for n in (*self.moves, *self.retries))),
            ("teams", all(type(f) is int and all(type(e) is int and 0 <= e < executors for e in team) for f, team in self.teams)),
            ("owners", all(len(row) == 3 and all(type(n) is int for n in row) for row in self.owners)),
            ("frames", (np.diff(frames) > 0).all() and len(frames) == len(self.moves) == len(self.retries)),
            (
                "owners",
                np.isin(owners[:, 0], frames).all()
                and ((owners[:, 1:] >= [0, -1]) & (owners[:, 1:] < [objects, executors])).all(),
            ),
            ("spans", np.isfinite(spans).all() and (spans[:, 0] >= 0.0).all() and (spans[:, 0] <= spans[:, 1]).all()),
            ("spans", all(0 <= e < executors and kind in KINDS and type(frame) is int for e, kind, frame, *_ in self.spans)),
            ("names", all(isinstance(name, str) for name in self.names)),
        ):
            if not holds:
                raise ValueError(f"its {what} are not those of a run")
        check_room(8.0 * (2 * len(frames) * objects + executors * 2400), TIMELINE)
