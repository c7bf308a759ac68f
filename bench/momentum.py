# SPDX-License-Identifier: GPL-2.0-only
"""How near to 0 the momentum of a liquid with all that it touches stays: ``python bench/momentum.py``.

Printed is a table of docs/physics-liquid.md, along x. Scenes are those of tests/effects/test_momentum_at_work.py, and a dam.
"""

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.liquid.frames import momenta
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from timing import markdown

DAM = """
liquid lake {{
  basin from (0, 0, 0) m to (2, 0.2, 0.6) m  density 1000  level 0.25 m  fill from (0, 0, 0) m to (1, 0.2, 0.6) m  calm 1000 s
}}
object block {{ shape box (20, 20, 10) cm  position (1.6, 0.1, {}) m  density 2000  elasticity 1 MPa  hold all }}
control {{ time 3 s  resolution 2.5 cm }}
"""
LAKE = """
liquid lake {{ basin from (-2, -1.5, 0) m to (2, 1.5, 0.8) m  density 1000  level 0.4 m {} }}
object hull {{ shape {}  position (0, 0, 0.4) m  velocity ({}, 0, 0) m/s  density 500  elasticity 400 kPa }}
control {{ time 3 s  resolution 5 cm }}
"""
SLENDER, BLUNT = "ellipsoid (50, 16, 16) cm", "box (40, 40, 30) cm"
JET = "inflow from (-1.8, -0.5, 0.2) m to (-1.5, 0.5, 0.3) m rate 0.2 m^3/s velocity (2, 0, 0) m/s"
CASES = [
    ("dam on dry ground, 2 s, from wall to wall and back", DAM.format(3), 2.0),
    ("the same with a block that is held on the floor", DAM.format(0.05), 2.0),
    ("slender hull that glides, until its waves reach a wall, 0.3 s", LAKE.format("", SLENDER, 1.5), 0.3),
    ("the same, 3 s, between walls", LAKE.format("", SLENDER, 1.5), 3.0),
    ("blunt box that starts at 1.5 m/s, 0.3 s", LAKE.format("", BLUNT, 1.5), 0.3),
    ("blunt box that starts at 0.3 m/s, 0.3 s", LAKE.format("", BLUNT, 0.3), 0.3),
    ("hull in a jet along x, 0.4 s", LAKE.format(JET, SLENDER, 0), 0.4),
]


def largest(text: str, time: float) -> np.ndarray:
    """Largest momentum of the liquid, impulses on basin and solids, and residual, along x until a time [N s], shape (4,)."""
    ready = prepare(parse_scene("gravity (0, 0, -9.81)\n" + text))
    found = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(40):
            instance.run(max(1, round(time / 40 / ready.certificate.timestep)))
            found.append(momenta(instance)[::2])
    return np.abs(found).max(axis=0)


def table() -> str:
    """Table of all cases."""
    rows = [(name, *(f"{n:.2g}" for n in largest(text, time))) for name, text, time in CASES]
    return markdown(["largest until then, N s", "liquid", "basin", "solids", "residual"], rows)


if __name__ == "__main__":
    print(table())
