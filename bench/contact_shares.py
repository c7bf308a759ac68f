# SPDX-License-Identifier: GPL-2.0-only
"""Where the time of a step goes in scenes with contact: ``python bench/contact_shares.py [scene ...]``; needs Linux's ``perf``.

Each scene runs to its middle on one thread; the steps from there on are sampled. A row has the parts of the samples by what the
functions do, in per cent.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import one_thread  # noqa: F401
from contact_time import MIDDLE, NAMES, SCENES
from timing import markdown

SECONDS = 4.0
"""Processor time that is sampled."""
PARTS = {
    "contacts": r"anonymous namespace\)::push|push_at_plane|add_at_plane|find_points|add_to_|::push\b|::push_"
    r"|(Object|Plane)Field::(add|begin|end)",
    "looks": r"look|sight|is_near|cell_nearest|outer_around|PointSearch|OuterCells::nearest|judge|evaluate|find_facing"
    r"|put_off|fetch|find_due|slack|MaterialSearch|[oO]utline",
    "crushed cells": r"volume_of_cell|find_crushed",
    "hand-over": r"FixMdanimContact::add_forces|move_to|move_particles|tell_places|early_participants|take_external|FieldSums"
    r"|goes_on_resting",
    "springs and motion": r"pass_of_range|feel_strip|[vV]erlet|PassRun|PassEngine|SimdBlocks|Leapfrog",
    "lists and the rest": r".",
}
"""Names of functions; the first part that fits counts."""


def shares(name: str) -> Counter:
    """Per cent of the samples of a scene by parts."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    plan = prepare(load_scene(SCENES / f"{name}.txt")).plan
    with Instance(plan) as instance, tempfile.TemporaryDirectory() as folder:
        instance.lammps.lmp.command("run_style verlet/mdanim threads 1")
        instance.setup()
        instance.run(round(MIDDLE * plan.certificate.steps))
        data = Path(folder) / "perf.data"
        words = ["perf", "record", "-q", "-e", "cpu-clock", "-F", "2000", "-o", data, "-p", str(os.getpid())]
        with subprocess.Popen(words, stderr=subprocess.DEVNULL) as perf:
            time.sleep(1.0)  # until it samples
            start = time.process_time()
            while time.process_time() - start < SECONDS:
                instance.run(100)
            perf.send_signal(2)
        told = subprocess.run(
            ["perf", "report", "-i", data, "--no-children", "-g", "none", "--sort", "sym"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
    found: Counter = Counter()
    for percent, symbol in re.findall(r"^\s+([\d.]+)%\s+\[.\]\s+(.*)$", told, re.MULTILINE):
        found[next(part for part, names in PARTS.items() if re.search(names, symbol))] += float(percent)
    return found


def main(names: tuple[str, ...] = NAMES) -> None:
    """Print a table in Markdown."""
    print(
        markdown(
            ["scene", *PARTS], [[name, *(f"{found[part]:.0f}" for part in PARTS)] for name in names for found in [shares(name)]]
        )
    )


if __name__ == "__main__":
    main(*([tuple(sys.argv[1:])] if sys.argv[1:] else []))
