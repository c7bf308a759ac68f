# SPDX-License-Identifier: GPL-2.0-only
"""Objects that touch by the law of surfaces: ``mpiexec -n N python bodies.py SCENE OUT.npz``."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from mdanim_lammps.effects import Effect
from mdanim_lammps.effects.fields import column
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.plan import Plan
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

SCENE = """
object anvil {{ shape box (16, 16, 8) cm position (0, 0, 0) cm density 1000 elasticity 1 MPa hold all }}
object block {{ shape {shape} position (1, 0.5, 10.1) cm density 1000 elasticity 1 MPa velocity (0, 0, -1) m/s }}
object brick {{ shape box (16, 16, 8) cm position (0, 30, 0) cm density 1000 elasticity 1 MPa }}
control {{ time 0.1 s resolution 2 cm timestep 0.05 ms }}
"""
STEPS = 400


class Surfaces(Effect):
    """Contact at drawn surfaces, and nothing else that its fix can do."""

    name = fix = "surfaces"

    def columns(self, context):
        system = context.system
        return {
            column("body", "1"): system.contact_kind[system.object].astype(float),
            column("young", "Pa"): system.young[system.object],
        }

    def commands(self, context):
        return ["fix surfaces mobile mdanim/contact d_body d_young 0.0 objects"]


def with_surfaces(plan: Plan) -> Plan:
    """A plan with the springs alone, and that effect."""
    effect = Surfaces()
    declared = effect.columns(plan.context)
    columns, fields = {f.name: values for f, values in declared.items()}, {f.name: f for f in declared}
    effects = (*(e for e in plan.effects if e.name == "springs"), effect)
    asked = {e.name: plan.asked.get(e.name, tuple(columns)) for e in effects}
    return replace(plan, effects=effects, columns=columns, fields=fields, asked=asked)


def scene(shape: str = "box (12, 12, 12) cm") -> str:
    """A block, or a ball, that falls on an anvil from 1 mm above; a brick of the anvil's shape is aside."""
    return SCENE.format(shape=shape)


def film(instance: Instance) -> np.ndarray:
    """Places, velocities and forces after some steps, shape (3, N, 3)."""
    instance.setup()
    instance.run(STEPS)
    state = instance.state()
    return np.array([state.x, state.v, state.f])


def main(path: Path, out: str) -> None:
    """Film on all ranks."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    with Instance(with_surfaces(prepare(load_scene(path)).plan), comm) as instance:
        found = film(instance)
    if comm.rank == 0:
        np.save(out, found)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
