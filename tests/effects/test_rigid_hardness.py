# SPDX-License-Identifier: GPL-2.0-only
"""How hard rigid objects are where they touch follows from what may happen on their ways, not from the time of the scene."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.rigid.touching import omega

SCENE = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object cart {{ shape box (20, 20, 10) cm  position (0, 0, 0.05) m  density 600  elasticity rigid  {push} }}
object load {{ shape box (10, 10, 10) cm  position (0, 0, 0.15) m  density 600  elasticity rigid }}
object stone {{ shape sphere 5 cm  position (0.6, 0, 0.05) m  density 600  elasticity rigid }}
control {{ time {time} s  friction 0.4 }}
"""
PUSHES = {"force": "force (20, 0, 0) N", "torque": "torque (0, 0, 1) N*m", "none": "velocity (1, 0, 0) m/s"}


@pytest.mark.parametrize("push", PUSHES)
def test_a_scene_that_is_watched_for_longer_moves_alike(prepared, push):
    """To the bit, as long as both go on."""
    found = []
    for time in (0.4, 1.0, 4.0):
        ready = prepared(SCENE.format(push=PUSHES[push], time=time))
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(round(0.4 / ready.certificate.timestep))
            found.append((omega(ready.context), ready.certificate.timestep, ready.system.center_of_mass(instance.array("x"))))
    for other in found[1:]:
        assert other[:2] == found[0][:2] and np.array_equal(other[2], found[0][2])


def test_what_is_pushed_into_the_ground_is_as_hard_as_that_asks(prepared):
    """One object alone, 5 m above the ground: the push counts on its way there."""
    text = """gravity (0, 0, -9.81) m/s^2
    ground z 0 m
    object ball { shape sphere 5 cm  position (0, 0, 5.05) m  density 600  elasticity rigid  force (0, 0, -30) N }
    control { time 1 s }
    """
    ready = prepared(text)
    mass = ready.system.mass_of[0]
    speed = np.sqrt(2 * (9.81 + 30 / mass) * 5.0)
    assert speed <= omega(ready.context) * 0.02 * 0.1 < 2.0 * speed
