# SPDX-License-Identifier: GPL-2.0-only
"""mdanim-lammps: ``ours.py SCENE JSON``; a way is the ``contact-stiffness`` of rigid bodies; with a ``lattice`` it also leaves
its particles and springs there for others to take."""

import numpy as np
import rigid_bodies
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
RIGID = """
gravity (0, 0, -9.81)
ground z 0
{walls}
{objects}
control {{ time {time} s  friction {friction}  {more} }}
"""
AUTO = 0.5
"""Time step over the certified bound of ``timestep auto``."""


def rigid_text(scene: str, case: dict) -> str:
    """Text of a scene of rigid bodies."""
    bodies, wall = rigid_bodies.SCENES[scene](case)
    triple = lambda numbers: "(" + ", ".join(f"{float(x)!r}" for x in numbers) + ")"
    objects = "".join(
        f"object {b.name} {{ shape {'box ' + triple(b.size) if len(b.size) == 3 else f'sphere {b.size[0]}'} m  elasticity rigid\n"
        f"  position {triple(b.position)} m  orientation axis {triple(b.axis)} angle {float(b.angle)!r} rad\n"
        f"  density {b.density}  velocity ({b.speed}, 0, 0) m/s }}\n"
        for b in bodies
    )
    walls = "" if wall is None else f"walls from ({-wall}, {-wall}, -1) m to ({wall}, {wall}, 100) m"
    more = f"contact-stiffness {way}" if (way := case.get("way")) else ""
    return RIGID.format(walls=walls, objects=objects, time=case["time"], friction=rigid_bodies.FRICTION, more=more)


def overlap(scene: str, case: dict, system, position: np.ndarray) -> float:
    """Largest overlap of rigid bodies over their smallest size, see rigid_bodies.deepest; positions of particles [m]."""
    bodies, wall = rigid_bodies.SCENES[scene](case)
    centre = system.center_of_mass(position)
    turned = []
    for m, (a, b) in enumerate(zip(system.first, system.first[1:])):
        arm, was = position[a:b] - centre[m], system.position[a:b] - system.position[a:b].mean(axis=0)
        u, _, v = np.linalg.svd(arm.T @ was)
        turned.append(u @ np.diag((1.0, 1.0, np.linalg.det(u @ v))) @ v)
    axis = np.array([b.axis for b in bodies])
    start = rigid_bodies.rotations(axis, np.array([b.angle for b in bodies]))
    return rigid_bodies.deepest(bodies, wall, centre, np.array(turned) @ start)


def main() -> None:
    """Measure one scene."""
    from mdanim_lammps import __version__
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    scene, case = words()
    text = SCENES[scene] if scene in SCENES else rigid_text(scene, case).replace("{", "{{").replace("}", "}}")
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
        end = instance.array("x").copy()
        moved = end - start
    figures = {"cells": plan.grid.cells} if plan.grid else {}
    if scene == "cantilever":
        figures["error"] = None if found["extrapolated"] else -np.average(moved[:, 2], weights=system.mass) / case["exact"] - 1.0
    if scene in rigid_bodies.SCENES:
        stiffness = f"contact-stiffness {way}, " if (way := case.get("way")) else ""
        figures["note"] = f"{stiffness}overlap at the end {overlap(scene, case, system, end):.2g}"
        tell(version=__version__, nodes=len(system.names), **found, **figures)
        return
    tell(version=__version__, nodes=system.particles, **found, **figures)


if __name__ == "__main__":
    main()
