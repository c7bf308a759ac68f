# SPDX-License-Identifier: GPL-2.0-only
"""Bytes of memory per particle: ``python bench/memory.py``.

A free cube in a process of its own: what it holds of memory (resident) after modelling, in the run, and the peak of all, less
what it held before the scene was read.
"""

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import one_thread  # noqa: F401
from timing import markdown

SCENE = """
gravity (0, 0, -9.81)
object cube {{ shape box ({n}, {n}, {n}) cm  position (0, 0, 0)  density 1000  elasticity 1 MPa }}
control {{ time 1 s  resolution 1 cm }}
"""
GOALS = {"run": 0.6, "peak": 1.5}
"""Kilobytes per particle: in the run, and with modelling."""


def resident() -> int:
    """Bytes that this process holds."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def child(n: int) -> dict:
    """In a process of its own."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    with Instance(prepare(parse_scene(SCENE.format(n=3))).plan) as small:  # all libraries are loaded by now
        small.setup()
    before = resident()
    ready = prepare(parse_scene(SCENE.format(n=n)))
    plan = ready.plan
    modelled = resident()
    with Instance(plan) as instance:
        instance.setup()
        instance.run(20)
        running = resident()
    # The peak is of the whole process, in kB.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    particles = plan.system.particles
    return {
        "particles": particles,
        "springs": len(plan.bonds),
        "model": (modelled - before) / particles,
        "lammps": (running - modelled) / particles,
        "run": (running - before) / particles,
        "peak": (peak - before) / particles,
    }


def measure(rounds: int = 1, quick: bool = False) -> list[dict]:
    """One row for each size; memory does not vary, so there is one round."""
    rows = []
    for n in (29,) if quick else (29, 59, 99):
        done = subprocess.run(
            [sys.executable, __file__, "child", str(n)], check=True, capture_output=True, text=True, timeout=300
        )
        rows.append(json.loads(done.stdout))
    return rows


def table(rows: list[dict]) -> str:
    """In Markdown."""
    return markdown(
        [
            "particles",
            "springs",
            "scene, model and plan [kB per particle]",
            "LAMMPS and plugin",
            "both, in the run",
            "peak, modelling included",
        ],
        [(r["particles"], r["springs"], *(1e-3 * r[k] for k in ("model", "lammps", "run", "peak"))) for r in rows]
        + [("goal", "", "", "", *(f"≤ {GOALS[k]}" for k in ("run", "peak")))],
    )


if __name__ == "__main__":
    if sys.argv[1:2] == ["child"]:
        print(json.dumps(child(int(sys.argv[2]))))
    else:
        print(table(measure()))
