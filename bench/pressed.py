# SPDX-License-Identifier: GPL-2.0-only
"""What contact costs: two blocks pressed together, and the same two apart: ``python bench/pressed.py [cells] [rounds]``.

Two blocks of cells^3 cells meet head on at a tenth of the wave speed and are taken where they are pressed most. Apart: the very
same particles, one block moved so far away that contact is on and has nothing to do. Every round goes on from the same state.
"""

import sys
import time

from timing import Sample, interleaved, markdown

SCENE = """
object a {{ shape box ({n}, {n}, {n}) cm  position (-{x}, 0, 0) cm  density 1000  elasticity 1 MPa  velocity ({v}, {drift}, 0) }}
object b {{ shape box ({n}, {n}, {n}) cm  position ({x}, 0, 0) cm  density 1000  elasticity 1 MPa  velocity (-{v}, {drift}, 0) }}
control {{ time 100 s  resolution 1 cm }}
"""
WAVE = (1.2 * 1e6 / 1000.0) ** 0.5
"""Wave speed of the blocks [m/s]."""
SPEED = 0.05 * WAVE
"""Of each block [m/s]."""
DRIFT = 0.1 * WAVE
"""Of all, sideways [m/s]: a motion that all share makes no new lists, but must be looked at now and then."""
APART = 5
"""How far one block is moved away, in edges."""
STEPS, WARM = 50, 5
"""Of a round, and those before its clock starts."""
FRESH = 3
"""Times that both are made anew: where particles come to lie in memory may make a tenth."""


class Blocks:
    """Two blocks in LAMMPS, pressed, and the state that rounds start from."""

    def __init__(self, cells: int, away: float = 0.0):
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import parse_scene

        ready = prepare(parse_scene(SCENE.format(n=cells, x=0.5 * cells + 0.5, v=SPEED, drift=DRIFT)))
        self.instance = Instance(ready.plan)
        self.instance.setup()
        self.particles = ready.system.particles
        energy = 0.0
        while energy == 0.0 or self.instance.fix_scalar("contact") > energy:
            energy = self.instance.fix_scalar("contact")
            self.instance.run(20)
        self.touching, self.pairs = self.instance.fix_value("contact", 2), self.instance.fix_value("contact", 1)
        self.state = self.instance.state()
        self.state.x[ready.system.object == 1, 0] += away

    def round(self) -> float:
        """Processor seconds of a particle-step."""
        self.instance.put(0, self.state)
        self.instance.run(WARM)
        start = time.thread_time()
        self.instance.run(STEPS)
        return (time.thread_time() - start) / STEPS / self.particles


def measure(rounds: int = 15, quick: bool = False, sizes: tuple[int, ...] = (12, 20)) -> list[dict]:
    """One row for each size."""
    rows = []
    for cells in sizes[:1] if quick else sizes:
        found: dict[str, Sample] = {}
        for _ in range(FRESH):
            pair = {"pressed": Blocks(cells), "apart": Blocks(cells, APART * cells * 0.01)}
            for name, s in interleaved({name: blocks.round for name, blocks in pair.items()}, rounds).items():
                found[name] = Sample((found[name].values if name in found else ()) + s.values)
            for blocks in pair.values():
                blocks.instance.close()
        pressed = pair["pressed"]
        rows.append(
            {
                "cells": cells,
                "particles": pressed.particles,
                "touching": pressed.touching,
                "pairs": pressed.pairs,
                "ratio": found["pressed"].over(found["apart"]),
            }
            | {name: {"median": 1e9 * s.median, "least": 1e9 * s.least} for name, s in found.items()}
        )
    return rows


def table(rows: list[dict]) -> str:
    """In Markdown."""
    return markdown(
        [
            "two blocks of",
            "particles",
            "pairs listed",
            "in touch",
            "apart [ns per particle-step]",
            "pressed",
            "ratio by medians",
            "by minima",
            "goal",
        ],
        [
            (
                f"{r['cells']}³ cells",
                r["particles"],
                r["pairs"],
                r["touching"],
                *(f"{r[k]['median']:.1f} ({r[k]['least']:.1f})" for k in ("apart", "pressed")),
                r["ratio"]["medians"],
                r["ratio"]["minima"],
                "≤ 1.3" if r["cells"] == 12 else "",
            )
            for r in rows
        ],
    )


def main(cells: int = 12, rounds: int = 15) -> None:
    """Measure and print."""
    print(table(measure(rounds, sizes=(cells,))))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
