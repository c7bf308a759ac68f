# SPDX-License-Identifier: GPL-2.0-only
"""Processor time of a step with layers on layers, and without: ``python bench/folds.py`` (docs/physics-folds.md)."""

import time

from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

STEPS = 2000
HEAD = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\ncontrol { time 1 s }\n"
CLOTH = "density 400 kg/m^3  elasticity 500 kPa  damping 0.3  friction 0.4"


def sheet(name: str, height: float, more: str = "") -> str:
    """A cloth that lies flat."""
    return f"object {name} {{ shape sheet (0.6, 0.6) m thickness 4 mm  position (0, 0, {height}) m  {CLOTH}  {more} }}\n"


TWO = HEAD + sheet("lower", 0.01) + sheet("upper", 0.03)
CASES = {
    "two sheets on each other": TWO,
    "the same, `folds off`": TWO + "effects { folds off }\n",
    "one sheet, `touches-itself yes`": HEAD + sheet("cloth", 0.01, "touches-itself yes"),
    "one sheet": HEAD + sheet("cloth", 0.01),
}


def main() -> None:
    """Print a row for each case."""
    print("| scene | particles | a step [us] | of a particle [ns] |\n| --- | --- | --- | --- |")
    for name, text in CASES.items():
        ready = prepare(parse_scene(text))
        with Instance(ready.plan) as instance:
            instance.setup()
            before = time.process_time()
            instance.run(STEPS)
            took = (time.process_time() - before) / STEPS
        particles = ready.system.particles
        print(f"| {name} | {particles} | {1e6 * took:.0f} | {1e9 * took / particles:.0f} |", flush=True)


if __name__ == "__main__":
    main()
