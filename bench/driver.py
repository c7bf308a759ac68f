# SPDX-License-Identifier: GPL-2.0-only
"""Time of every frame that the driver of a distributed run takes beside LAMMPS: ``python bench/driver.py [executors] [control]``.

1000 objects of 100 particles fly about, and some meet. Milliseconds of processor time of a frame, of the executor that took most;
medians over the frames but the first ten, and the least. Under ``supervisor`` is what goes on beside the executors.
"""

import functools
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import one_thread  # noqa: F401

SCENE = """
gravity (0, 0, -9.81) m/s^2
repeat i in 1 .. 10 { repeat j in 1 .. 10 { repeat k in 1 .. 10 {
  object box[(i*10 + j)*10 + k] {
    shape      box (12, 15, 9) cm
    position   (i*0.45, j*0.45, k*0.45) m
    mass       1 kg
    elasticity 100 kPa
    velocity   (rand(-2, 2), rand(-2, 2), rand(-2, 2)) m/s
  }
} } }
control { time 0.25 s  frames 100 fps  resolution 3 cm }
"""
FIRST = 10
"""Frames that are not counted."""
PARTS = {
    "runtime.executor": (
        "Executor",
        {
            "_transfer": "hand on",
            "_report": "report",
            "_commit": "copy states",
            "_weigh": "sum energies",
            "_go_on": "lay aside",
            "_send": "send frame",
        },
    ),
    "runtime.bundle": ("Bundle", {"__init__": "build instances", "start": "put states", "run": "LAMMPS", "extent": "boxes"}),
    "plan.planner": ("Planner", {"decide": "plan"}),
    "runtime.messages": ("Mail", {"exchange": "exchange"}),
    "runtime.control": ("Central", {"decide": "wait for orders"}),
    "runtime.supervisor": ("Distributed", {"_frame": "put together", "_take": "take a message"}),
}
"""Class and methods of every module of the driver, with what they are called below. Some hold others."""


def ranks(folder: Path, control: str) -> None:
    """Work of every rank: run, and write what its methods took, frame by frame."""
    import importlib

    from mdanim_lammps.parallel.plan.frame_plan import PlannerOptions
    from mdanim_lammps.parallel.runtime import executor
    from mdanim_lammps.parallel.runtime.supervisor import Distributed
    from mdanim_lammps.run.loop import simulate
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene
    from mpi4py import MPI

    world = MPI.COMM_WORLD
    frames: list[dict[str, float]] = [{}]

    def timed(method, name):
        @functools.wraps(method)
        def call(*arguments, **options):
            begin = time.thread_time()
            try:
                return method(*arguments, **options)
            finally:
                frames[-1][name] = frames[-1].get(name, 0.0) + time.thread_time() - begin

        return call

    for module, (kind, methods) in PARTS.items():
        owner = getattr(importlib.import_module(f"mdanim_lammps.parallel.{module}"), kind)
        for method, name in methods.items():
            setattr(owner, method, timed(getattr(owner, method), name))
    executor.wanted_bundles = timed(executor.wanted_bundles, "wanted bundles")
    simulated = executor.Executor._simulate

    def one_frame(self, end):
        begin = time.thread_time()
        simulated(self, end)
        frames[-1]["all"] = time.thread_time() - begin
        frames[-1]["bundles"] = 1e-3 * len(self.bundles)
        frames.append({})

    executor.Executor._simulate = one_frame  # what it sends after a frame counts in the next one
    if world.rank:
        executor.serve(world)
    else:
        source = Distributed(prepare(load_scene(folder / "crowd.txt")), world, control, PlannerOptions())
        simulate(source.ready, folder, source=source, on_progress=lambda progress: frames.append({}))
        source.timeline.write(folder)
    (folder / f"{world.rank}.json").write_text(json.dumps(frames))


def main(executors: int = 2, control: str = "central") -> None:
    """Start the ranks, and print one row for every part."""
    with tempfile.TemporaryDirectory() as where:
        folder = Path(where)
        (folder / "crowd.txt").write_text(SCENE)
        program = [
            Path(sys.executable).parent / "mpiexec",
            "-n",
            str(executors + 1),
            sys.executable,
            "-m",
            "mpi4py",
            __file__,
            "--rank",
            where,
            control,
        ]
        subprocess.run(program, check=True, env=os.environ | {"OMP_NUM_THREADS": "1"})
        timeline = json.loads((folder / "timeline.json").read_text())
        took = [[f for f in json.loads((folder / f"{rank}.json").read_text()) if f][FIRST:-2] for rank in range(executors + 1)]
    print(
        f"{executors} executors, {control}: {len(timeline['names'])} objects, "
        f"{sum(timeline['moves'][FIRST:]) / len(timeline['moves'][FIRST:]):.1f} "
        f"moves and {sum(timeline['retries'][FIRST:]) / len(timeline['retries'][FIRST:]):.2f} new beginnings in a frame"
    )
    print(f"{'':>26} {'median':>8} {'least':>8}  [ms]")
    for process, rows in (("executor", took[1:]), ("supervisor", took[:1])):
        for name in dict.fromkeys(name for frames in rows for f in frames for name in f):
            per_frame = np.array([[1e3 * f.get(name, 0.0) for f in frames[: min(map(len, rows))]] for frames in rows]).max(axis=0)
            print(f"{process:>10} {name:>15} {np.median(per_frame):8.2f} {per_frame.min():8.2f}")
        if process == "executor":
            own = np.array([[1e3 * (f["all"] - f["LAMMPS"] + f["send frame"]) for f in frames if "all" in f] for frames in rows])
            print(f"{process:>10} {'beside LAMMPS':>15} {np.median(own.max(axis=0)):8.2f} {own.max(axis=0).min():8.2f}")


if __name__ == "__main__":
    if "--rank" in sys.argv:
        ranks(Path(sys.argv[2]), sys.argv[3])
    else:
        main(*map(int, sys.argv[1:2]), *sys.argv[2:3])
