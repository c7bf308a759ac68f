# SPDX-License-Identifier: GPL-2.0-only
"""Objects in air against closed forms: ``python bench/air.py [closed|flag]``.

The tables are those of docs/physics-air.md; scenes and closed forms are in tests/lab/air_cases.py.
"""

import sys
from pathlib import Path

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import air_cases

FLAG = """air {{ wind ({wind}, 0, 0) m/s }}
object flag {{ shape sheet (60, 40) cm thickness 1 mm  position (0, 0, 0) m  orientation axis (1, 0, 0) angle 90 deg
  density 300  elasticity 1 MPa  hold face -x  resolution 4 cm }}
control {{ time 6 s }}
"""
KICK = 0.3
"""Speed of its particles at the start [m/s]."""


def flag() -> tuple[list[str], list[list]]:
    """Speed across a steady wind of a flag without weight that begins with a random one: it dies away or stays."""
    rows = []
    for wind in (1, 3, 5, 7, 9, 20):
        ready = prepare(parse_scene(FLAG.format(wind=wind)))
        with Instance(ready.plan) as instance:
            v = instance.array("v")
            v[~ready.system.held, 1] = KICK * np.random.default_rng(1).normal(size=int((~ready.system.held).sum()))
            instance.setup()
            found = []
            for _ in range(100):
                instance.run(round(0.05 / ready.certificate.timestep))
                found.append(float((instance.array("v")[:, 1] ** 2).mean()))
        rows.append([wind, *(f"{np.sqrt(np.mean(found[a:b])):.3f}" for a, b in ((0, 10), (40, 50), (90, 100)))])
    return ["wind [m/s]", "until 0.5 s [m/s]", "2 to 2.5 s", "4.5 to 5 s"], rows


TABLES = {"closed": lambda: air_cases.closed_rows(air_cases.CASES), "flag": flag}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
