# SPDX-License-Identifier: GPL-2.0-only
"""A run: frames of a plan, one after the other, wherever they come from, and what they leave behind."""

from __future__ import annotations

import hashlib
import shlex
import shutil
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from .. import __version__
from ..effects.measured import Measured
from ..effects.readings import LEAPFROG
from ..engine.columns import wide_columns
from ..engine.commands import input_script, table_file
from ..engine.data_file import write_bodies, write_data, write_wide_columns
from ..errors import ExitCode, MdanimError, OutputError
from ..interrupts import Interrupts
from ..records import dataclass
from ..results.checkpoint import Checkpoint
from ..results.cost import Cost, CostShare
from ..results.expect import Outcome, evaluate
from ..results.files import CHECKPOINT, HANDS, PAUSE, RECORDS, STOP, SUMMARY, disk_errors, write_json, write_whole
from ..results.ledger import Ledger
from ..results.progress import ProgressLog
from ..results.quantities import recorded
from ..results.records import Records
from ..results.trajectory import Trajectory
from ..results.trajectory_writer import TrajectoryWriter
from ..scene.formatting import number
from ..scene.meshes import mesh_files
from .energy import (
    extra_fields,
    frame_fields,
    least_energy,
    ledger_terms,
    loss_terms,
    potential_terms,
    source_terms,
    start_fields,
)
from .frame_source import COST_SECONDS, Account, Frame, FrameSource, LammpsFailure, Sequential, clock
from .guard import Guard
from .hands import PageHands
from .prepare import Prepared
from .result import Result

CHECKPOINT_SECONDS = 10.0
"""Wall time between checkpoints: a killed run loses at most this much, and a fast one does not write all the time."""
NAP = 0.01
"""How long a paused run sleeps before it looks again whether to go on [s]."""


@dataclass
class Progress:
    """Where a run is; handed to the watcher after every frame."""

    frame: int
    frames: int
    step: int
    steps: int
    time: float
    """Simulated [s]."""
    residual: float
    seconds: float
    """Wall time of the simulation so far."""
    first_step: int = 0
    """Step from which these seconds count: not 0 after a resume."""
    gained: float | None = None
    """Excess of what an effect counts, such as cells of liquid more than at the start; None where nothing is counted."""
    counted: str = ""
    """Name of that in the line of a run."""
    paused: str = ""
    """The file that holds a paused run: it goes on when this is deleted. Empty while the run goes on."""


class Interrupted(MdanimError):
    """Ctrl-C, or the file ``stop``: the frame was finished and a checkpoint written."""

    exit_code = ExitCode.INTERRUPTED
    cost: Cost | None = None
    """Cost of the frames that were run; None where it is unknown."""


def write_inputs(ready: Prepared, folder: Path) -> None:
    """Write scene.lock.txt, copies of its meshes, certificate.json, ``data.NAME``, ``in.NAME`` and, where surfaces touch,
    ``contact.NAME``; tables of effects are ``table.TABLE.NAME``. Raises OutputError."""
    plan = ready.plan
    _write_meshes(ready, folder)
    write_whole(folder / "scene.lock.txt", ready.lock)
    write_json(folder / "certificate.json", ready.certificate.to_json())
    write_whole(folder / f"data.{plan.name}", lambda part: write_data(plan, part))
    if plan.body_fixes:
        write_whole(folder / f"contact.{plan.name}", lambda part: write_bodies(plan, part))
    if wide_columns(plan):
        write_whole(folder / f"columns.{plan.name}", lambda part: write_wide_columns(plan, part))
    for name, text in plan.tables.items():
        write_whole(folder / table_file(plan, name), text)
    write_whole(folder / f"in.{plan.name}", input_script(plan))


def _write_meshes(ready: Prepared, folder: Path) -> None:
    """Copy the meshes of a scene into a folder, by the names that its lock has for them; names tell contents, so what is there
    is right. Raises OutputError."""
    for path, name in mesh_files(ready.scene).items():
        if not (folder / name).exists():
            with disk_errors(folder / name):
                (folder / name).parent.mkdir(exist_ok=True)
            write_whole(folder / name, lambda part, path=path: shutil.copyfile(path, part))


def simulate(
    ready: Prepared,
    folder: Path,
    *,
    on_progress: Callable[[Progress], None] | None = None,
    resume: Checkpoint | None = None,
    started: float | None = None,
    source: FrameSource | None = None,
    hands: bool = False,
) -> Result:
    """Run all frames (or go on from a checkpoint), leaving trajectory.h5, ledger.csv, checkpoint and summary.json in ``folder``.

    ``started`` is what ``time.perf_counter()`` gave when the work for this run began, so that loading and modelling are in its
    cost; None is now. ``source`` gives the frames; None is one LAMMPS instance in this process. Raises DivergedError with the
    last good frame kept, Interrupted after Ctrl-C or when a file ``stop`` appears in the folder,
    OutputError when the disk is full. While a file ``pause`` is in the folder no frame is begun. With ``hands`` a page may pull
    at objects: the run begins paused, and is no faster than the film.
    """
    source = source or Sequential(ready.plan, ready.models)
    run = _Run(ready, folder, resume, time.perf_counter() if started is None else started, source)
    if hands or (resume and (folder / HANDS).exists()):
        run.hands = PageHands(ready, folder, source, hands)
    return run.go(on_progress or (lambda progress: None))


def write_start(ready: Prepared, folder: Path) -> Path:
    """Write a trajectory of the first frame alone, before any step; returns its file. Raises OutputError."""
    with trajectory_writer(ready, folder, frames=1) as out:
        if ready.plan.grid is None:
            # As the system says; LAMMPS, which takes a quarter of a second to start, is asked for a liquid alone.
            out.write(0, 0.0, ready.system.position, ready.system.velocity, start_fields(ready.plan))
        else:
            with Sequential(ready.plan, ready.models) as source:
                _add(out, source.begin(None, out.rows), 0.0)
        out.flush()
        return out.close()


def trajectory_writer(ready: Prepared, folder: Path, frames: int) -> TrajectoryWriter:
    """A new trajectory in a folder, with the meshes that its scene is read with. Raises OutputError."""
    _write_meshes(ready, folder)
    return TrajectoryWriter(
        folder / "trajectory.h5",
        ready.scene,
        ready.models,
        frames=frames,
        dt=ready.certificate.timestep,
        steps_per_frame=ready.certificate.steps_per_frame,
        scene_text=ready.lock,
        grid=ready.plan.grid,
        fields=frame_fields(ready.plan),
    )


def _add(out: TrajectoryWriter, now: Frame, when: float) -> None:
    """Add a frame at a time [s]. Raises OutputError."""
    out.add(now.step, when, now.checksums, now.seen.center, now.seen.center_velocity, now.fields)


def run_id(ready: Prepared) -> str:
    """A word that is the same only for the same scene, models, time step and version of this program."""
    digest = hashlib.sha256(ready.lock.encode())
    digest.update(repr((__version__, ready.certificate.timestep, ready.system.particles)).encode())
    for array in (ready.system.mass, ready.system.stiffness):
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()


class _Run:
    """The state of one run; only its methods know the order of things."""

    def __init__(self, ready: Prepared, folder: Path, resume: Checkpoint | None, started: float, source: FrameSource):
        self.ready, self.folder, self.resume, self.source = ready, folder, resume, source
        self.certificate = ready.certificate
        self.effects = ready.plan.effects
        self.started = started
        self.hands: PageHands | None = None
        self.guard = Guard(ready, folder)
        self.seconds = {"setup": 0.0, "simulation": 0.0, "output": 0.0}
        self.carried = dict(resume.carried) if resume else {}
        if "seconds" in self.carried:
            self.seconds["before the resume"] = self.carried.pop("seconds")
        self.penetration = self.carried.pop("penetration", 0.0)
        """Deepest that a boundary particle has been below a surface so far, before a resume too [m]."""
        self.first_step = resume.step if resume else 0
        self.run_id = run_id(ready)
        if resume and resume.run != self.run_id:
            raise OutputError(
                f"{folder / CHECKPOINT} is of another run: scene, time step or program have changed since; "
                "run the scene again with --force"
            )
        c = self.certificate
        if resume and not (
            0 <= resume.frame <= c.last_frame
            and resume.step == min(resume.frame * c.steps_per_frame, c.steps)
            and len(resume.x) == ready.system.particles
            and all(((r.keys >= 0) & (r.keys <= len(ready.system.names))).all() for r in resume.records.values())
        ):
            raise OutputError(f"{folder / CHECKPOINT} is damaged; run the scene again with --force")
        self.extras = extra_fields(ready.plan)
        self.ledger = Ledger(
            ledger_terms(ready.plan),
            (*recorded(ready.scene.asked), *(field.name for field in self.extras)),
            least_energy(ready.scene, ready.system),
            potential_terms(ready.plan),
            tuple(field.name for field in self.extras if field.whole),
            source_terms(ready.plan),
        )

    # --- the order of things ----------------------------------------------------------------------------------------

    def go(self, on_progress: Callable[[Progress], None]) -> Result:
        ledger, resumed = self.ledger, self.resume.frame if self.resume else None
        energies, frames = len(ledger.terms), self.certificate.last_frame + 1
        with disk_errors(self.folder):
            (self.folder / PAUSE).unlink(missing_ok=True)  # of a run that was killed while it was paused
        with ProgressLog(
            self.folder,
            columns=ledger.columns,
            energies=energies,
            frames=frames,
            executors=self.source.executors,
            resumed=resumed,
        ) as log:
            try:
                account = self._frames(on_progress, log)
            except (MdanimError, KeyboardInterrupt):
                with suppress(Exception), Trajectory(self.folder) as trajectory:  # why the run has ended is what is told
                    self._write_records(self._measured(trajectory.renewed(len(self.ledger.rows))))
                raise
            return self._finish(account)

    def _frames(self, on_progress: Callable[[Progress], None], log: ProgressLog) -> Account:
        c = self.certificate
        lengths = c.lengths
        frame, last = self.resume.frame if self.resume else 0, len(lengths)
        with self.source, _Stop(self.folder) as stop, self._open_trajectory() as out:
            now = self.source.begin(self.resume, out.rows)
            if self.resume:
                self._reread_ledger(frame)
            else:
                self._record(out, log, frame, now)
            if self.hands:
                self.hands.begin(self.resume.step if self.resume else None, self.carried)
            self.seconds["setup"] = time.perf_counter() - self.started
            if now:
                with self._clock("output"):
                    self._save(out, 0, now)
            saved = told = time.perf_counter()
            try:
                while frame < last:
                    if (self.folder / PAUSE).exists():
                        if now and now.kept:
                            self._save(out, frame, now)
                        self._pause(stop, log, lambda at=frame: on_progress(self._progress(at)))
                    frame += 1
                    if self.hands:
                        with self._clock("paused"):
                            self.hands.frame((frame - 1) * c.steps_per_frame, min(frame * c.steps_per_frame, c.steps))
                    with self._clock("simulation"):
                        now = self._advance(frame, lengths[frame - 1])
                    with self._clock("guard"):
                        self.guard.check(now.step, now.seen)
                    with self._clock("output"):
                        self._record(out, log, frame, now)
                        on_progress(self._progress(frame))
                        if stop.is_set():
                            last = self.source.stop(frame)
                        if now.kept and (frame == last or time.perf_counter() - saved > CHECKPOINT_SECONDS):
                            self._save(out, frame, now)
                            saved = time.perf_counter()
                        if time.perf_counter() - told > COST_SECONDS and (so_far := self.source.account_so_far()):
                            log.cost(self._cost(so_far).parts)
                            told = time.perf_counter()
            except BaseException as error:
                self._write_ledger()  # without an error the last frame has done so
                if isinstance(error, KeyboardInterrupt):
                    raise Interrupted(f"interrupted within a frame; {self._way_on()}") from None
                raise
            if last < len(lengths):
                when = self.ledger.rows[-1]["time"]
                stopped = Interrupted(f"interrupted at t = {number(when, 4)} s; {self._way_on()}")
                stopped.cost = self._cost(self.source.account())
                raise stopped
            account = self.source.account()
            closing = time.perf_counter()
        self.seconds["output"] += time.perf_counter() - closing
        return account

    def _way_on(self) -> str:
        """How to go on after an interruption."""
        if not (self.folder / CHECKPOINT).exists():
            return "nothing was kept yet; run it again"
        insist = " --allow-unstable" if self.certificate.fraction > 1.0 else ""
        folder = shlex.quote(str(self.folder))
        return f"go on with: mdanim-lammps resume {folder}{insist}\n  draw what is there with: mdanim-lammps render {folder}"

    def _progress(self, frame: int) -> Progress:
        c, row = self.certificate, self.ledger.rows[-1]
        step = min(frame * c.steps_per_frame, c.steps)
        seconds, paused = self.seconds["simulation"], self.folder / PAUSE
        return Progress(
            frame,
            c.last_frame,
            step,
            c.steps,
            row["time"],
            row["residual"],
            seconds,
            self.first_step,
            *self._gained(),
            str(paused) if paused.exists() else "",
        )

    def _pause(self, stop: _Stop, log: ProgressLog, on_pause: Callable[[], None]) -> None:
        """Sleep until the file ``pause`` is gone, or a stop is asked for."""
        log.state("paused")
        on_pause()
        with self._clock("paused"):
            while (self.folder / PAUSE).exists() and not stop.is_set():
                time.sleep(NAP)
        log.state("running")

    def _advance(self, frame: int, steps: int) -> Frame:
        try:
            return self.source.advance(frame, steps)
        except LammpsFailure as failure:
            raise self.guard.explain_failure(failure.step, failure.error, failure.solid) from failure

    def _finish(self, account: Account) -> Result:
        with self._clock("output"), Trajectory(self.folder) as trajectory:
            measured = self._measured(trajectory)
            outcomes = evaluate(self.ready.scene.expects, measured)
            self._write_records(measured)
            doubts = [p for e in self.effects for p in e.doubts(self.ready.context, measured)]
        cost = self._cost(account)
        write_json(self.folder / "cost.json", cost.to_json())
        write_json(self.folder / SUMMARY, self._summary(outcomes))
        return Result(self.folder, self.ledger, outcomes, cost, [*self.guard.warnings(self.ledger), *doubts])

    def _summary(self, outcomes: list[Outcome]) -> dict:
        scene, c = self.ready.scene, self.certificate
        return {
            "title": scene.title,
            "scene": scene.name,
            "done": True,
            "objects": len(self.ready.system.names),
            "particles": self.ready.system.particles,
            "springs": len(self.ready.system.spring),
            "time": c.steps * c.timestep,
            "timestep": c.timestep,
            "steps": c.steps,
            "frames": len(self.ledger.rows),
            "effects": [e.name for e in self.effects],
            "energy_residual": self.ledger.residual,
            "penetration": self.penetration,
            "inverted_cells": self.guard.most_inverted,
            "dents": {self.ready.system.names[m]: cells for m, cells in self.guard.dents.items()},
            **{word: value for e in self.effects for word, value in e.summary(self.ledger.rows[0], self.ledger.rows[-1]).items()},
            "seconds": sum(self.seconds.values()),
            "expect": [outcome.to_json() for outcome in outcomes],
        }

    def _measured(self, trajectory: Trajectory) -> Measured:
        names, grid, ledger = tuple(self.ready.system.names), self.ready.plan.grid, self.ledger
        found = trajectory.times, trajectory.centers, trajectory.center_velocities
        return Measured(
            self.ready.scene, names, grid, *found, self.penetration, ledger.array, trajectory, ledger.columns.__contains__
        )

    # --- recording --------------------------------------------------------------------------------------------------

    def _open_trajectory(self) -> TrajectoryWriter:
        if not self.resume:
            return trajectory_writer(self.ready, self.folder, frames=self.certificate.last_frame + 1)
        path = self.folder / "trajectory.h5"
        return TrajectoryWriter.append(
            path, self.ready.scene, self.ready.models, after_step=self.resume.step, grid=self.ready.plan.grid
        )

    def _record(self, out: TrajectoryWriter, log: ProgressLog, frame: int, now: Frame) -> None:
        """Check the energies, then append the frame to ledger and trajectory, and tell of it. Raises DivergedError before a bad
        frame counts."""
        when = now.step * self.certificate.timestep
        extras = now.seen.recorded | {field.name: now.fields[field.name] for field in self.extras}
        if self.ledger.rows:  # instances that have ended took what they had seen with them
            before = self.ledger.rows[-1]
            extras |= {field.name: max(before[field.name], extras[field.name]) for field in self.extras if field.largest}
        self.guard.fields(now.step, now.fields)
        # Losses before a resume are carried over.
        row = self.ledger.weigh(when, {t: e + self.carried.get(t, 0.0) for t, e in now.energies.items()} | extras)
        self.guard.energy(now.step, row["residual"], now.seen.speed)
        self.ledger.rows.append(row)
        self.penetration = max(self.penetration, now.penetration)
        _add(out, now, when)
        log.frame(frame, row, self.seconds["simulation"], self.source.new_owners())

    def _gained(self) -> tuple[float | None, str]:
        """Excess of the quantities that effects count, 0, or something is wrong; and its name."""
        rows = self.ledger.rows
        found = ((e.gained(rows[0], rows[-1]), e.gains) for e in self.effects)
        return next((of for of in found if of[0] is not None), (None, ""))

    def _save(self, out: TrajectoryWriter, frame: int, now: Frame) -> None:
        """Make everything up to this frame safe; the checkpoint last, so that it never is ahead of the trajectory."""
        out.flush()
        self._write_ledger()
        carried = {t: self.ledger.rows[-1][t] for t in loss_terms(self.ready.plan)}
        carried["penetration"] = self.penetration
        carried["seconds"] = sum(self.seconds.values())
        if self.hands:
            carried |= self.hands.kept()
        s = self.source.state()
        rows = self.ledger.checksum(frame + 1)
        Checkpoint(now.step, frame, s.x, s.v, s.f, carried, self.run_id, rows, s.records).write(self.folder / CHECKPOINT)

    def _reread_ledger(self, frame: int) -> None:
        """Take the rows up to the checkpoint's frame. Raises OutputError when they are not those that were there then."""
        path = self.folder / "ledger.csv"
        stored = Ledger.read(path, most=frame + 1)
        if stored.columns != self.ledger.columns or stored.checksum(frame + 1) != self.resume.ledger:
            raise OutputError(
                f"{path} is damaged: its first {frame + 1} rows are not those of the checkpoint; run the scene again with --force"
            )
        for row in stored.rows[: frame + 1]:
            self.ledger.add(row["time"], row)

    def _write_records(self, measured: Measured) -> None:
        if asked := self.ready.scene.records:
            write_whole(self.folder / RECORDS, Records.of(asked, measured).write)

    def _write_ledger(self) -> None:
        write_whole(self.folder / "ledger.csv", self.ledger.write)

    # --- time and signals -------------------------------------------------------------------------------------------

    def _clock(self, what: str):
        return clock(self.seconds, what)

    def _cost(self, account: Account) -> Cost:
        """The account of the run so far."""
        parts = {}
        for effect in self.effects:
            span, clocks = self.ready.verdicts[effect.name].span, account.effects.get(effect.name, {})
            parts[effect.name] = CostShare(sum(clocks.values()), str(span) if span else None, clocks if len(clocks) > 1 else {})
        known = sum(p.seconds for p in parts.values()) + account.leapfrog + sum(account.other.values())
        other = {name: s for name, s in self.seconds.items() if name != "simulation"}
        other |= {kind: s for kind, s in account.other.items() if kind not in other}
        if "held" in other and "paused" in other:  # executors of a paused run are held
            other["held"] = max(0.0, other["held"] - other["paused"])
            known -= account.other["held"] - other["held"]
        beside = max(0.0, known - self.seconds["simulation"])
        for name in ("output", "guard"):  # what executors did meanwhile is theirs: of this process what the run has waited for
            mine = self.seconds.get(name, 0.0)
            spared = min(beside, mine)
            other[name], beside = mine - spared + account.other.get(name, 0.0), beside - spared
        return Cost(
            wall=time.perf_counter() - self.started + other.get("before the resume", 0.0),
            steps=self.certificate.steps,
            particles=self.ready.system.particles,
            effects=parts,
            other={LEAPFROG: account.leapfrog, "rest of the step": max(0.0, self.seconds["simulation"] - known), **other},
        )


class _Stop(Interrupts):
    """Whether to stop after the frame: Ctrl-C and SIGTERM ask for it, and a file ``stop`` in the run's folder, also one that was
    there before the first frame: it may have been made while the scene was read. A second signal is a KeyboardInterrupt."""

    def __init__(self, folder: Path):
        super().__init__(lambda: None, _raise_interrupt)
        self.file = folder / STOP

    def is_set(self) -> bool:
        return self.asked or self.file.exists()

    def __exit__(self, *_) -> None:
        self.file.unlink(missing_ok=True)
        super().__exit__()


def _raise_interrupt() -> None:
    raise KeyboardInterrupt
