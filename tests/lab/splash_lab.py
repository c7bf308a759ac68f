# SPDX-License-Identifier: GPL-2.0-only
"""A splash with everything in it that threads share."""

from __future__ import annotations

import numpy as np
from filming import SOFT, SOLID
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.threads import with_threads
from mdanim_lammps.features.liquid import frames as liquid
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

TEXT = """
gravity (0, 0, -9.81)
ground z 0 m
object a {{ shape box (11, 11, 9) cm position (0, 0, 16) cm {soft} friction 0.3 velocity (0.2, 0, -2) spin (0, 0, 2) }}
object b {{ shape box (5, 5, 5) cm position (1, 0, 23.15) cm {solid} friction 0.3 velocity (0, 0, -3) }}
object c {{ shape sphere 3 cm position (-8, 5, 3) cm {solid} friction 0.3 velocity (0, 1, 0) }}
liquid w {{ basin from (-16, -14, 0) cm to (16, 14, 30) cm density 1000 level 11 cm drag 2 model {model} }}
control {{ time 10 s resolution 1 cm }}
"""
EAGER = "2"
"""In MDANIM_LEAST_TASK: threads share whatever can be shared."""
PIECES = 20, 120, 80
"""Steps: the small box is on the large one after the first piece; the large one begins to splash at the end of the second."""


def splash(model: str, threads: int, comm=None, resume: bool = False) -> dict[str, np.ndarray]:
    """All that a run tells but sums over ranks: places, velocities, forces after each piece, heights of the liquid, what contacts
    remember; and of one process energies. ``resume``: another instance takes up the state before the last piece."""
    plan = prepare(parse_scene(TEXT.format(soft=SOFT, solid=SOLID, model=model))).plan
    told = {}

    def tell(instance: Instance, name: str) -> None:
        for what in "xvf":
            told[f"{name} {what}"] = instance.array(what).copy()
        told[f"{name} smooth"], told[f"{name} raw"] = liquid.heights(instance)
        for fix, found in instance.records().items():
            if fix != "liquid":
                told[f"{name} {fix}"] = found.data

    with with_threads(threads), Instance(plan, comm) as instance:
        instance.setup()
        for number, steps in enumerate(PIECES[:-1]):
            instance.run(steps)
            tell(instance, f"{number}")
        if resume:
            state, step = instance.state(), instance.step
            with Instance(plan, comm) as other:
                other.put(step, state)
                other.run(PIECES[-1])
                tell(other, "end")
            return told
        instance.run(PIECES[-1])
        tell(instance, "end")
        if comm is None:
            values = [e.energy(instance) for e in plan.effects] + [instance.fix_value("liquid", n) for n in (0, 4, 6, 11)]
            told["energies"] = np.array([instance.kinetic_energy(), instance.damping_loss(), *values])
    return told
