# SPDX-License-Identifier: GPL-2.0-only
"""mdanim-lammps: ``ours.py SCENE JSON``; with a ``lattice`` it also leaves its particles and springs there for others to take."""

import numpy as np
from clock import run, tell, words

SCENES = {
    "cube": """
gravity (0, 0, -9.81)
ground z 0
object cube {{ shape box (1, 1, 1) m  position (0, 0, {z}) m  density {density}  elasticity {young} Pa }}
control {{ time {time} s  resolution {h} m  timestep {step} }}
""",
    "cantilever": """
gravity (0, 0, -{gravity})
object bar {{ shape box ({length}, {thickness}, {thickness}) m  position (0, 0, 1) m  density {density}  elasticity {young} Pa
  hold face -x }}
control {{ time {time} s  resolution {h} m }}
""",
    "float": """
gravity (0, 0, -9.81)
liquid water {{ basin from (0, 0, 0) m to ({width}, {width}, 1.2) m  density 1000  level {level} m  drag 4  model surface }}
object box {{ shape box ({side}, {side}, {side}) m  position ({middle}, {middle}, {z}) m  density {density}  elasticity 1 MPa }}
control {{ time {time} s  resolution {h} m }}
""",
}
AUTO = 0.5
"""Time step over the certified bound of ``timestep auto``."""


def main() -> None:
    """Measure one scene."""
    from mdanim_lammps import __version__
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    scene, case = words()
    text = SCENES[scene]
    ready = prepare(parse_scene(text.format(**case, step="auto")))
    if case.get("fraction", AUTO) != AUTO:
        # As long as whole steps fit a frame: the next shorter step that does.
        step = case["fraction"] * ready.certificate.bound
        ready = prepare(parse_scene(text.format(**case, step=f"{step!r} s")))
    plan, system, dt = ready.plan, ready.system, ready.certificate.timestep
    if "lattice" in case:
        stiffness, length = plan.coefficients[plan.bond_kind - 1, :2].T
        np.savez(
            case["lattice"],
            position=system.position,
            mass=system.mass,
            pair=plan.bonds,
            stiffness=stiffness,
            length=length,
            dt=dt,
        )
    with Instance(plan) as instance:
        instance.setup()
        chunk = ready.certificate.steps_per_frame
        start = instance.array("x").copy()
        found = run(instance.run, dt, case["time"], case["limit"], chunk)
        moved = instance.array("x") - start
    figures = {"cells": plan.grid.cells} if plan.grid else {}
    if scene == "cantilever":
        figures["error"] = None if found["extrapolated"] else -np.average(moved[:, 2], weights=system.mass) / case["exact"] - 1.0
    tell(version=__version__, nodes=system.particles, **found, **figures)


if __name__ == "__main__":
    main()
