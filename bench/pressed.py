# SPDX-License-Identifier: GPL-2.0-only
"""Cost of contact: two blocks pressed together, and the same two apart: ``python bench/pressed.py [cells] [rounds]``.

Two blocks of cells^3 cells, under each law of contact. At rest: one lies on the other. In a blow: they meet head on at a tenth of
the wave speed and are taken where they are pressed most. Apart: the very same particles, one block moved so far away that contact
is on and has nothing to do. Every round goes on from the same state.
"""

import dataclasses
import itertools
import sys
import time

import numpy as np
import one_thread  # noqa: F401
from timing import Sample, interleaved, markdown

STUFF = "density 1000  elasticity 1 MPa"
BLOW = f"""
object a {{{{ shape box ({{n}}, {{n}}, {{n}}) cm  position (-{{x}}, 0, 0) cm  {STUFF}  velocity ({{v}}, {{drift}}, 0) }}}}
object b {{{{ shape box ({{n}}, {{n}}, {{n}}) cm  position ({{x}}, 0, 0) cm  {STUFF}  velocity (-{{v}}, {{drift}}, 0) }}}}
"""
REST = f"""
gravity (0, 0, -9.81)
object a {{{{ shape box ({{n}}, {{n}}, {{n}}) cm  position (0, 0, 0) cm  {STUFF}  hold faces z }}}}
object b {{{{ shape box ({{n}}, {{n}}, {{n}}) cm  position (0.3, 0.2, {{top}}) cm  {STUFF} }}}}
"""
LAWS = {"paper": "contact-model paper", "surface": "contact-model surface", "friction": "contact-model surface  friction 0.5"}
"""Words of control."""
WAVE = (1.2 * 1e6 / 1000.0) ** 0.5
"""Wave speed of the blocks [m/s]."""
SPEED = 0.05 * WAVE
"""Speed of each block [m/s]."""
DRIFT = 0.1 * WAVE
"""Speed of all, sideways [m/s]: a common motion makes no new lists, but must be looked at now and then."""
APART = 5
"""How far one block is moved away, in edges."""
SETTLING = 125
"""Steps of a block at rest, for each cell across."""
STEPS, WARM = 50, 5
"""Steps of a round, and those before its clock starts."""
FRESH = 3
"""Times that both are made anew: where particles come to lie in memory may make a tenth."""


GOALS = {"rest": 1.4, "blow": 1.6}
"""Ratios of 12^3 cells, pressed over apart, where surfaces touch."""


class Blocks:
    """Two blocks in LAMMPS, pressed, and the state that rounds start from."""

    def __init__(self, cells: int, law: str, meeting: str, away: float = 0.0):
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import parse_scene

        blow = meeting == "blow"
        text = BLOW.format(n=cells, x=0.5 * cells + 0.5, v=SPEED, drift=DRIFT) if blow else REST.format(n=cells, top=cells)
        ready = prepare(parse_scene(f"{text}control {{ time 100 s  resolution 1 cm  {LAWS[law]} }}\n"))
        self.instance = Instance(ready.plan)
        self.instance.setup()
        self.particles = ready.system.particles
        energy = 0.0
        while blow and (energy == 0.0 or self.instance.fix_scalar("contact") > energy):
            energy = self.instance.fix_scalar("contact")
            self.instance.run(20)
        if not blow:
            self.instance.run(SETTLING * cells)
        self.touching = self.instance.fix_value("contact", 2 if law == "paper" else 5)
        self.state = self.instance.state()
        self.state.x[ready.system.object == 1] += away * np.array((1, 0, 0) if blow else (0, 0, 1))
        if away:
            self.state = dataclasses.replace(self.state, records={})  # of contacts that are over

    def round(self) -> float:
        """Processor seconds of a particle-step."""
        self.instance.put(0, self.state)
        self.instance.run(WARM)
        start = time.thread_time()
        self.instance.run(STEPS)
        return (time.thread_time() - start) / STEPS / self.particles


def measure(rounds: int = 15, quick: bool = False, sizes: tuple[int, ...] = (12, 20)) -> list[dict]:
    """One row for each size, law and meeting."""
    rows = []
    for cells, law, meeting in itertools.product(sizes[:1] if quick else sizes, LAWS, ("rest", "blow")):
        found: dict[str, Sample] = {}
        for _ in range(FRESH):
            pair = {"pressed": Blocks(cells, law, meeting), "apart": Blocks(cells, law, meeting, APART * cells * 0.01)}
            for name, s in interleaved({name: blocks.round for name, blocks in pair.items()}, rounds).items():
                found[name] = Sample((found[name].values if name in found else ()) + s.values)
            for blocks in pair.values():
                blocks.instance.close()
        pressed = pair["pressed"]
        rows.append(
            {
                "cells": cells,
                "law": law,
                "meeting": meeting,
                "particles": pressed.particles,
                "touching": pressed.touching,
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
            "law",
            "pressed by",
            "particles",
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
                r["law"],
                {"rest": "weight", "blow": "a blow"}[r["meeting"]],
                r["particles"],
                r["touching"],
                *(f"{r[k]['median']:.1f} ({r[k]['least']:.1f})" for k in ("apart", "pressed")),
                r["ratio"]["medians"],
                r["ratio"]["minima"],
                "" if r["cells"] != 12 else f"≤ {1.3 if r['law'] == 'paper' else GOALS[r['meeting']]}",
            )
            for r in rows
        ],
    )


def main(cells: int = 12, rounds: int = 15) -> None:
    """Measure and print."""
    print(table(measure(rounds, sizes=(cells,))))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
