# SPDX-License-Identifier: GPL-2.0-only
"""Many small objects: ``python bench/objects.py [side]`` builds side^2 cubes of 27 particles over a ground and runs them.

Prints seconds and memory of every stage, and the cost per particle-step while they fall and meet.
"""

import resource
import sys
import time
from pathlib import Path

import one_thread  # noqa: F401

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "lab"))


def main(side: int = 100) -> None:
    """Measure and print."""
    from crowd_text import TEXT
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    start = time.perf_counter()

    def lap(what: str, note: str = "") -> None:
        nonlocal start
        now = time.perf_counter()
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(f"{what:<12} {now - start:6.2f} s   {memory:5.2f} GB  {note}")
        start = now

    scene = parse_scene(TEXT.replace("0 .. 99", f"0 .. {side - 1}"))
    lap("scene", f"{len(scene.solids)} objects")
    ready = prepare(scene)
    lap("prepare", f"{ready.system.particles} particles")
    with Instance(ready.plan) as instance:
        lap("insert")
        instance.setup()
        lap("setup")
        steps = 100
        for _ in range(4):
            before = time.perf_counter()
            instance.run(steps)
            cost = 1e9 * (time.perf_counter() - before) / steps / ready.system.particles
            lap("run", f"{steps} steps, {cost:.0f} ns per particle-step, {instance.fix_value('contact', 2):.0f} pairs in touch")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
