# SPDX-License-Identifier: GPL-2.0-only
"""Cost of the liquid's automaton: ``python bench/automaton.py [cells] [rounds]``.

One grid of cells^3, one core. Printed are medians and minima over interleaved rounds, in nanoseconds per cell and
as multiples of a copy of the same bytes:

sweep, lively   half of the cells hold a unit, drawn at random: every layer changes at every step
same, plain     the loops as the rules read
sweep, ball     lively around a solid ball of a quarter of the width in radius
sweep, pool     half full to a part-filled layer, at rest: that layer alone is touched
displace 0      solids given, none changed: the comparison alone
displace N      the ball moves by one cell in the pool, N cells change
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lab"))
import automaton_lab as lab
import timing
from timing import Sample, markdown

SWEEPS = 4
GOAL = 0.5
"""Nanoseconds of a sweep per cell at 128^3."""


def seconds(work) -> float:
    """Processor time of a call, which others on the machine stretch least."""
    return timing.seconds(work, time.thread_time)


def measure(rounds: int = 15, quick: bool = False, cells: int = 128) -> list[dict]:
    """One row for each kind of work, in seconds."""
    shape = (cells,) * 3
    middle = (cells - 1) / 2
    z, y, x = np.ogrid[:cells, :cells, :cells]
    beside = (y - middle) ** 2 + (x - middle) ** 2
    balls = [(beside + (z - middle - up) ** 2 < (cells / 4) ** 2).astype(np.uint8) for up in (0, 1)]
    scattered = np.random.default_rng(1).integers(0, 2, shape).astype(np.uint8)
    open_box, around, pool, moving = (lab.Automaton(shape) for _ in range(4))
    for a in (pool, moving):
        a.fill(int((int(0.6 * cells) + 0.5) * cells**2))
        a.sweep(10)
    around.displace(balls[0])
    moving.displace(balls[0])
    copy = np.empty_like(scattered)

    def lively(a, content, count=SWEEPS, plain=False):
        a.content = content
        a.sweep(1, plain)
        return seconds(lambda: a.sweep(count, plain)) / count

    spent: dict[str, list[float]] = {}
    changed = 0
    for n in range(rounds):
        row = {"copy": seconds(lambda: np.copyto(copy, scattered))}
        row["sweep, lively"] = lively(open_box, scattered)
        if n < 3:
            row["same, plain"] = lively(open_box, scattered, 1, plain=True)
        row["sweep, ball"] = lively(around, scattered * (balls[0] == 0))
        row["sweep, pool"] = seconds(lambda: pool.sweep(50)) / 50
        row["displace 0"] = seconds(lambda: moving.displace(balls[n % 2]))
        start = time.thread_time()
        changed = moving.displace(balls[1 - n % 2])
        row["displace N"] = time.thread_time() - start
        moving.sweep(SWEEPS)
        for name, value in row.items():
            spent.setdefault(name, []).append(value)
    found = {name: Sample(tuple(values)) for name, values in spent.items()}
    return [
        {
            "work": name,
            "cells": cells,
            "changed": changed,
            "median": s.median,
            "least": s.least,
            "copies": s.median / found["copy"].median,
        }
        for name, s in found.items()
    ]


def table(rows: list[dict]) -> str:
    """In Markdown."""
    n = rows[0]["cells"] ** 3
    return f"{rows[0]['cells']}³ cells, N = {rows[0]['changed']}\n\n" + markdown(
        ["work", "ns per cell, median", "minimum", "ms", "copies of the grid", "goal"],
        [
            (
                r["work"],
                1e9 * r["median"] / n,
                1e9 * r["least"] / n,
                1e3 * r["median"],
                r["copies"],
                f"≤ {GOAL} ns" if r["work"] == "sweep, lively" else "",
            )
            for r in rows
        ],
    )


def main(cells: int = 128, rounds: int = 15) -> None:
    """Measure and print."""
    print(table(measure(rounds, cells=cells)))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
