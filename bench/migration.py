# SPDX-License-Identifier: GPL-2.0-only
"""Cost of moving an object to another process: ``mpiexec -n 2 python bench/migration.py [rounds]``.

Rank 0 has it in a live instance, and rank 1 makes one that goes on from the same state: pack, send, part, instance, setup. The
time from end to end is that of rank 0, until it hears that all is ready. Then instances are made and closed one after the other.
"""

import os
import sys
import time
from pathlib import Path

import numpy as np
import one_thread  # noqa: F401

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object cube {{
  shape box ({n}, {n}, {n}) cm
  position (0, 0, {n}) cm
  density 900
  elasticity 300 kPa
}}
object other {{
  shape box (3, 3, 3) cm
  position (0, 0, {far}) cm
  density 900
  elasticity 300 kPa
}}
control {{
  time 1 s
  resolution 1 cm
}}
"""
SIZES = {9: 5.0, 26: 25.0}
"""Cells along an edge, and the time that a migration is to take at most [ms]: 1000 and 20 000 particles, roughly."""
STAGES = ("pack", "wire", "part", "instance", "put", "end to end", "processor")
"""The last is what the receiver takes of a processor, which other programs on the machine change less
than the clock on the wall."""
CYCLES = 1000


class Mover:
    """One size of object, on either side."""

    def __init__(self, n: int, comm):
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.engine.sub_plan import SubPlans
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import parse_scene

        self.comm = comm
        self.parts = SubPlans(prepare(parse_scene(SCENE.format(n=n, far=3 * n))).plan)
        self.particles = self.parts.part((0,), False).system.particles
        self.steps = 50
        if comm.rank == 0:
            self.instance = Instance(self.parts.part((0,), False))
            self.instance.setup()
            self.instance.run(self.steps)

    def move(self) -> dict[str, float]:
        """Seconds of each stage that this rank has a part in."""
        return self.send() if self.comm.rank == 0 else self.receive()

    def send(self) -> dict[str, float]:
        self.comm.Barrier()
        start = time.perf_counter()
        state = self.instance.state()
        packed = np.concatenate([state.x, state.v, state.f])
        pack = time.perf_counter() - start
        self.comm.Send(packed, 1)
        wire = time.perf_counter() - start - pack
        while not self.comm.iprobe(
            1
        ):  # asleep: a process that waits in MPI takes a core, and half of the next where two share one
            time.sleep(2e-5)
        self.comm.Recv(np.empty(1), 1)
        return {"pack": pack, "wire": wire, "end to end": time.perf_counter() - start}

    def receive(self) -> dict[str, float]:
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.engine.state import State

        packed = np.empty((3, self.particles, 3))
        self.comm.Barrier()
        self.comm.Recv(packed, 0)
        marks, busy = [time.perf_counter()], time.process_time()
        part = self.parts.part((0,), False)
        marks.append(time.perf_counter())
        instance = Instance(part)
        marks.append(time.perf_counter())
        instance.put(self.steps, State(*packed))
        marks.append(time.perf_counter())
        busy = time.process_time() - busy
        self.comm.Send(np.zeros(1), 0)
        assert np.array_equal(instance.array("x"), packed[0])
        instance.close()
        return dict(zip(("part", "instance", "put"), np.diff(marks))) | {"processor": busy}


def cycles(mover: Mover) -> str:
    """Make and close instances; how long each takes, and what is left of them."""
    from mdanim_lammps.engine.instance import Instance

    def residue() -> tuple[int, int]:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE"), len(os.listdir("/proc/self/fd"))

    def go(count: int) -> float:
        start = time.perf_counter()
        for _ in range(count):
            Instance(mover.parts.part((0,), False)).close()
        return time.perf_counter() - start

    go(CYCLES // 2)  # LAMMPS and MPI fill their own stores at first
    before, seconds, after = residue(), go(CYCLES), residue()
    return (
        f"{CYCLES} instances of {mover.particles} particles made and closed: {1e3 * seconds / CYCLES:.2f} ms each, "
        f"{(after[0] - before[0]) / CYCLES:.0f} bytes and {after[1] - before[1]} files left"
    )


def main(rounds: int = 15) -> None:
    """Measure and print."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    if comm.size != 2:
        raise SystemExit("start it with: mpiexec -n 2 python bench/migration.py")
    movers = {n: Mover(n, comm) for n in SIZES}
    found = {n: [] for n in SIZES}
    for _ in range(rounds + 1):
        for n, mover in movers.items():
            own = mover.move()
            found[n].append(comm.gather(own))
    if comm.rank == 0:
        print(
            f"{'particles':>9} "
            + "".join(f"{stage:>18}" for stage in STAGES)
            + f"{'goal':>8} {'first':>8}   [ms, median (least)]"
        )
        for n, turns in found.items():
            first, *later = [sender | receiver for sender, receiver in turns]
            values = {stage: 1e3 * np.array([turn[stage] for turn in later]) for stage in STAGES}
            print(
                f"{movers[n].particles:>9} "
                + "".join(f"{np.median(v):>9.2f} ({v.min():>6.2f})" for v in values.values())
                + f"{SIZES[n]:>8.0f} {1e3 * first['end to end']:>8.1f}"
            )
    comm.Barrier()
    if comm.rank == 1:
        print(cycles(movers[min(SIZES)]), flush=True)
    while comm.rank == 0 and not comm.iprobe(1):  # a rank that waits in MPI takes a core
        time.sleep(0.01)
    comm.sendrecv(None, 1 - comm.rank, source=1 - comm.rank)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
