# SPDX-License-Identifier: GPL-2.0-only
"""The supervisor: starts the executors, puts their shares of frames together, and under central control decides for them.

It is the source of a run's frames (run/frame_source.py); what becomes of them is the same as in the sequential program. Executors
write the rows of particles into the trajectory file themselves, so that what a frame takes here does not grow with particles.
"""

from __future__ import annotations

import queue
import threading
import time
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import field

import numpy as np
from mpi4py import MPI

from ... import errors
from ...engine.state import State, join_all
from ...engine.sub_plan import SubPlans
from ...errors import DivergedError
from ...records import dataclass
from ...results.timeline import Timeline
from ...run.energy import ledger_terms, loss_terms, potentials, whole_fields
from ...run.frame_source import Account, Frame, LammpsFailure
from ...run.observe import join, recorded_models
from ...run.prepare import Prepared
from ..plan.frame_plan import PlannerOptions
from ..plan.orders import Report
from ..plan.planner import Planner
from .control import planner_of
from .messages import LONG_NAP, NAP, SUPERVISOR, Ended, Failure, Grant, Job, Kept, Mail, Share, Tag, scatter

CREDIT = 2
"""Frames that executors may be ahead of what has been taken."""
KEEP_SECONDS = 5.0
"""Wall time between frames for which executors send what a checkpoint needs."""
PATIENCE = 5.0
"""Seconds that executors have to end after something has gone wrong."""


class Distributed:
    """K executors under one supervisor, on the ranks of a communicator; a `source.FrameSource`."""

    def __init__(self, ready: Prepared, world: MPI.Comm, control: str, settings: PlannerOptions):
        self.ready, self.world, self.control, self.settings = ready, world, control, settings
        self.executors = world.size - 1
        self.lengths = ready.certificate.lengths
        self.losses = dict.fromkeys(loss_terms(ready.plan), 0.0)
        self.pending: dict[int, PendingFrame] = {}
        self.messages: MessageThread | None = None
        """From the beginning of the run on."""
        self.told: dict[int, Account] = {}
        """Where the time of executors went, as they last told."""
        self.ended: dict[int, Ended] = {}
        self.gone: set[int] = set()
        """Executors that have said their last word."""
        self.stopped = False
        """Whether an end was asked for after the last frame that was granted."""
        self.clean = False
        """Whether all executors have come to their end; after an error they may be anywhere, and be waiting for each other."""
        self.timeline = Timeline(self.executors, control, ready.system.names)
        self.before: Timeline | None = None
        """The log of a run that is resumed: in the end `timeline` begins with it."""

    # --- as a source of frames ------------------------------------------------------------------------------------

    def __enter__(self) -> Distributed:
        return self

    def begin(self, resume, rows):
        ready, system = self.ready, self.ready.system
        self.step = resume.step if resume else 0
        self.start = (
            (resume.x, resume.v, resume.f) if resume else (system.position, system.velocity, np.zeros_like(system.position))
        )
        self.granted = self.resumed_at = resume.frame if resume else 0
        self.taken = resume.frame if resume else -1
        self.kept: list[Kept] = []
        """Data that executors have sent with the last kept frame."""
        self.kept_at, self.cpu_begun = time.perf_counter(), time.thread_time()
        models = recorded_models(ready.models, ready.plan)
        job = Job(ready.plan, self.lengths, self.control, resume, self.settings, rows, models)
        self.messages = MessageThread(self.world, job)
        self.messages.start()
        return None if resume else self._frame(0, keep=True)

    def advance(self, frame, steps):
        while not self.stopped and self.granted < min(frame + CREDIT - 1, len(self.lengths)):
            self._grant(self.granted + 1)
        self.step += steps
        return self._frame(frame, self._pending(frame).keep)

    def stop(self, frame):
        if not self.stopped and self.granted < len(self.lengths):  # it may be asked for again after every frame that still comes
            self.messages.send_all(Tag.GRANT, None)
            self._pending(self.granted).keep = self.stopped = True
        return self.granted

    def state(self):
        x, v, f = (array.copy() for array in self.start)  # right for what never moves
        for kept in self.kept:
            scatter(kept.places, (x, kept.x), (v, kept.v), (f, kept.f))
        return State(x, v, f, join_all(kept.records for kept in self.kept))

    def account(self):
        """Where the executors' time went, the mean of all."""
        while len(self.ended) < self.executors:
            self._take()
        return self._mean([ended.account for ended in self.ended.values()])

    def account_so_far(self):
        """The same, where all executors have told of theirs."""
        return self._mean(self.told.values()) if len(self.told) == self.executors else None

    @property
    def cpu(self) -> float:
        """Processor time of this process since the run began, without looks for messages while there is none [s]."""
        return time.thread_time() - self.cpu_begun + self.messages.cpu

    def new_owners(self):
        owners, frame = self.timeline.owners, self.timeline.frames[-1]
        first = bisect_left(owners, frame, key=lambda change: change[0])
        return [(m, executor) for _, m, executor in owners[first:]]

    def _mean(self, accounts: Iterable[Account]) -> Account:
        mean = Account()
        for account in accounts:
            mean.add_all(account, 1.0 / self.executors)
        return mean

    def __exit__(self, kind, *_) -> None:
        if self.messages is None:  # it has not begun
            return
        self.clean = kind is None or (self.stopped and self.taken == self.granted)
        if not self.clean:
            self.messages.send_all(Tag.ABORT, None)
        end = time.perf_counter() + PATIENCE
        while len(self.gone) < self.executors and time.perf_counter() < end and self.messages.is_alive():
            try:
                self._take(patience=0.1)
            except Exception:  # whatever follows, the first word was that of the cause
                self.clean = False
        self.clean &= len(self.gone) == self.executors
        self.messages.close()
        for executor, ended in self.ended.items():
            self.timeline.spans += [(executor, *span) for span in ended.spans]
            self.timeline.cpu[executor] = ended.cpu
        self.timeline.supervisor_cpu = self.cpu
        if self.before:
            self.timeline = self.timeline.after(self.before, self.resumed_at)

    # --- frames ---------------------------------------------------------------------------------------------------

    def _grant(self, frame: int) -> None:
        keep = frame == len(self.lengths) or time.perf_counter() - self.kept_at > KEEP_SECONDS
        if keep:
            self.kept_at = time.perf_counter()
        self._pending(frame).keep = keep
        self.messages.send_all(Tag.GRANT, Grant(frame, keep))
        self.granted = frame

    def _pending(self, frame: int) -> PendingFrame:
        return self.pending.setdefault(frame, PendingFrame())

    def _frame(self, frame: int, keep: bool) -> Frame:
        """Wait for all shares of a frame. Raises what an executor raised."""
        pending = self._pending(frame)
        while len(pending.shares) < self.executors or (keep and len(pending.kept) < self.executors):
            self._take()
        del self.pending[frame]
        self.taken = frame
        shares = [pending.shares[e] for e in range(self.executors)]
        seen = join([share.seen for share in shares])
        energies = dict.fromkeys(ledger_terms(self.ready.plan), 0.0)
        for share in shares:
            for term, e in share.energies.items():
                if term in self.losses:
                    self.losses[term] += e
                else:
                    energies[term] += e
        self.timeline.add(
            frame,
            [s.objects for s in shares],
            sum(s.moves for s in shares),
            max(s.retries for s in shares),
            [team for s in shares for team in s.teams],
        )
        if keep:
            self.kept = list(pending.kept.values())
        return Frame(
            self.step,
            seen,
            np.bitwise_xor.reduce([share.checksums for share in shares]),
            energies | potentials(self.ready.plan, seen.center) | self.losses,
            max(s.penetration for s in shares),
            whole_fields(self.ready.plan, [(s.objects, s.fields) for s in shares]),
            keep,
        )

    def _take(self, patience: float | None = None) -> None:
        """Wait for one message and file it. Raises what an executor or the message thread raised."""
        try:
            executor, message = self.messages.inbox.get(timeout=patience)
        except queue.Empty:
            return
        if isinstance(message, Share):
            self._pending(message.frame).shares[executor] = message
            if message.account:
                self.told[executor] = message.account
        elif isinstance(message, Kept):
            if message.frame > self.taken:  # else sent a second time, by an end after a frame that was kept anyway
                self._pending(message.frame).kept[executor] = message
        elif isinstance(message, Ended):
            self.gone.add(executor)
            if message.account is not None:
                self.ended[executor] = message
        elif isinstance(message, Failure):
            self.gone.add(executor)
            if message.kind == "LammpsFailure":
                raise LammpsFailure(message.step, DivergedError(message.text), message.solid)
            raise getattr(errors, message.kind)(message.text)
        else:
            raise message


@dataclass
class PendingFrame:
    """A frame of which shares are still to come."""

    shares: dict[int, Share] = field(default_factory=dict)
    """By executor."""
    keep: bool = False
    """Whether what a checkpoint needs comes with it."""
    kept: dict[int, Kept] = field(default_factory=dict)
    """By executor."""


class MessageThread(threading.Thread):
    """All talk with executors, so that none of them waits while a frame is written; central control decides here."""

    def __init__(self, world: MPI.Comm, job: Job):
        super().__init__(daemon=True)
        self.world, self.job = world, job
        self.inbox: queue.Queue = queue.Queue()
        """(executor, message) that the source of frames is to take."""
        self.outbox: queue.Queue = queue.Queue()
        self.closing = threading.Event()
        self.cpu = 0.0
        """Processor time on messages that there were [s]."""

    def send_all(self, tag: Tag, message) -> None:
        """Send to all executors."""
        self.outbox.put((tag, message))

    def close(self) -> None:
        """Send what is left, then end."""
        self.closing.set()
        self.join()

    def run(self) -> None:
        try:
            self._work()
        except Exception as error:  # the main thread waits for the inbox: it must hear of everything
            self.inbox.put((SUPERVISOR, error))

    def _work(self) -> None:
        world, job = self.world, self.job
        world.Split(0, world.rank)
        world.bcast(job, root=SUPERVISOR)
        mail = Mail(world)
        executors = world.size - 1
        planner = planner_of(job, SubPlans(job.plan), executors) if job.control == "central" else None
        reports = {}
        nap = NAP
        while True:
            begin = time.thread_time()
            closing = self.closing.is_set()
            busy = self._send(mail, executors)
            while (message := mail.peek(MPI.ANY_TAG, MPI.ANY_SOURCE)) is not None:
                status = MPI.Status()
                received, executor = message.recv(status=status), status.source - 1
                busy = True
                if status.tag != Tag.REPORT:
                    self.inbox.put((executor, received))
                    continue
                reports[executor] = received
                if len(reports) == executors:
                    self._decide(mail, planner, [reports.pop(e) for e in range(executors)])
            if closing and not busy:
                mail.forget_sent()
                return
            nap = NAP if busy else min(2.0 * nap, LONG_NAP)
            if busy:
                self.cpu += time.thread_time() - begin
            else:
                time.sleep(nap)

    def _decide(self, mail: Mail, planner: Planner, reports: list[Report]) -> None:
        try:
            order = planner.decide(reports)
        except Exception as error:  # the main thread is told, and wants to send an ABORT from here
            self.inbox.put((SUPERVISOR, error))
            return
        for e in range(len(reports)):
            mail.send(e + 1, Tag.ORDER, order)

    def _send(self, mail: Mail, executors: int) -> bool:
        try:
            tag, message = self.outbox.get_nowait()
        except queue.Empty:
            return False
        for e in range(executors):
            mail.send(e + 1, tag, message)
        return True
