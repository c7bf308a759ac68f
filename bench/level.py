# SPDX-License-Identifier: GPL-2.0-only
"""Cost of the level rule and of the surface: ``python bench/level.py [cells] [rounds]``.

A basin of cells^3 cells, half full, with a body of a third of its width afloat; calls in interleaved rounds,
medians in milliseconds.
"""

import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "lab"))


def pools(n: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Cases as (content, solid), each (n, n, n)."""
    random = np.random.default_rng(1)
    z = np.arange(n)[:, None, None]
    half, third = n // 2, n // 3
    nothing = np.zeros((n, n, n), np.uint8)
    body = nothing.copy()
    body[half - third // 2 : half + third // 2, third : 2 * third, third : 2 * third] = 1
    wall = body.copy()
    wall[:, :, n // 4] = 2
    spray = random.random((n, n, n)) < 0.003
    top = random.random((n, n)) < 0.5
    full = lambda height: (z < height).astype(np.uint8)
    level = full(half + top[None])
    waves = full(half + np.rint(random.normal(0.0, 1.0, (n, n)))[None])
    swell = full(half + np.rint(n / 16 * np.sin(np.arange(n) * 4 * np.pi / n))[None, None])
    excess = level.copy()
    excess[half // 2] += random.random((n, n)) < 0.1
    dam = np.where(np.arange(n) < half, full(n - 2), nothing).astype(np.uint8)
    cases = {
        "level": (level, body),
        "level, two vessels": (level, wall),
        "waves": (waves, body),
        "swell": (swell, body),
        "excess in the depth": (excess, body),
        "spray over a pool": (np.where((z > half + 3) & spray, 1, waves).astype(np.uint8), body),
        "waves, two vessels": (waves, wall),
        "dam": (dam, nothing),
    }
    outside = lambda content, solid: np.where(solid > 0, 0, content).astype(np.uint8)
    return {name: (outside(content, solid), solid) for name, (content, solid) in cases.items()}


def main(n: int = 128, rounds: int = 15) -> None:
    """Measure and print."""
    import level_lab as lab

    seconds: dict[tuple[str, str], list[float]] = {}
    moved = {}

    def timed(case: str, what: str, call):
        start = time.perf_counter()
        result = call()
        seconds.setdefault((case, what), []).append(time.perf_counter() - start)
        return result

    cases = pools(n)
    made = {name: lab.Pool(*cells) for name, cells in cases.items()}
    for _ in range(rounds):
        for name, cells in cases.items():
            made[name].set(*cells)
            moved[name] = timed(name, "move", made[name].move)
            timed(name, "heights", lambda: made[name].heights(just_moved=True))
    print(f"{n}^3 cells, {rounds} rounds; milliseconds, medians")
    print(f"{'':<24}{'move':>9}{'heights':>9}   units moved")
    for name in cases:
        move, heights = (1e3 * statistics.median(seconds[name, what]) for what in ("move", "heights"))
        print(f"{name:<24}{move:9.3f}{heights:9.3f}{moved[name]:12d}")

    random = np.random.default_rng(2)
    rough = random.normal(0.0, 1.0, (n, n))
    hidden = rough.copy()
    hidden[n // 3 : 2 * n // 3, n // 3 : 2 * n // 3] = np.nan
    wall = np.zeros((n, n), np.uint8)
    wall[:, n // 4] = 1
    surfaces = {
        "constant": (np.ones((n, n)), None),
        "rough": (rough, None),
        "rough, body": (hidden, None),
        "rough, body, wall": (hidden, wall),
    }
    for _ in range(rounds):
        for name, (height, blocked) in surfaces.items():
            timed(name, "smooth", lambda: lab.smooth(height, blocked))
    print(f"smooth surface of {n}^2 columns")
    for name in surfaces:
        print(f"{name:<24}{1e3 * statistics.median(seconds[name, 'smooth']):9.3f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
