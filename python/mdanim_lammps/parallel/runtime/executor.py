# SPDX-License-Identifier: GPL-2.0-only
"""An executor: simulates the objects that are its own, window by window, and hands them on when they are to be elsewhere.

Wcislo 1999, sec. 6; the order of messages is in docs/distribution.md.
"""

from __future__ import annotations

import time
import traceback
from collections import Counter
from contextlib import contextmanager, nullcontext

import numpy as np
from mpi4py import MPI

from ...effects.fields import Fields, part_of_fields
from ...engine.state import Records, State, StateRecords, join_all
from ...engine.sub_plan import SubPlans
from ...errors import MdanimError
from ...results.frame_rows import RowWriter
from ...run.energy import frame_fields, stored, tell, whole_fields
from ...run.frame_source import COST_SECONDS, Account, LammpsFailure, add_clocks, penetration
from ...run.observe import Observer
from ..plan.orders import Order, Report
from .bundle import Bundle, Wanted, wanted_bundles
from .control import Controller, make_control
from .messages import SUPERVISOR, Aborted, Ended, Failure, Job, Kept, Mail, Moved, Share, Tag, gathered, scatter
from .team_communicators import TeamCommunicators

ABORT_SECONDS = 2.0
"""Seconds within which mpiexec ends all ranks after one has died."""


def serve(world: MPI.Comm) -> bool:
    """Be an executor until the supervisor says that it is enough; all ranks but the supervisor's call this together.

    Returns whether that was the end of the run. If not, the supervisor has been told why; other ranks may wait for this one for
    ever, and all are to be aborted.
    """
    mail = Mail(world)
    comm = world.Split(1, world.rank)
    job = world.bcast(None, root=SUPERVISOR)
    try:
        Executor(mail, comm, job).work()
        return True
    except Aborted:
        last = Tag.ENDED, Ended(None)
    except LammpsFailure as failure:
        last = Tag.FAILED, Failure("LammpsFailure", str(failure.error), failure.step, failure.solid)
    except MdanimError as error:
        last = Tag.FAILED, Failure(type(error).__name__, str(error))
    except Exception as error:  # whatever it is, the supervisor must be told
        if isinstance(error, MPI.Exception):  # where another rank has died, mpiexec ends this one now, and tells the better cause
            time.sleep(ABORT_SECONDS)
        traceback.print_exc()
        last = Tag.FAILED, Failure("ExecutorLost", f"executor {comm.rank}: {type(error).__name__}: {error}")
    mail.world.send(last[1], SUPERVISOR, last[0])
    return False


class Executor:
    """Its objects, their states at the last frame, and the LAMMPS instances that run them."""

    def __init__(self, mail: Mail, comm: MPI.Comm, job: Job):
        self.mail, self.comm, self.job = mail, comm, job
        self.me = comm.rank
        self.parts = SubPlans(job.plan)
        self.system, resume = job.plan.system, job.resume
        self.objects = len(self.system.names)
        self.rows, self.observer = RowWriter(job.rows), Observer(job.plan, job.models)
        self.still = self._share_of_still()
        """Objects that never move of which this executor writes the rows."""
        self.frame = resume.frame if resume else 0
        self.step = resume.step if resume else 0
        # Positions of all particles, right for those of its own objects; particles that a team runs are shared out among its
        # members.
        self.x = np.array(resume.x if resume else self.system.position)
        self.v = np.array(resume.v if resume else self.system.velocity)
        self.f = np.array(resume.f) if resume else np.zeros_like(self.x)
        self.records: Records = resume.records if resume else {}
        """Values that fixes keep, as records that travel with its own objects."""
        self.started = resume is not None
        """False before step 0: forces come from the scene then."""
        self.control: Controller = make_control(job, self.parts, mail, comm)
        self.bundles: list[Bundle] = []
        self.order: Order | None = None
        """The order that it follows."""
        self.next: Order | None = None
        """The order for the next window."""
        self.teams = TeamCommunicators(comm)
        self.account = Account()
        self.told = 0.0
        """When it last told of its account, as ``time.perf_counter()``; 0 until it first waits for leave to simulate: what came
        before is not part of the account."""
        self.moves = self.retries = 0
        self.led: set[tuple[int, ...]] = set()
        """Teams that it has led since the frame before."""
        self.energies: Counter = Counter()
        """Energies of its objects at the last frame; losses [J] are those since the frame before."""
        self.deepest = 0.0
        self.spans: list[tuple[str, int, float, float]] = []
        mail.wait(comm.Ibarrier().Test)
        self.origin, self.cpu_origin = time.perf_counter(), time.process_time()

    # --- the order of things --------------------------------------------------------------------------------------

    def work(self) -> None:
        """All frames. Raises LammpsFailure, MdanimError, Aborted; then its instances are left as they are, because other members
        of a team may never come to close theirs."""
        self._follow(self._decide(self._first_report()))
        if not self.started:
            self._commit()
            self._weigh()
            self._send(keep=True)
        while self.frame < len(self.job.lengths):
            with self._span("held"):
                grant = self.mail.take(Tag.GRANT)
            if grant is None:  # an end
                self._keep()
                break
            self._simulate(self.step + self.job.lengths[self.frame])
            self._send(grant.keep)
        for bundle in self.bundles:
            self._close(bundle)
        self.teams.close()
        self.rows.close()
        self.mail.send(SUPERVISOR, Tag.ENDED, Ended(self.account, self.spans, time.process_time() - self.cpu_origin))
        self.mail.flush()

    def _simulate(self, end: int) -> None:
        """Window by window to the step of the next frame."""
        self.retries = 0
        while self.step < end:
            if self.next is not None:
                self._follow(self.next)
            self.next = self._window(self.order.steps)
            self._commit()
        self._weigh()
        self.frame += 1

    def _window(self, steps: int) -> Order:
        """Simulate a window, again until no object has left its reserved box; returns what to do from there on."""
        again = False
        for bundle in self.bundles:
            bundle.ran = False
        while True:
            for bundle in self.bundles:
                if not bundle.ran:
                    with self._span("simulating"):
                        bundle.run(steps)
            # An executor that has nothing to do again is frozen at the end of the window until the others have come there too.
            order = self._decide(self._report(steps), "frozen" if again else "waiting")
            if order.commit:
                self.step += steps
                return order
            again = True
            self.retries += 1
            self._follow(order, again=True)

    def _decide(self, report: Report, while_waiting: str = "waiting") -> Order:
        with self._span(while_waiting):
            return self.control.decide(report)

    # --- objects --------------------------------------------------------------------------------------------------

    def _follow(self, order: Order, again: bool = False) -> None:
        """Hand on what goes elsewhere, and have the instances that are wanted; ``again``: bundles that have run the window stay
        at its end if they are to be what they were, for again they would do the same."""
        before, self.order = self.order, order
        with self._span("moving"):
            wanted = wanted_bundles(order.plan, self.objects, self.me, bool(self.job.settings.by_threads))
            live = self._staying(wanted)
            for bundle in self.bundles:
                if bundle not in live.values():
                    bundle.share_state(self.x, self.v, self.f)
                    self._close(bundle)
            self.teams.follow([team.members for team in order.plan.teams])
            if before is None:
                self.records = self._records_of(np.flatnonzero(order.plan.owner == self.me))
            else:
                self._transfer(before.plan.owner, order.plan.owner)
            self.bundles = [self._go_on(live[w.number], w, again) if w.number in live else self._begin(w) for w in wanted]

    def _staying(self, wanted: list[Wanted]) -> dict[int, Bundle]:
        """Bundles that can be some that are wanted, by the numbers of these."""
        same = {b.key: b for b in self.bundles}
        found = {w.number: same[w.key] for w in wanted if w.key in same}
        numbered = {b.number: b for b in self.bundles if b not in found.values()}
        for w in wanted:
            if w.number not in found and w.number in numbered and numbered[w.number].can_be(w):
                found[w.number] = numbered[w.number]
        return found

    def _go_on(self, bundle: Bundle, wanted: Wanted, again: bool) -> Bundle:
        """A bundle that stays, without the objects that it has to lay aside; ``again`` as in `_follow`: one that changes goes
        back to the window's beginning."""
        back = again and bundle.key != wanted.key
        bundle.drop_objects(wanted)
        if back:
            self._start(bundle, self.records)
        return bundle

    def _transfer(self, before: np.ndarray, after: np.ndarray) -> None:
        """Send what is another's now, and receive what has become mine."""
        changed = np.flatnonzero((before != after) & (before >= 0))
        for other in range(self.comm.size):
            goes = changed[(before[changed] == self.me) & (after[changed] == other)]
            if len(goes):
                self.mail.send(other, Tag.OBJECTS, self._pack(goes), self.comm)
        self.records = self._records_of(np.flatnonzero(after == self.me))
        for other in range(self.comm.size):
            comes = changed[(before[changed] == other) & (after[changed] == self.me)]
            if len(comes):
                self._unpack(comes, self.mail.take(Tag.OBJECTS, other, self.comm))
                self.moves += len(comes)

    def _places(self, objects: np.ndarray) -> list[slice]:
        """Particles of objects, where the liquid counts as one without any."""
        return self.system.stretches(objects[objects < self.objects])

    def _pack(self, objects: np.ndarray) -> Moved:
        return Moved(*gathered(self._places(objects), self.x, self.v, self.f), self._records_of(objects))

    def _records_of(self, objects: np.ndarray) -> dict[str, StateRecords]:
        """Records that travel with such objects."""
        return {fix: found.where(np.isin(found.home(self.system.still), objects)) for fix, found in self.records.items()}

    def _unpack(self, objects: np.ndarray, moved: Moved) -> None:
        scatter(self._places(objects), (self.x, moved.x), (self.v, moved.v), (self.f, moved.f))
        self.records = join_all([self.records, moved.records])

    def _begin(self, wanted: Wanted) -> Bundle:
        """A bundle with the state of the last frame; on a team, that of its leader."""
        key, records = wanted.key, self.records
        if len(key.ranks) > 1 and self.started:
            everything = np.array([*key.objects, *([self.objects] if key.grid else [])])
            if self.me == key.ranks[0]:
                for member in key.ranks[1:]:
                    self.mail.send(member, Tag.TEAM, self._pack(everything), self.comm)
            else:  # the leader's objects stay the leader's, and their records with them
                moved = self.mail.take(Tag.TEAM, key.ranks[0], self.comm)
                scatter(self._places(everything), (self.x, moved.x), (self.v, moved.v), (self.f, moved.f))
                records = moved.records
        bundle = Bundle(self.parts, wanted, self.teams.of(key.ranks))
        self._start(bundle, records)
        return bundle

    def _start(self, bundle: Bundle, records: Records) -> None:
        """Give a bundle the state of the last frame."""
        x_v_f = gathered(bundle.places, self.x, self.v, self.f)
        bundle.start(self.step, State(*x_v_f, bundle.records_from(records)) if self.started else None)

    def _close(self, bundle: Bundle) -> None:
        add_clocks(self.account, bundle.instance)
        bundle.instance.close()

    def _leads(self, bundle: Bundle) -> bool:
        return bundle.key.team[0] == self.me

    @property
    def own(self) -> np.ndarray:
        """Objects that are its own and can move, ascending."""
        mine = self.order.plan.owner[: self.objects] == self.me
        return np.flatnonzero(mine & (self.order.plan.label[: self.objects] >= 0))

    # --- reports --------------------------------------------------------------------------------------------------

    def _first_report(self) -> Report:
        """The first report, on all objects that can move, in equal shares: every executor knows where objects begin."""
        mine = np.flatnonzero(~self.system.still)[self.me :: self.comm.size]
        low, high = self.system.bounds(self.x)
        return Report(mine, low[mine], high[mine], self.system.top_speed(self.v)[mine], np.zeros(len(mine), np.int64))

    def _report(self, steps: int) -> Report:
        """The report on all objects that it has run."""
        scale = 1e6 * self.job.plan.certificate.steps_per_frame / steps
        found, escaped, grid_cost = [], [], None
        for bundle in self.bundles:
            extent = bundle.extent()  # together with the team
            if not self._leads(bundle):
                continue
            escaped += bundle.escaped(self.order.low, self.order.high)
            found.append((bundle.members, *extent, bundle.costs(scale)))
            if bundle.key.grid:
                grid_cost = int(scale * len(bundle.key.ranks) * bundle.grid_seconds)
        empty = (np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int64))
        return Report(
            *(np.concatenate(arrays) for arrays in zip(empty, *found)), grid_cost, tuple(escaped), self.order.plan.fingerprint()
        )

    def _commit(self) -> None:
        """Take the states of all instances, and what was lost and how deep something was meanwhile."""
        records = []
        for bundle in self.bundles:
            instance, lost = bundle.instance, bundle.newly_lost()
            depth = penetration(instance)
            kept = instance.records()  # together with the team, as all above
            bundle.write_state(x=self.x, v=self.v, f=self.f)
            if not self._leads(bundle):
                continue
            self.deepest = max(self.deepest, depth)
            if len(bundle.key.team) > 1:
                self.led.add(bundle.key.team)
            self.energies.update(lost)
            self.records = bundle.records_elsewhere(self.records)
            records.append(bundle.records_to(kept))
        self.records = join_all([self.records, *records])
        self.started = True

    def _weigh(self) -> None:
        """Energies and fields of a frame."""
        declared = frame_fields(self.job.plan)
        told: list[tuple[np.ndarray, Fields]] = []
        for bundle in self.bundles:
            energies, fields = stored(bundle.instance), tell(bundle.instance)  # together with the team
            if self._leads(bundle):
                self.energies.update(energies)
                # Another bundle has the values of guests and of objects that this one has laid aside.
                own = part_of_fields(declared, fields, bundle.plan.rows, bundle.objects, bundle.moves)
                told.append((bundle.members, own))
        self.fields = whole_fields(self.job.plan, told)

    def _own_fields(self) -> Fields:
        """Values of its own objects."""
        plan, objects = self.job.plan, np.arange(self.objects)
        return part_of_fields(frame_fields(plan), self.fields, plan.rows, objects, np.isin(objects, self.own))

    def _share_of_still(self) -> np.ndarray:
        """Some of the objects that never move: all executors have about as many particles of such, and each object is one's."""
        still = np.flatnonzero(self.system.still)
        size = np.diff(self.system.first)[still]
        middle = np.cumsum(size) - 0.5 * size
        return still[(middle * self.comm.size / max(1, size.sum())).astype(np.int64) == self.me]

    def _send(self, keep: bool) -> None:
        """Write its rows of a frame, and send its share."""
        with self._clock("guard"):
            for bundle in self.bundles:
                bundle.gather_state(self.x, self.v)
            objects = np.union1d(self.own, self.still)
            guests = [bundle.objects[self.system.still[bundle.objects]] for bundle in self.bundles if self._leads(bundle)]
            near = np.unique(np.concatenate([objects, *guests]))
            seen = self.observer.observe(objects, near, self.x, self.v, self.fields)
        with self._clock("output"):
            places = [*self._held(), *self.system.stretches(self.still)]
            checksums = self.rows.write(self.frame, places, self.x, self.v)
        self.mail.send(
            SUPERVISOR,
            Tag.FRAME,
            Share(
                self.frame,
                self.own,
                seen,
                checksums,
                dict(self.energies),
                self.deepest,
                self._own_fields(),
                self.moves,
                self.retries,
                tuple(sorted(self.led)),
                self._account_so_far(),
            ),
        )
        self.moves, self.energies = 0, Counter()
        self.led.clear()
        if keep:
            self._keep()

    def _account_so_far(self) -> Account | None:
        """With what its live instances have taken; None where it has told not long ago, and while it is in a team."""
        now = time.perf_counter()
        # The clocks of a team are read by all its members together, which are not here at the same time.
        if not 0.0 < self.told < now - COST_SECONDS or any(bundle.comm is not None for bundle in self.bundles):
            return None
        so_far, self.told = Account(), now
        so_far.add_all(self.account)
        for bundle in self.bundles:
            add_clocks(so_far, bundle.instance)
        return so_far

    def _keep(self) -> None:
        """Make its rows durable, and send what a checkpoint needs."""
        with self._clock("output"):
            self.rows.sync()
        places = self._held()
        self.mail.send(SUPERVISOR, Tag.KEPT, Kept(self.frame, places, *gathered(places, self.x, self.v, self.f), self.records))

    def _held(self) -> list[slice]:
        """Particles of which it has the state of the last frame, where they are among all."""
        return [there for bundle in self.bundles for _, there in bundle.stretches]

    def _clock(self, kind: str):
        """Counts a ``with`` block as such work, if the account has begun."""
        return self.account.clock(kind) if self.told else nullcontext()

    @contextmanager
    def _span(self, kind: str):
        """Take note of what it does from when to when."""
        begin = time.perf_counter()
        if kind == "held" and not self.told:
            self.told = begin
        yield
        end = time.perf_counter()
        self.spans.append((kind, self.frame + 1, begin - self.origin, end - self.origin))
        if kind != "simulating" and self.told:
            self.account.other[kind] = self.account.other.get(kind, 0.0) + end - begin
