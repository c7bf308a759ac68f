# SPDX-License-Identifier: GPL-2.0-only
"""Messages between supervisor and executors (docs/distribution.md shows the whole protocol), and waiting for them."""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Sequence
from dataclasses import field
from enum import IntEnum

import numpy as np
from mpi4py import MPI
from mpi4py.util import pkl5

from ...effects.fields import Fields
from ...engine.plan import Plan
from ...engine.state import Records
from ...model.model import Model
from ...records import dataclass
from ...results.checkpoint import Checkpoint
from ...results.frame_rows import FrameRows
from ...run.frame_source import Account
from ...run.observe import Observation
from ..plan.frame_plan import PlannerOptions

SUPERVISOR = 0
"""Its rank; executor e, counted from 0, has the rank e + 1."""
NAP, LONG_NAP = 0.0002, 0.001
"""Shortest and longest pause of a rank that waits [s]."""
DROWSE = 0.02
"""A pause over the time that a rank has waited: looks take processor time too."""


class Tag(IntEnum):
    """Kinds of messages."""

    GRANT = 1
    """Supervisor to executor: `Grant`, or None for an end after the last frame that was granted."""
    ABORT = 3
    """Supervisor to executor: an end at once; something has gone wrong elsewhere."""
    ORDER = 4
    """Supervisor to executor, central control: `Order`."""
    REPORT = 5
    """Executor to supervisor, central control: `Report`."""
    FRAME = 6
    """Executor to supervisor: `Share`."""
    KEPT = 7
    """Executor to supervisor: `Kept`."""
    FAILED = 8
    """Executor to supervisor: `Failure`."""
    ENDED = 9
    """Executor to supervisor: `Ended`."""
    OBJECTS = 10
    """Executor to executor: `Moved`."""
    TEAM = 11
    """Leader of a team to its members: `Moved`."""


@dataclass(frozen=True)
class Job:
    """All that an executor must know to begin; the same for all."""

    plan: Plan
    lengths: tuple[int, ...]
    """Steps to each frame."""
    control: str
    """``central`` or ``peers``."""
    resume: Checkpoint | None
    settings: PlannerOptions
    rows: FrameRows
    """Where rows of particles go."""
    models: tuple[Model, ...]
    """`recorded_models`."""


@dataclass(frozen=True)
class Grant:
    """Leave to simulate up to a frame: the supervisor has room for it."""

    frame: int
    keep: bool
    """Whether what a checkpoint needs is to be sent with it."""


@dataclass(frozen=True)
class Moved:
    """Objects on their way: everything about them that changes."""

    x: np.ndarray
    """[m], of all particles of the objects, ascending, shape (n, 3)."""
    v: np.ndarray
    f: np.ndarray
    """Forces [N]: dashpots see half-step velocities that x and v do not hold."""
    records: Records = field(default_factory=dict)
    """Values that fixes keep, as records that travel with these objects."""


@dataclass(frozen=True)
class Share:
    """An executor's part of a frame, of which it has written its rows of particles into the file."""

    frame: int
    objects: np.ndarray
    """Its own."""
    seen: Observation
    """Observation of these objects, and of its part of those that never move."""
    checksums: np.ndarray
    """Checksums of its rows, as `RowWriter.write` gives them."""
    energies: dict[str, float]
    penetration: float
    fields: Fields
    """Values of effects for these objects, by the names of fields."""
    moves: int
    """Objects that have come to this executor since the frame before."""
    retries: int
    """How often windows were begun again on the way to this frame."""
    teams: tuple[tuple[int, ...], ...] = ()
    """Executors of the teams that it has led on the way, each once."""
    account: Account | None = None
    """Where its time went so far, every now and then."""


@dataclass(frozen=True)
class Kept:
    """Data of a frame for a checkpoint; all rows that the executor has written by then are on the disk."""

    frame: int
    places: list[slice]
    """Particles that it tells of: those of its objects, but for what others of a team tell."""
    x: np.ndarray
    """[m], shape (n, 3)."""
    v: np.ndarray
    """[m/s], shape (n, 3)."""
    f: np.ndarray
    """[N], shape (n, 3)."""
    records: Records
    """Records that travel with the objects that the executor owns."""


@dataclass(frozen=True)
class Failure:
    """Why an executor cannot go on."""

    kind: str
    """Name of an error of errors.py, or ``LammpsFailure``."""
    text: str
    step: int = 0
    solid: int | None = None


@dataclass(frozen=True)
class Ended:
    """An executor's last word."""

    account: Account | None
    """None when it was told to abort."""
    spans: list[tuple[str, int, float, float]] = field(default_factory=list)
    """Its activities: kind, frame, begin and end [s] since all began."""
    cpu: float = 0.0
    """Processor time since all began [s]."""


def gathered(places: Sequence[slice], *arrays: np.ndarray) -> list[np.ndarray]:
    """Copies of these rows of each array, side by side."""
    return [np.concatenate([array[:0], *(array[place] for place in places)]) for array in arrays]


def scatter(places: Sequence[slice], *pairs: tuple[np.ndarray, np.ndarray]) -> None:
    """The reverse of `gathered`: copies into the first array of each pair, from the second."""
    for whole, part in pairs:
        begin = 0
        for place in places:
            end = begin + place.stop - place.start
            whole[place] = part[begin:end]
            begin = end


class Aborted(Exception):
    """The supervisor wants an end at once."""


class Mail:
    """Messages to and from other ranks; waiting for one sees an ABORT too.

    Large arrays go as they are, without a copy (pkl5): the sender must not change them any more.
    """

    def __init__(self, world: MPI.Comm):
        self.world = pkl5.Intracomm(world)
        self.sent: list[pkl5.Request] = []

    def send(self, to: int, tag: Tag, message, comm: MPI.Comm | None = None) -> None:
        """Send without waiting for the receiver."""
        self.forget_sent()
        self.sent.append(self._with(comm).isend(message, dest=to, tag=tag))

    def forget_sent(self) -> None:
        """Messages that are on their way need no more care; MPI complains at its end of those that it was never asked about."""
        self.sent = [request for request in self.sent if not request.test()[0]]

    def _with(self, comm: MPI.Comm | None) -> pkl5.Intracomm:
        return self.world if comm is None else pkl5.Intracomm(comm)

    def take(self, tag: Tag, source: int = SUPERVISOR, comm: MPI.Comm | None = None):
        """Wait for a message. Raises Aborted."""
        return self.wait(lambda: self.peek(tag, source, comm)).recv()

    def peek(self, tag: int, source: int = SUPERVISOR, comm: MPI.Comm | None = None) -> pkl5.Message | None:
        """A message that has come, not yet received; None without one."""
        return self._with(comm).improbe(source=source, tag=tag)

    def wait(self, look: Callable[[], object]):
        """Call ``look`` until it gives something, which is returned. Raises Aborted."""
        begin = time.perf_counter()
        while not (found := look()):
            if self.world.iprobe(source=SUPERVISOR, tag=Tag.ABORT):
                raise Aborted
            time.sleep(min(max(NAP, DROWSE * (time.perf_counter() - begin)), LONG_NAP))
        return found

    def exchange(self, comm: MPI.Comm, message) -> list:
        """The messages of all ranks, in their order. Raises Aborted."""
        mine = np.frombuffer(pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL), np.uint8)
        size = np.empty(comm.size, np.int64)
        self.wait(comm.Iallgather(np.array([len(mine)]), size).Test)
        all_of_them = np.empty(size.sum(), np.uint8)
        self.wait(comm.Iallgatherv(mine, (all_of_them, size)).Test)
        ends = np.cumsum(size)
        return [pickle.loads(all_of_them[end - n : end].data) for end, n in zip(ends, size)]

    def flush(self) -> None:
        """Wait until everything that was sent is on its way. Raises Aborted."""
        for request in self.sent:
            self.wait(lambda request=request: request.test()[0])
        self.sent.clear()
