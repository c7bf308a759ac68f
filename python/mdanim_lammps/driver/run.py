# SPDX-License-Identifier: GPL-2.0-only
"""The sequential program (Wcislo 1999, fig. 11): frames of a plan, one after the other, and what they leave behind."""

from __future__ import annotations

import hashlib
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .. import __version__
from ..effects.air_drag import LEAPFROG
from ..engine.commands import input_script
from ..engine.data_file import write_data
from ..engine.instance import Instance
from ..errors import DivergedError, ExitCode, MdanimError, OutputError, Problem
from ..results.checkpoint import Checkpoint
from ..results.cost import Cost, Part
from ..results.expect import Measured, Outcome, evaluate, record, recorded
from ..results.files import write_json, write_whole
from ..results.ledger import Ledger
from ..results.trajectory import Trajectory, TrajectoryWriter
from .guard import Guard
from .prepare import Prepared

CHECKPOINT_SECONDS = 10.0
"""Wall time between checkpoints: a killed run loses at most this much, and a fast one does not write all the time."""


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
    gained: int | None = None
    """Whole cells of liquid more than at the start; None without a liquid."""


@dataclass
class Result:
    """What a run has left."""

    folder: Path
    ledger: Ledger
    outcomes: list[Outcome] = field(default_factory=list)
    cost: Cost | None = None
    """Seconds per effect and per other piece of work."""
    warnings: list[Problem] = field(default_factory=list)
    """What was seen in the run that does not stop it."""

    @property
    def missed(self) -> list[Outcome]:
        return [o for o in self.outcomes if not o.met]


class Interrupted(MdanimError):
    """Ctrl-C: the frame was finished and a checkpoint written."""

    exit_code = ExitCode.INTERRUPTED


def write_inputs(ready: Prepared, folder: Path) -> None:
    """Write scene.lock.txt, certificate.json, ``data.NAME`` and ``in.NAME``. Raises OutputError."""
    plan = ready.plan
    write_whole(folder / "scene.lock.txt", ready.lock)
    write_json(folder / "certificate.json", ready.certificate.to_json())
    write_whole(folder / f"data.{plan.name}", lambda part: write_data(plan, part))
    write_whole(folder / f"in.{plan.name}", input_script(plan))


def simulate(ready: Prepared, folder: Path, *, watch: Callable[[Progress], None] | None = None,
             resume: Checkpoint | None = None, started: float | None = None) -> Result:
    """Run all frames (or go on from a checkpoint), leaving trajectory.h5, ledger.csv, checkpoint and summary.json in ``folder``.

    ``started`` is what ``time.perf_counter()`` gave when the work for this run began, so that loading and modelling are in its cost;
    None is now. Raises DivergedError with the last good frame kept, Interrupted after Ctrl-C, OutputError when the disk is full.
    """
    run = _Run(ready, folder, resume, time.perf_counter() if started is None else started)
    return run.go(watch or (lambda progress: None))


def run_id(ready: Prepared) -> str:
    """A word that is the same only for the same scene, models, time step and version of this program."""
    digest = hashlib.sha256(ready.lock.encode())
    digest.update(repr((__version__, ready.certificate.timestep, ready.system.particles)).encode())
    for array in (ready.system.mass, ready.system.stiffness):
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()


class _Run:
    """The state of one run; only its methods know the order of things."""

    def __init__(self, ready: Prepared, folder: Path, resume: Checkpoint | None, started: float):
        self.ready, self.folder, self.resume = ready, folder, resume
        self.certificate = ready.certificate
        self.effects = ready.plan.effects
        self.started = started
        self.guard = Guard(ready, folder)
        self.seconds = {"setup": 0.0, "simulation": 0.0, "output": 0.0}
        self.carried = dict(resume.carried) if resume else {}
        if "seconds" in self.carried:
            self.seconds["before the resume"] = self.carried.pop("seconds")
        self.first_step = resume.step if resume else 0
        self.run_id = run_id(ready)
        if resume and resume.run != self.run_id:
            raise OutputError(f"{folder / 'checkpoint'} is of another run: scene, time step or program have changed since; "
                              "run the scene again with --force")
        terms = ("kinetic", *dict.fromkeys(e.ledger for e in self.effects if e.ledger))
        self.recorded = recorded(ready.scene.expects)
        self.grid = ready.plan.grid
        self.ledger = Ledger(terms, (*self.recorded.values(), *(("liquid_cells",) if self.grid else ())))

    # --- the order of things ----------------------------------------------------------------------------------------

    def go(self, watch: Callable[[Progress], None]) -> Result:
        c = self.certificate
        lengths = [c.steps_per_frame] * c.frames + ([c.last_steps] if c.last_steps else [])
        with Instance(self.ready.plan) as self.instance, _Interrupt() as stopped, self._open_trajectory() as out:
            if self.resume:
                self.instance.restore(self.resume.step, self.resume.x, self.resume.v, self.resume.f, self.resume.liquid)
                self._reread_ledger(self.resume.frame)
                frame = self.resume.frame
            else:
                self.instance.setup()
                self.before = self.instance.array("f").copy()
                frame = 0
                self._record(out)
            self.seconds["setup"] = time.perf_counter() - self.started
            with self._clock("output"):
                if not self.resume:
                    self._save(out, 0)
            saved = time.perf_counter()
            saved_frame = frame
            try:
                for frame in range(frame + 1, len(lengths) + 1):
                    with self._clock("simulation"):
                        self._advance(lengths[frame - 1])
                    with self._clock("guard"):
                        self.guard.look(self.instance.step, self.instance.array("x"), self.instance.array("v"))
                    with self._clock("output"):
                        row = self._record(out)
                        if time.perf_counter() - saved > CHECKPOINT_SECONDS or frame == len(lengths) or stopped.is_set():
                            self._save(out, frame)
                            saved, saved_frame = time.perf_counter(), frame
                    with self._clock("output"):
                        watch(Progress(frame, len(lengths), self.instance.step, c.steps, row["time"], row["residual"],
                                       self.seconds["simulation"], self.first_step, self._gained()))
                    if stopped.is_set() and frame < len(lengths):
                        if saved_frame != frame:
                            self._save(out, frame)
                        insist = " --allow-unstable" if c.fraction > 1.0 else ""
                        raise Interrupted(f"interrupted at t = {row['time']:.4g} s; go on with: "
                                          f"mdanim-lammps resume {self.folder}{insist}")
            finally:
                self._close_ledger()
            self.parts, self.leapfrog = self._collect_cost()
            penetration = self._penetration()
            closing = time.perf_counter()
        self.seconds["output"] += time.perf_counter() - closing
        return self._finish(penetration)

    def _advance(self, steps: int) -> None:
        """Run to the next frame and keep the forces of the step before it: how they change tells how stiff the motion is."""
        instance = self.instance
        try:
            if steps > 1:
                instance.run(steps - 1)
            self.before = instance.array("f").copy()
            instance.run(1)
        except DivergedError as error:
            raise self.guard.broke(instance.step, error, instance.array("v")) from error

    def _finish(self, penetration: float) -> Result:
        with self._clock("output"):
            with Trajectory(self.folder) as trajectory:
                liquid = {} if self.grid is None else {
                    "cells": self.ledger.array("liquid_cells"), "cell_volume": self.grid.cell_volume,
                    "level": trajectory.liquid_levels}
                outcomes = evaluate(self.ready.scene.expects, Measured(
                    trajectory.names, trajectory.times, trajectory.centers, trajectory.center_velocities,
                    self.ledger.array("residual"), penetration,
                    {what: self.ledger.array(column) for what, column in self.recorded.items()}, **liquid))
        cost = self._cost()
        write_json(self.folder / "cost.json", cost.to_json())
        write_json(self.folder / "summary.json", self._summary(outcomes, penetration))
        missed = self.guard.missed(self.ledger.residual)
        return Result(self.folder, self.ledger, outcomes, cost, [missed] if missed else [])

    def _summary(self, outcomes: list[Outcome], penetration: float) -> dict:
        scene, c = self.ready.scene, self.certificate
        return {
            "title": scene.title, "scene": scene.name, "done": True,
            "objects": len(self.ready.system.names), "particles": self.ready.system.particles,
            "springs": len(self.ready.system.spring), "time": c.steps * c.timestep, "timestep": c.timestep,
            "steps": c.steps, "frames": len(self.ledger.rows),
            "effects": [e.name for e in self.effects],
            "energy_residual": self.ledger.residual, "penetration": penetration, "inverted_cells": self.guard.most_inverted,
            **({"liquid_cells": int(self.ledger.rows[-1]["liquid_cells"]), "liquid_residual": self._gained()} if self.grid else {}),
            "seconds": sum(self.seconds.values()),
            "expect": [{"what": f"{o.expect.subject}.{o.expect.quantity}", "time": o.expect.time, "value": o.expect.value,
                        "tolerance": o.expect.tolerance, "found": o.found if np.isfinite(o.found) else None, "met": o.met} for o in outcomes],
        }

    # --- recording --------------------------------------------------------------------------------------------------

    def _open_trajectory(self) -> TrajectoryWriter:
        path, c = self.folder / "trajectory.h5", self.certificate
        if self.resume:
            return TrajectoryWriter.append(path, self.ready.scene, self.ready.models, after_step=self.resume.step, grid=self.grid)
        return TrajectoryWriter(path, self.ready.scene, self.ready.models, dt=c.timestep,
                                steps_per_frame=c.steps_per_frame, scene_text=self.ready.lock, grid=self.grid)

    def _record(self, out: TrajectoryWriter) -> dict[str, float]:
        """Check the state, then append it to ledger and trajectory. Raises DivergedError before anything bad is written."""
        instance, system = self.instance, self.ready.system
        step = instance.step
        when = step * self.certificate.timestep
        x, v = instance.array("x"), instance.array("v")
        heights = instance.liquid_heights() if self.grid else None
        extras = {column: record(quantity, system, self.ready.models[system.names.index(name)], x, heights and heights[0])
                  for (name, quantity), column in self.recorded.items()}
        if self.grid:
            extras["liquid_cells"], start = instance.fix_value("liquid", 0), instance.fix_value("liquid", 1)
            if extras["liquid_cells"] != start:
                raise DivergedError(f"step {step}, t = {when:.4g} s: {extras['liquid_cells']:.0f} cells of liquid, {start:.0f} at the "
                                    f"start: this must never be, please report it. The last good frame is kept in {self.folder}")
        row = self.ledger.add(when, self._energies(v) | extras)
        try:
            self.guard.energy(step, row["residual"], v)
        except DivergedError:
            del self.ledger.rows[-1]
            raise
        out.write(step, when, x, v, heights)
        return row

    def _energies(self, v: np.ndarray) -> dict[str, float]:
        """Energy of every term of the ledger [J]."""
        system, instance, scene = self.ready.system, self.instance, self.ready.scene
        energies = dict.fromkeys(self.ledger.terms, 0.0)
        energies["kinetic"] = self._kinetic(v)
        for effect in self.effects:
            if effect.ledger:
                energies[effect.ledger] += effect.energy(instance, scene, system)
        for term in energies:
            energies[term] += self.carried.get(term, 0.0)  # losses before a resume
        return energies

    def _kinetic(self, v: np.ndarray) -> float:
        """Kinetic energy [J], corrected so that the sum of all energies is what leap-frog conserves, to fourth order in dt.

        That is T + U + dt^2 (v.U''.v / 12 - F.F / 24 m), the energy of the nearby system whose exact motion the steps are (Hairer,
        Lubich & Wanner, Geometric Numerical Integration, IX.3); without it a vibration of frequency w seems to hold
        (w dt)^2/24 too little, and an impact to lose what goes into vibrations.
        """
        mass, dt, f = self.ready.system.mass, self.certificate.timestep, self.instance.array("f")
        half = v - 0.5 * dt * f / mass[:, None]  # v(n-1/2)
        bent = -dt * np.einsum("id,id->i", half, f - self.before) / 12.0
        swung = dt**2 * np.einsum("id,id->i", f, f) / (24.0 * mass)
        free = ~self.ready.system.held
        return float((0.5 * mass * np.einsum("id,id->i", v, v) + bent - swung)[free].sum())

    def _gained(self) -> int | None:
        """Whole cells of liquid more than at the start: 0, or something is wrong; None without a liquid."""
        rows = self.ledger.rows
        return int(rows[-1]["liquid_cells"] - rows[0]["liquid_cells"]) if self.grid else None

    def _penetration(self) -> float:
        """Deepest that a boundary particle has been below a surface in this run [m]."""
        depths = [e.penetration(self.instance, self.ready.system) for e in self.effects]
        return max([self.carried.get("penetration", 0.0), *depths])

    def _save(self, out: TrajectoryWriter, frame: int) -> None:
        """Make everything up to this frame safe; the checkpoint last, so that it never is ahead of the trajectory."""
        out.flush()
        self._close_ledger()
        carried = {t: self.ledger.rows[-1][t] for t in self.ledger.terms if t.endswith("_loss")}
        carried["penetration"] = self._penetration()
        carried["seconds"] = sum(self.seconds.values())
        liquid = self.instance.liquid_state() if self.grid else None
        Checkpoint(self.instance.step, frame, *(self.instance.array(a) for a in "xvf"), carried, self.run_id, liquid).write(
            self.folder / "checkpoint")

    def _reread_ledger(self, frame: int) -> None:
        """Take the rows up to the checkpoint's frame."""
        stored = Ledger.read(self.folder / "ledger.csv")
        for row in stored.rows[: frame + 1]:
            self.ledger.add(row["time"], row)

    def _close_ledger(self) -> None:
        write_whole(self.folder / "ledger.csv", self.ledger.write)

    # --- time and signals -------------------------------------------------------------------------------------------

    def _clock(self, what: str):
        return _Clock(self.seconds, what)

    def _collect_cost(self) -> tuple[dict[str, Part], float]:
        """What every effect has taken in this run, and what the leap-frog has beside them [s]."""
        parts, leapfrog = {}, self.instance.fix_seconds("leapfrog")
        for effect in self.effects:
            clocks = effect.clocks(self.instance)
            span = self.ready.verdicts[effect.name].span
            parts[effect.name] = Part(sum(clocks.values()), str(span) if span else None, clocks if len(clocks) > 1 else {})
            leapfrog -= clocks.get(LEAPFROG, 0.0)
        return parts, leapfrog

    def _cost(self) -> Cost:
        """The account of the whole run, to be asked for at its end."""
        simulation = self.seconds["simulation"]
        rest = max(0.0, simulation - sum(p.seconds for p in self.parts.values()) - self.leapfrog)
        other = {name: s for name, s in self.seconds.items() if name != "simulation"}
        return Cost(
            wall=time.perf_counter() - self.started + other.get("before the resume", 0.0), steps=self.certificate.steps,
            particles=self.ready.system.particles, effects=self.parts,
            other={LEAPFROG: self.leapfrog, "rest of the step": rest, **other})


class _Clock:
    """Adds the wall seconds of a ``with`` block to an account."""

    def __init__(self, account: dict[str, float], what: str):
        self.account, self.what = account, what

    def __enter__(self) -> None:
        self.start = time.perf_counter()

    def __exit__(self, *_) -> None:
        self.account[self.what] = self.account.get(self.what, 0.0) + time.perf_counter() - self.start


class _Interrupt:
    """Turns Ctrl-C and SIGTERM into an event, so that a frame is finished before the run stops."""

    def __enter__(self) -> threading.Event:
        event = threading.Event()
        self.old = {}
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self.old[number] = signal.signal(number, lambda *_: event.set())
        return event

    def __exit__(self, *_) -> None:
        for number, handler in self.old.items():
            signal.signal(number, handler)
