# SPDX-License-Identifier: GPL-2.0-only
"""Processor time of a step with layers on layers, and without, and energies of bundles of ropes that are struck:
``python bench/folds.py [cost|bundles]`` (docs/physics-folds.md)."""

import sys
import time

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import Prepared, prepare
from mdanim_lammps.scene.parse import parse_scene
from timing import print_tables

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


def cost() -> tuple[list[str], list[list]]:
    """A row for each case."""
    rows = []
    for name, text in CASES.items():
        ready = prepare(parse_scene(text))
        with Instance(ready.plan) as instance:
            instance.setup()
            before = time.process_time()
            instance.run(STEPS)
            took = (time.process_time() - before) / STEPS
        particles = ready.system.particles
        rows.append([name, particles, f"{1e6 * took:.0f}", f"{1e9 * took / particles:.0f}"])
    return ["scene", "particles", "a step [us]", "of a particle [ns]"], rows


def bundle(rows: int) -> str:
    """Ropes side by side and over each other, so that each has six around it, between walls; a heavy slab falls onto them."""
    thick, apart = 0.01, 0.0105
    wide, high = 0.5 * rows * apart + 0.019, 0.0055 + 0.87 * apart * rows
    lines = ["gravity (0, 0, -9.81) m/s^2\nground z 0 m"]
    for j in range(rows):
        for i in range(rows):
            y, z = (i + 0.5 * (j % 2) - 0.5 * rows) * apart, 0.0055 + 0.87 * apart * j
            ends = f"from (-0.1, {y:.5f}, {z:.5f}) m to (0.1, {y:.5f}, {z:.5f}) m"
            lines.append(f"object rope_{j}_{i} {{ shape rope {ends} thickness {thick} m  density 1000  elasticity 2 MPa")
            lines.append("  touches-itself yes }")
    for side in (-1, 1):
        name, at = ("left", "right")[side > 0], f"(0, {side * wide:.4f}, 0.05) m"
        lines.append(f"object {name} {{ shape box (30, 2, 10) cm  position {at}  elasticity rigid  density 1000  hold all }}")
    lines.append(f"object slab {{ shape box (10, {0.9 * rows:.2f}, 4) cm  position (0, -0.001, {high + 0.04:.4f}) m")
    lines.append("  velocity (0, 0, -2) m/s  density 8000  elasticity rigid }")
    return "\n".join(lines) + "\n"


def bundles() -> tuple[list[str], list[list]]:
    """The residual of energy, over the largest change of one, at the step that is certified and at half of it."""
    found = []
    for rows in (3, 4, 5):
        control = "control {{ time 0.12 s  contact-damping 0  friction 0  {} }}\n"
        ready = prepare(parse_scene(bundle(rows) + control.format("")))
        half = f"timestep {0.5 * ready.certificate.timestep!r} s"
        off = [changed(one, 20) for one in (ready, prepare(parse_scene(bundle(rows) + control.format(half))))]
        found.append([rows**2, *(f"{one:.1e}" for one in off)])
    return ["ropes", "residual", "at half of the step"], found


def changed(ready: Prepared, looks: int) -> float:
    """Change of all energies over the largest change of any."""
    told = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(looks + 1):
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            instance.run(max(1, ready.certificate.steps // looks))
    return float(np.ptp([sum(one.values()) for one in told]) / max(np.ptp([one[name] for one in told]) for name in told[0]))


TABLES = {"cost": cost, "bundles": bundles}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
