# SPDX-License-Identifier: GPL-2.0-only
"""Limits of this machine, on one core: ``python bench/limits.py``; needs a C++ compiler.

A particle-step that reads and writes positions and velocities moves 96 bytes, and 18 springs at half each are 9 square roots and
divisions: neither can be beaten by code that does the same arithmetic with the same bits.
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


def table(rows: list[dict]) -> str:
    """In Markdown."""
    r = rows[0]
    return markdown(
        ["limit of one core", "measured", "ns per particle-step"],
        [
            ("triad in memory", f"{r['triad_memory']:.1f} GB/s", f"{r['memory']:.1f} ({BYTES} bytes)"),
            ("triad in cache, 0.6 MB", f"{r['triad_cache']:.1f} GB/s", f"{r['cache']:.1f}"),
            ("square root and division", f"{r['divider']:.2f} ns", f"{r['roots']:.1f} ({ROOTS} of them)"),
        ],
    )


if __name__ == "__main__":
    print(table(measure()))
