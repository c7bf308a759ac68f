# SPDX-License-Identifier: GPL-2.0-only
"""What threads bring: ``python bench/threads.py [rounds [threads [scene ...]]]``.

A scene is ``cube N``, of N particles along an edge, ``pool N``, the same cube as it falls into waves of 7 N columns along a side,
or the name of a file in scenes/. Told is the wall time of a step by one thread and by several, in turns, beside the machine's own
ceiling in the same rounds: what as many independent processes with one thread each do at once, over one alone. Where others use
the processors, none of this says much; then the processor time of the thread that calls does, which falls by what others do for
it. Figures are medians over rounds. A scene is run from its own beginning on, without frames.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

SCENES = Path(__file__).resolve().parents[1] / "scenes"
CUBE = """gravity (0, 0, -9.81)
object a {{ shape box ({0}, {0}, {0}) cm position (0, 0, 0) density 1000 elasticity 1 MPa drag 1e-3 }}
control {{ time 1 s  resolution 1 cm }}
"""
POOL = """gravity (0, 0, -9.81)
object a {{ shape box ({0}, {0}, {0}) cm position (0, 0, {0}) cm density 500 elasticity 1 MPa velocity (0, 0, -1) }}
liquid w {{ basin from (-{1}, -{1}, 0) cm to ({1}, {1}, {2}) cm density 1000 level {3} cm model waves }}
control {{ time 1 s  resolution 1 cm }}
"""
ALONE, SHARED, AT_ONCE = "alone", "shared", "at once"
ROUNDS, PARTICLE_STEPS, NAMES = 9, 8_000_000, ("cube 30", "cube 60", "beam", "crowd", "pile")


def serve(pipe: Connection, name: str, threads: dict[str, int]) -> None:
    """Run the next steps of an instance with so many threads when asked for it by its name.

    Tell the seconds that passed, and those that this thread had a processor.
    """
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.engine.threads import with_threads
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene, parse_scene

    kind, _, edge = name.partition(" ")
    if kind == "cube":
        scene = parse_scene(CUBE.format(int(edge) - 1))
    elif kind == "pool":
        scene = parse_scene(POOL.format(n := int(edge) - 1, 7 * n // 2, 2 * n, n // 2))
    else:
        scene = load_scene(SCENES / f"{name}.txt")
    ready = prepare(scene)
    instances = {}
    for who, number in threads.items():
        with with_threads(number):
            instances[who] = Instance(ready.plan)
        instances[who].setup()
    steps = max(20, PARTICLE_STEPS // ready.system.particles)
    pipe.send((ready.system.particles, steps))
    while (who := pipe.recv()) is not None:
        start, start_here = time.perf_counter(), time.thread_time()
        instances[who].run(steps)
        pipe.send((time.perf_counter() - start, time.thread_time() - start_here))


def measure(name: str, threads: int, rounds: int) -> None:
    """Print one row."""
    context = get_context("spawn")
    pipes, processes = [], []
    for n in range(threads):
        own, other = context.Pipe()
        # An instance for each question: all see the same part of the scene in a round.
        asked = {AT_ONCE: 1} if n else {ALONE: 1, SHARED: threads, AT_ONCE: 1}
        processes.append(context.Process(target=serve, args=(other, name, asked), daemon=True))
        processes[-1].start()
        pipes.append(own)
    ready = [pipe.recv() for pipe in pipes]
    particles, steps = ready[0]

    def seconds(asked: list[Connection], who: str) -> tuple[float, float]:
        for pipe in asked:
            pipe.send(who)
        return max(pipe.recv() for pipe in asked)

    alone, shared, at_once = [], [], []
    for _ in range(rounds):
        alone.append(seconds(pipes[:1], ALONE))
        shared.append(seconds(pipes[:1], SHARED))
        at_once.append(seconds(pipes, AT_ONCE))
    for pipe, process in zip(pipes, processes):
        pipe.send(None)
        process.join()

    def median(told: list[tuple[float, float]], n: int) -> float:
        return 1e6 * statistics.median(t[n] for t in told) / steps

    one, many, both = (median(told, 0) for told in (alone, shared, at_once))
    one_here, many_here = median(alone, 1), median(shared, 1)
    ceiling, faster = threads * one / both, one / many
    print(
        f"| {name} | {particles} | {one:.0f} | {many:.0f} | {faster:.2f} | {ceiling:.2f} | {faster / ceiling:.2f} "
        f"| {one_here:.0f} | {many_here:.0f} | {one_here / many_here:.2f} | {os.getloadavg()[0]:.1f} |",
        flush=True,
    )


def main(rounds: int = ROUNDS, threads: int = 2, names: tuple[str, ...] = NAMES) -> None:
    """Measure scenes and print a table in Markdown."""
    print(
        f"| scene | particles | us a step, 1 thread | {threads} threads | times as fast | ceiling | over the ceiling "
        f"| us of the calling thread, 1 thread | {threads} threads | ratio | load |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for name in names:
        measure(name, threads, rounds)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), *([tuple(sys.argv[3:])] if sys.argv[3:] else []))
