# SPDX-License-Identifier: GPL-2.0-only
"""Sheets of open meshes in runs: a hat of a file that falls on a ball, joints that hold on to it, and edges too long for it."""

from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.cost import later
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

MESHES = Path(__file__).parents[2] / "scenes" / "meshes"
HAT = """object hat {{ shape mesh "hat.stl" scale 0.01 sheet thickness 3 mm  position {place} m  density 400  elasticity 2 MPa
  damping 0.2  friction 0.4  {more} }}
"""
DOWN = "gravity (0, 0, -9.81) m/s^2\n"
BALL = "object ball { shape sphere 9 cm  position (0, 0, 0.3) m  density 500  elasticity rigid  hold all  friction 0.4 }\n"


def ready_of(text: str, time: float, more: str = "accuracy preview"):
    return prepare(parse_scene(f"{text}control {{ time {time} s  {more} }}\n", folder=MESHES))


def test_a_hat_falls_on_a_ball_and_stays():
    """The ball's top stops its crown from inside, and no particle is in the ball."""
    ready = ready_of(DOWN + BALL + HAT.format(place="(0, 0, 0.36)", more=""), 0.25)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(0.25 / ready.certificate.timestep))
        x = instance.array("x").copy()
    x = x[ready.system.first[1] :]
    far = np.linalg.norm(x - (0.0, 0.0, 0.3), axis=1)
    assert far.min() > 0.09 - 0.003 and 0.385 < x[:, 2].max() < 0.42


@pytest.mark.parametrize("part", ["top", "crown", "brim"])
def test_a_hat_hangs_by_a_joint(part):
    """On its top, the side of its crown, or its brim: the particles that it holds stay where they are to a part of a spacing,
    the others swing down, and nothing is gained."""
    x = ready_of(HAT.format(place="(0, 0, 1)", more=""), 0.1).system.position
    far = {"top": x[:, 2], "crown": x[:, 0] + 2.0 * np.minimum(x[:, 2], 1.03), "brim": x[:, 1]}[part]
    at = x[far.argmax()]
    joint = f"joint ball hat world {{ at ({float(at[0])!r}, {float(at[1])!r}, {float(at[2])!r}) m }}\n"
    ready = ready_of(DOWN + HAT.format(place="(0, 0, 1)", more="") + joint, 0.3)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(0.3 / ready.certificate.timestep))
        there = instance.array("x").copy()
    way = np.linalg.norm(there - ready.system.position, axis=1)
    held = np.linalg.norm(ready.system.position - at, axis=1).argmin()
    assert way[held] < 0.1 * ready.system.spacing[0]
    assert part == "top" or way.max() > 0.1


def test_edges_too_long_for_the_surface_are_refused():
    """They folded it up into places with two particles, and `check` ended in a traceback; its coarser copy is left out."""
    with pytest.raises(SceneError, match=r"no triangles with edges of about 18 cm.*\n.*\n.*write a finer resolution"):
        ready_of(HAT.format(place="(0, 0, 1)", more="resolution 18 cm"), 1.0)
    coarse = later._coarser(ready_of(DOWN + BALL + HAT.format(place="(0, 0, 0.5)", more=""), 0.5))
    assert coarse is not None and coarse.context.spacing.h < 0.18
