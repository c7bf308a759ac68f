# SPDX-License-Identifier: GPL-2.0-only
"""The part of bench/scaling.py that is about threads: steps of a scene by one thread and by several, and Amdahl's law.

Measured is as far as there are cores. The model beyond knows two numbers of a scene, its serial part and its shared part, which
are those that the medians of one and two threads have: t(k) = serial + shared/k. It knows nothing of caches, of memory, of what a
call of threads costs, or of the largest piece that is not divided, so it is an upper bound where these matter.
"""

from __future__ import annotations

import os
import statistics
import sys

from threads import Servers
from timing import machine, markdown

SCENES = {"crowd": "crowd", "heap": "heap 208", "hail": "hail 64", "one object": "cube 60", "float": "float 1e5"}
"""Names of bench/scene_texts.py."""
FAR = (4, 8, 16, 32)
"""Threads for which the table has the model."""


def counts_of(cores: int) -> list[int]:
    """Numbers of threads that are measured: powers of two, and all cores."""
    return sorted({k for k in (1, 2, 4, 8, 16, 32) if k <= cores} | {min(cores, 32)})


def measure(names: list[str], counts: list[int], rounds: int) -> dict:
    """Seconds of a step by number of threads, in interleaved rounds, of each scene."""
    note = f"{rounds} rounds. {machine()}"
    found = {}
    for name in names:
        with Servers(SCENES[name], {str(k): k for k in counts}) as server:
            seconds: dict[str, list[float]] = {str(k): [] for k in counts}
            for turn in range(rounds):
                for k in counts if turn % 2 == 0 else counts[::-1]:
                    seconds[str(k)].append(server.seconds(str(k))[0])
            found[name] = {"scene": SCENES[name], "particles": server.particles, "steps": server.steps, "seconds": seconds}
        print(f"threads: {name}: " + ", ".join(f"{k}: {1e6 * min(s):.0f} µs" for k, s in seconds.items()), file=sys.stderr)
    return {"note": f"{note}; load after {os.getloadavg()[0] / (os.cpu_count() or 1):.1f} per core", "scenes": found}


def faster(seconds: dict[str, list[float]], count: str) -> list[float]:
    """Times as fast as one thread, of each round."""
    return [one / many for one, many in zip(seconds["1"], seconds[count])]


def parts(seconds: dict[str, list[float]]) -> tuple[float, float] | None:
    """Serial and shared part of a step, over the step of one thread; None where two threads were not measured.

    The shared part is 0 where two threads were not faster, and at most 1 where they were more than twice as fast.
    """
    if "2" not in seconds:
        return None
    shared = min(1.0, max(0.0, 2.0 * (1.0 - 1.0 / statistics.median(faster(seconds, "2")))))
    return 1.0 - shared, shared


def model(split: tuple[float, float], threads: float) -> float:
    """Times as fast as one thread, by Amdahl's law."""
    serial, shared = split
    return 1.0 / (serial + shared / threads)


def table(data: dict) -> str:
    """Markdown: what was measured, and the model."""
    counts = list(next(iter(data["scenes"].values()))["seconds"])
    rows = []
    for name, of in data["scenes"].items():
        seconds = of["seconds"]
        split = parts(seconds)
        measured = [f"{statistics.median(faster(seconds, k)):.2f}" for k in counts[1:]]
        told = [f"{split[0]:.2f}", *(f"{model(split, k):.1f}" for k in FAR)] if split else [""] * (1 + len(FAR))
        rows.append((name, of["scene"], f"{of['particles']}", f"{1e6 * statistics.median(seconds['1']):.0f}", *measured, *told))
    head = [
        "scene",
        "`bench/scene_texts.py`",
        "particles",
        "µs a step, 1 thread",
        *(f"{k} threads, times as fast" for k in counts[1:]),
    ]
    return markdown([*head, "serial part of the model", *(f"model, {k}" for k in FAR)], rows)


def draw(axes, data: dict) -> None:
    """Times as fast over the number of threads: points are measured, broken lines the model."""
    most = max(FAR)
    axes.plot([1, most], [1, most], color="#b0b7bd", linewidth=1.0, label="as many times as threads")
    for n, (name, of) in enumerate(data["scenes"].items()):
        seconds, color = of["seconds"], f"C{n}"
        count = [int(k) for k in seconds]
        ratios = [faster(seconds, k) for k in seconds]
        middle = [statistics.median(r) for r in ratios]
        axes.plot(count, middle, "o-", color=color, markersize=5, label=f"{name}, {of['particles']} particles")
        axes.vlines(count, [min(r) for r in ratios], [max(r) for r in ratios], color=color, linewidth=0.8)
        if split := parts(seconds):
            beyond = [2.0 * (most / 2.0) ** (i / 40) for i in range(41)]
            axes.plot(beyond, [model(split, k) for k in beyond], "--", color=color, linewidth=1.0)
    ticks = [1, 2, *FAR]
    axes.set_xscale("log", base=2)
    axes.set_yscale("log", base=2)
    axes.set_xticks(ticks, [f"{k}" for k in ticks])
    axes.set_yticks(ticks, [f"{k}" for k in ticks])
    axes.minorticks_off()
    axes.set(xlabel="threads", ylabel="steps per second over one thread", xlim=(0.9, 1.1 * most), ylim=(0.7, 1.1 * most))
    axes.set_title("points: measured; broken: Amdahl's law with the serial part that 1 and 2 threads show", fontsize=8)
    axes.grid(alpha=0.25)
    axes.legend(fontsize=7)
