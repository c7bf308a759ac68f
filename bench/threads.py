# SPDX-License-Identifier: GPL-2.0-only
"""Gain of threads: ``python bench/threads.py [rounds [threads [scene ...]]] [--unshared] [--write]``.

A scene is a name of bench/scene_texts.py, such as ``cube 30``, ``heap 208``, ``boxes 1000``, ``pool 46``, ``automaton 46``,
``float 1e5``, ``hail 64``, or the name of a file in scenes/. Told is the wall time of a step by one thread and by several, in
turns, beside the machine's own ceiling in the same rounds: what as many independent processes with one thread each do at once,
over one alone. Where others use the processors, none of this says much; then the processor time of the thread that calls does,
which falls by what others do for it. Figures are medians over rounds. All see the same steps of a scene in a round, without
frames.
``--unshared`` tells instead what part of a step threads do not share: the calling thread leaves all that is shared to another
one and sleeps (MDANIM_CALLER_RESTS in plugin/threads/team.cpp), so its processor time is that of the rest, with about 4 µs for
each time that it hands out tasks. Other programs hardly change it.
``--write`` puts the table into docs/decisions/threads.md.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from scene_texts import scene_of, warm
from timing import machine, markdown, replace_between

PAGE = Path(__file__).resolve().parents[1] / "docs" / "decisions" / "threads.md"
ALONE, SHARED, AT_ONCE = "alone", "shared", "at once"
ROUNDS = 7
NAMES = ("cube 30", "cube 60", "beam", "crowd", "heap 208", "boxes 1000", "pool 46", "automaton 46", "float 1e5")
FIRST_STEPS, PARTICLE_STEPS, SECONDS = 20, 8_000_000, 0.6
"""Steps that are not measured; the most that are measured at once, times particles, and how long they may take about."""


def serve(pipe: Connection, name: str, threads: dict[str, int]) -> None:
    """Run steps of an instance with so many threads when asked for it by its name: (name, steps).

    Tell the seconds that passed, and those that this thread had a processor. Before that comes the state from which the scene is
    measured, sent by who has it already, else None; told are particles, seconds of a step, and that state.
    """
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.engine.threads import with_threads
    from mdanim_lammps.run.prepare import prepare

    ready = prepare(scene_of(name))
    state = pipe.recv() or warm(name, ready)
    instances, first = {}, []
    for who, number in threads.items():
        with with_threads(number):
            instances[who] = Instance(ready.plan)
        instances[who].setup()
        if state:
            instances[who].put(*state)
        start = time.perf_counter()
        instances[who].run(FIRST_STEPS)
        first.append((time.perf_counter() - start) / FIRST_STEPS)
    pipe.send((ready.system.particles, first[0], state))
    while (asked := pipe.recv()) is not None:
        who, steps = asked
        start, start_here = time.perf_counter(), time.thread_time()
        instances[who].run(steps)
        pipe.send((time.perf_counter() - start, time.thread_time() - start_here))


class Servers:
    """Processes that run steps of a scene; a context manager. The first one answers all of ``first``, the others ``others``."""

    def __init__(self, name: str, first: dict[str, int], others: dict[str, int] | None = None, number: int = 1):
        context = get_context("spawn")
        self.pipes: list[Connection] = []
        self._processes = []
        state = None
        for n in range(number):
            own, other = context.Pipe()
            asked = others if n else first
            self._processes.append(context.Process(target=serve, args=(other, name, asked), daemon=True))
            self._processes[-1].start()
            other.close()
            own.send(state)
            self.pipes.append(own)
            particles, seconds, state = own.recv()
            if n == 0:
                self.particles = particles
                self.steps = max(FIRST_STEPS, min(PARTICLE_STEPS // particles, round(SECONDS / seconds)))

    def __enter__(self) -> Servers:
        return self

    def __exit__(self, *_) -> None:
        for pipe, process in zip(self.pipes, self._processes):
            if process.is_alive():
                pipe.send(None)
            process.join()

    def seconds(self, who: str, number: int = 1) -> tuple[float, float]:
        """Seconds of a step, on this many processes at once: wall time, and time of the thread that calls."""
        for pipe in self.pipes[:number]:
            pipe.send((who, self.steps))
        wall, here = max(pipe.recv() for pipe in self.pipes[:number])
        return wall / self.steps, here / self.steps


HEAD = (
    *("scene", "particles", "µs a step, 1 thread", "{} threads", "times as fast", "ceiling", "over the ceiling"),
    *("µs of the calling thread, 1 thread", "{} threads", "ratio", "load"),
)


def measure(name: str, threads: int, rounds: int) -> tuple[str, ...]:
    """One row."""
    # An instance for each question: all see the same part of the scene in a round.
    with Servers(name, {ALONE: 1, SHARED: threads, AT_ONCE: 1}, {AT_ONCE: 1}, threads) as servers:
        turns = [
            [servers.seconds(who, number) for who, number in ((ALONE, 1), (SHARED, 1), (AT_ONCE, threads))] for _ in range(rounds)
        ]

    def median(who: int, clock: int) -> float:
        return 1e6 * statistics.median(turn[who][clock] for turn in turns)

    one, many, both, one_here, many_here = median(0, 0), median(1, 0), median(2, 0), median(0, 1), median(1, 1)
    ceiling, faster = threads * one / both, one / many
    return (
        *(
            name,
            f"{servers.particles}",
            f"{one:.0f}",
            f"{many:.0f}",
            f"{faster:.2f}",
            f"{ceiling:.2f}",
            f"{faster / ceiling:.2f}",
        ),
        *(f"{one_here:.0f}", f"{many_here:.0f}", f"{one_here / many_here:.2f}", f"{os.getloadavg()[0]:.1f}"),
    )


UNSHARED = ("scene", "µs a step, 1 thread", "not shared", "part", "times as fast by 2 threads at best")


def unshared(name: str, rounds: int) -> tuple[str, ...]:
    """One row of the table of what is not shared, by processor time of the calling thread."""
    os.environ["MDANIM_CALLER_RESTS"] = "1"  # for the child
    with Servers(name, {ALONE: 1, SHARED: 2}) as servers:
        turns = [[1e6 * servers.seconds(who)[1] for who in (ALONE, SHARED)] for _ in range(rounds)]
    one, rest = (statistics.median(turn[k] for turn in turns) for k in range(2))
    return name, f"{one:.0f}", f"{rest:.0f}", f"{rest / one:.2f}", f"{2.0 / (1.0 + rest / one):.2f}"


def main() -> None:
    """Measure scenes and print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rounds", nargs="?", type=int, default=ROUNDS)
    parser.add_argument("threads", nargs="?", type=int, default=2)
    parser.add_argument("scenes", nargs="*", metavar="scene", help=f"by default: {', '.join(NAMES)}")
    parser.add_argument("--unshared", action="store_true")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_intermixed_args()
    head = UNSHARED if options.unshared else [word.format(options.threads) for word in HEAD]
    names = "".join(f' "{name}"' for name in options.scenes) + " --unshared" * options.unshared
    note = f"`python bench/threads.py {options.rounds} {options.threads}{names}`. {machine()}."
    print(f"{note}\n\n{markdown(head, [])}", flush=True)
    rows = []
    for name in options.scenes or NAMES:
        rows.append(unshared(name, options.rounds) if options.unshared else measure(name, options.threads, options.rounds))
        print("| " + " | ".join(rows[-1]) + " |", flush=True)
    if options.write:
        replace_between(PAGE, "unshared" if options.unshared else "threads", f"{note}\n\n{markdown(head, rows)}")


if __name__ == "__main__":
    main()
