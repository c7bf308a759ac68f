# SPDX-License-Identifier: GPL-2.0-only
"""One LAMMPS instance on several ranks beside one: ``python bench/team.py SCENE.txt [ranks] [frames] [rounds]``.

What a team of executors can gain, without driver and supervisor: milliseconds of a frame, of the rank that takes most, medians
over frames, then over rounds in turns.
"""

import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import one_thread  # noqa: F401
from timing import markdown


def frames_of(scene: Path, frames: int) -> None:
    """On every rank: run, and print what rank 0 knows of all, as JSON."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene
    from mpi4py import MPI

    world, plan = MPI.COMM_WORLD, prepare(load_scene(scene)).plan
    cpu, wall = [], []
    with Instance(plan, world) as instance:
        instance.setup()
        for _ in range(frames):
            world.Barrier()
            begin, begun = time.process_time(), time.perf_counter()
            instance.trace.start()
            instance.run(plan.certificate.steps_per_frame)
            instance.trace.boxes()
            cpu.append(world.allreduce(time.process_time() - begin, MPI.MAX))
            wall.append(time.perf_counter() - begun)
    if world.rank == 0:
        found = {"cpu": 1e3 * statistics.median(cpu), "wall": 1e3 * statistics.median(wall), "particles": plan.system.particles}
        print("found " + json.dumps(found))


def measured(scene: Path, ranks: int, frames: int) -> dict[str, float]:
    """The same in a fresh start of MPI."""
    mpiexec = Path(sys.executable).parent / "mpiexec"
    done = subprocess.run(
        [mpiexec, "-n", str(ranks), sys.executable, "-m", "mpi4py", __file__, "--rank", scene, str(frames)],
        check=True,
        capture_output=True,
        text=True,
    )
    return json.loads(next(line for line in done.stdout.splitlines() if line.startswith("found ")).removeprefix("found "))


def main(scene: Path, ranks: int = 2, frames: int = 40, rounds: int = 3) -> None:
    """Print a table in Markdown."""
    found = {n: [] for n in (1, ranks)}
    for _ in range(rounds):
        for n, runs in found.items():
            runs.append(measured(scene, n, frames))

    def middle(n: int, what: str) -> float:
        return statistics.median(run[what] for run in found[n])

    print(
        markdown(
            ["scene", "particles", "ranks", "ms of a frame, processor", "times as fast", "wall", "times as fast"],
            [
                [
                    scene.stem,
                    found[n][0]["particles"],
                    n,
                    middle(n, "cpu"),
                    middle(1, "cpu") / middle(n, "cpu"),
                    middle(n, "wall"),
                    middle(1, "wall") / middle(n, "wall"),
                ]
                for n in found
            ],
        )
    )


if __name__ == "__main__":
    if sys.argv[1] == "--rank":
        frames_of(Path(sys.argv[2]), int(sys.argv[3]))
    else:
        main(Path(sys.argv[1]), *map(int, sys.argv[2:]))
