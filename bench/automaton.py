# SPDX-License-Identifier: GPL-2.0-only
"""Cost of the liquid's automaton: ``python bench/automaton.py [cells] [rounds]``.

One grid of cells^3, one core. Printed are medians over interleaved rounds, in nanoseconds per cell and
as multiples of a copy of the same bytes; the minima tell what a busy machine added:

sweep, lively   half of the cells hold a unit, drawn at random: every layer changes at every step
same, plain     the loops as the rules read
same, NAME      with the kernels of one instruction set
sweep, ball     lively around a solid ball of a quarter of the width in radius
sweep, pool     half full to a part-filled layer, at rest: that layer alone is touched
displace 0      solids given, none changed: the comparison alone
displace N      the ball moves by one cell in the pool, N cells change
"""

import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
import automaton_lab as lab  # noqa: E402

SWEEPS = 4


def seconds(work) -> float:
    """Wall time of a call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def main(cells: int = 128, rounds: int = 15) -> None:
    """Measure and print."""
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

    names = [name for number in range(3) if (name := open_box.use(number))]
    best = names[-1]
    spent: dict[str, list[float]] = {}
    changed = 0
    for n in range(rounds):
        row = {"copy": seconds(lambda: np.copyto(copy, scattered))}
        for number, name in enumerate(names):
            open_box.use(number)
            row["sweep, lively" if name == best else f"same, {name}"] = lively(open_box, scattered)
        if n < 3:
            row["same, plain"] = lively(open_box, scattered, 1, plain=True)
        row["sweep, ball"] = lively(around, scattered * (balls[0] == 0))
        row["sweep, pool"] = seconds(lambda: pool.sweep(50)) / 50
        row["displace 0"] = seconds(lambda: moving.displace(balls[n % 2]))
        start = time.perf_counter()
        changed = moving.displace(balls[1 - n % 2])
        row["displace N"] = time.perf_counter() - start
        moving.sweep(SWEEPS)
        for name, value in row.items():
            spent.setdefault(name, []).append(value)
    median = {name: statistics.median(values) for name, values in spent.items()}
    print(f"{cells}^3 cells, best instruction set {best}, N = {changed}, {rounds} rounds")
    for name, value in median.items():
        print(f"{name:<14} {1e9 * value / cells**3:8.4f} ns per cell (minimum "
              f"{1e9 * min(spent[name]) / cells**3:8.4f})   {1e3 * value:8.4f} ms   "
              f"{value / median['copy']:7.3f} copies")
    each = (median["displace N"] - median["displace 0"]) / changed
    print(f"displace: {1e6 * each:.4f} us per changed cell beyond the comparison")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
