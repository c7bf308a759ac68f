# SPDX-License-Identifier: GPL-2.0-only
"""Limits of this machine, on one core: ``python bench/limits.py``; needs a C++ compiler.

A particle-step that reads and writes positions and velocities moves 96 bytes, and 18 springs at half each are 9 square roots and
divisions, eight loads and three stores for each of them in a pass that goes from block to block: none can be beaten by code that
does the same arithmetic with the same bits in this order.
"""

import json
import os
import subprocess
import tempfile
from pathlib import Path

import one_thread  # noqa: F401
from timing import markdown

SOURCE = Path(__file__).with_suffix(".cpp")
BYTES, ROOTS = 96, 9
"""Bytes and roots of a particle-step."""


def measure(rounds: int = 7, quick: bool = False) -> list[dict]:
    """One row."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "limits"
        subprocess.run(
            [os.environ.get("CXX", "c++"), "-std=c++17", "-O3", "-march=native", "-fno-math-errno", SOURCE, "-o", program],
            check=True,
            timeout=120,
        )
        found = json.loads(subprocess.run([program], check=True, capture_output=True, text=True, timeout=120).stdout)
    return [
        found
        | {"memory": BYTES / found["triad_memory"], "cache": BYTES / found["triad_cache"], "roots": ROOTS * found["divider"]}
    ]


def of_scene(found: dict, springs: float, in_cache: bool) -> dict[str, float]:
    """Least nanoseconds of a particle-step with so many springs for each particle, by what is limited: roots, loads and stores,
    and bytes where the particles do not fit into a cache."""
    limits = {"roots": springs * found["divider"], "loads and stores": springs * found["moves"]}
    return limits if in_cache else limits | {"memory": found["memory"]}


def table(rows: list[dict]) -> str:
    """In Markdown."""
    r = rows[0]
    return markdown(
        ["limit of one core", "measured", "ns per particle-step"],
        [
            ("triad in memory", f"{r['triad_memory']:.1f} GB/s", f"{r['memory']:.1f} ({BYTES} bytes)"),
            ("triad in cache, 0.6 MB", f"{r['triad_cache']:.1f} GB/s", f"{r['cache']:.1f}"),
            ("square root and division", f"{r['divider']:.2f} ns", f"{r['roots']:.1f} ({ROOTS} of them)"),
            ("loads and stores of a spring", f"{r['moves']:.2f} ns", f"{ROOTS * r['moves']:.1f} ({ROOTS} of them)"),
        ],
    )


if __name__ == "__main__":
    print(table(measure()))
