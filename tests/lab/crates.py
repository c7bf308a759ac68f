# SPDX-License-Identifier: GPL-2.0-only
"""A scene with the kind of body of features/coarse: ``python crates.py`` prints what becomes of it as JSON.

A program of its own, as features are found when the package is imported.
"""

import json
import os
from pathlib import Path

os.environ["MDANIM_FEATURES"] = str(Path(__file__).parent / "features" / "coarse")

from mdanim_lammps.bodies import kind_of, kinds
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SCENE = """
gravity (0, 0, -10) m/s^2
object block { shape box (20, 20, 20) cm position (1, 0, 1) m density 500 elasticity 1 MPa }
object crate { shape box (10, 10, 10) cm position (0, 0, 1) m density 500 elasticity 1 MPa crate 1 }
control { time 0.1 s }
"""

ready = prepare(parse_scene(SCENE))
spacing, system = ready.context.spacing, ready.system
with Instance(ready.plan) as instance:
    instance.setup()
    instance.run(ready.certificate.steps)
    fallen = (system.position - instance.array("x"))[:, 2]
own = slice(*system.first[1:3])
print(
    json.dumps(
        {
            "asked": [kind.name for kind in kinds()],
            "kinds": [kind_of(solid).name for solid in ready.scene.solids],
            "h": spacing.h,
            "of": spacing.of,
            "memory": [
                spacing.memory - prepare(parse_scene(SCENE.replace(" crate 1 ", " resolution 10 cm "))).context.spacing.memory
            ],
            "particles": system.first.tolist(),
            "mass": [float(system.mass[own].sum()), float(system.mass[own].max() / system.mass[own].min())],
            "fallen": [float(fallen.min()), float(fallen.max())],
        }
    )
)
