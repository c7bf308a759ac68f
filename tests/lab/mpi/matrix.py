# SPDX-License-Identifier: GPL-2.0-only
"""Run one scene in many ways in one start of MPI: ``mpiexec -n 5 python matrix.py CASES.json SECONDS``.

Each way is a supervisor and executors on some of the ranks, or the sequential program on one of them.
"""

import faulthandler
import json
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from mdanim_lammps.parallel.plan import frame_plan
from mdanim_lammps.parallel.plan.frame_plan import PlannerOptions
from mdanim_lammps.parallel.runtime.bundle import Bundle
from mdanim_lammps.parallel.runtime.executor import serve
from mdanim_lammps.parallel.runtime.supervisor import Distributed
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.timeline import Timeline
from mdanim_lammps.run.loop import Interrupted, simulate
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene
from mpi4py import MPI


def run(case: dict, ready, world) -> None:
    """One way; ``world`` is None for the sequential program."""
    folder = Path(case["folder"])
    folder.mkdir(exist_ok=True)

    def watch(progress):
        if progress.frame == case.get("stop"):
            (folder / "stop").touch()

    checkpoint = Checkpoint.read(folder / "checkpoint") if case.get("resume") else None
    source = world and Distributed(ready, world, case["control"], PlannerOptions(**case.get("settings", {})))
    if source and checkpoint:
        source.before = Timeline.left_in(folder)
    try:
        simulate(ready, folder, resume=checkpoint, on_progress=watch, source=source)
    except Interrupted:
        assert "stop" in case
    if source:
        assert source.clean
        source.timeline.write(folder)


class Spoiled:
    """A change of one case to all ranks while it runs: ``rotate`` gives every island to the next executor in every plan,
    ``forget`` lets instances begin without records ("all"), or without those of pairs."""

    def __init__(self, case: dict):
        self.case, self.turn = case, 0
        self.assign, self.records = frame_plan.assign, Bundle.records_from

    def __enter__(self) -> None:
        if self.case.get("rotate"):
            frame_plan.assign = self._rotated
        if forget := self.case.get("forget"):
            whole = self.records
            Bundle.records_from = lambda bundle, records: {
                fix: found.where(np.full(len(found), False) if forget == "all" else found.keys[:, 1] == 0)
                for fix, found in whole(bundle, records).items()
            }

    def _rotated(self, label, cost, owner, executors, **more):
        given = self.assign(label, cost, owner, executors, **more)
        self.turn += 1
        return given if given.teams else replace(given, owner=np.where(label >= 0, (label + self.turn) % executors, given.owner))

    def __exit__(self, *_) -> None:
        frame_plan.assign, Bundle.records_from = self.assign, self.records


def wait(comm) -> None:
    """A barrier that leaves the processor to others."""
    request = comm.Ibarrier()
    while not request.Test():
        time.sleep(0.002)


def main() -> None:
    """All ways in their order; ranks that are not needed wait."""
    faulthandler.dump_traceback_later(float(sys.argv[2]))  # which rank waits for which, when all wait for ever
    all_ranks = MPI.COMM_WORLD
    work = json.loads(Path(sys.argv[1]).read_text())
    ready = prepare(load_scene(Path(work["scene"]))) if all_ranks.rank == 0 else None
    for case in work["cases"]:
        ranks = case["executors"] + 1 if case["control"] else 1
        world = all_ranks.Split(0 if all_ranks.rank < ranks else MPI.UNDEFINED, all_ranks.rank)
        if world != MPI.COMM_NULL:
            with Spoiled(case):
                if all_ranks.rank == 0:
                    run(case, ready, world if case["control"] else None)
                else:
                    serve(world)
        wait(all_ranks)


if __name__ == "__main__":
    main()
