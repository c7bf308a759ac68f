# SPDX-License-Identifier: GPL-2.0-only
"""Time of contact in scenes where objects lie on each other: ``python bench/contact_time.py [rounds [scene ...]]``.

Each scene runs to its middle, then rounds of steps from there on take turns: processor time of a step on one thread, looks at
points that touch nothing, and points in contact. With two builds: run it by turns, ``PYTHONPATH`` names the folder of another
copy of the package, in which its plugin is.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

import one_thread  # noqa: F401
from timing import markdown

SCENES = Path(__file__).resolve().parent.parent / "scenes"
NAMES = ("pile", "plates", "billiard", "crowd")
MIDDLE, STEPS, ROUNDS = 0.5, 300, 5
TOUCHING, LOOKS = 5, 14
"""Entries of the vector of fix mdanim/contact."""


def measure(name: str, rounds: int) -> list[str]:
    """Row of one scene."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    plan = prepare(load_scene(SCENES / f"{name}.txt")).plan
    with Instance(plan) as instance:
        instance.lammps.lmp.command("run_style verlet/mdanim threads 1")
        instance.setup()
        instance.run(round(MIDDLE * plan.certificate.steps))
        took, looks, touching = [], [], []
        for _ in range(rounds):
            before, start = instance.fix_value("contact", LOOKS), time.process_time()
            instance.run(STEPS)
            took.append(1e6 * (time.process_time() - start) / STEPS)
            looks.append((instance.fix_value("contact", LOOKS) - before) / STEPS)
            touching.append(instance.fix_value("contact", TOUCHING))
    figures = (statistics.median(took), min(took), statistics.mean(looks), statistics.mean(touching))
    return [name, str(plan.system.particles), *(f"{x:.0f}" for x in figures)]


def main(rounds: int = ROUNDS, names: tuple[str, ...] = NAMES) -> None:
    """Print a table in Markdown."""
    columns = ["scene", "particles", "us per step, median", "minimum", "looks per step", "in contact"]
    print(markdown(columns, [measure(name, rounds) for name in names]))


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:2]), *([tuple(sys.argv[2:])] if sys.argv[2:] else []))
