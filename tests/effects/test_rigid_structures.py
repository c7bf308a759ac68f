# SPDX-License-Identifier: GPL-2.0-only
"""Rigid objects that stand by friction alone stay where they are."""

import re
from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene, parse_scene
from paths import SCENES

STACK = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
repeat i in 1 .. 10 {{
  object cube[i] {{ shape box (10, 10, 10) cm  position (0, 0, 10*i - 5) cm  density 600 kg/m^3  elasticity rigid }}
}}
control {{ time {seconds} s  friction 0.5 }}
"""


def centres(scene, *times: float) -> np.ndarray:
    """Centres of mass of all objects at these times [m], shape (T, M, 3)."""
    ready, done, found = prepare(scene), 0, []
    with Instance(ready.plan) as instance:
        instance.setup()
        for time in times:
            steps = round(time / ready.certificate.timestep)
            instance.run(steps - done)
            done = steps
            found.append(ready.system.center_of_mass(instance.array("x")))
    return np.array(found)


def test_an_arch_stands():
    """For ten seconds, without what strikes it in the scene. Each joint gives by the depth at which it bears, so stones sink by
    up to 3 mm; after the first second they slip by 50 um."""
    scene = load_scene(SCENES / "arch.txt")
    stones = tuple(solid for solid in scene.solids if solid.name.startswith("stone"))
    scene = replace(scene, solids=stones, expects=(), control=replace(scene.control, time=10.0))
    start = np.array([stone.position for stone in stones])
    first, last = centres(scene, 1.0, 10.0)
    assert len(stones) == 11 and np.abs(last - start).max() < 5e-3 and np.abs(last - first).max() < 1e-4


def test_a_house_of_cards_stands():
    """For ten seconds: cards.txt with rigid cards."""
    text = (SCENES / "cards.txt").read_text()
    text = re.sub(r"elasticity +2 MPa", "elasticity rigid", re.sub(r"damping .*", "", text)).replace("resolution 2 cm", "")
    scene = parse_scene(text.replace("time 1 s", "time 10 s"), "cards")
    start, first, last = centres(scene, 0.0, 1.0, 10.0)
    assert len(start) == 7 and np.abs(last - start).max() < 1e-3 and np.abs(last - first).max() < 1e-9


@pytest.mark.parametrize("seconds", [6, pytest.param(60, marks=pytest.mark.soak)])
def test_ten_boxes_stand(seconds):
    """They move by less than 1e-3 of a side beyond what they sink in at first."""
    first, last = centres(parse_scene(STACK.format(seconds=seconds), "stack"), 3.0, seconds)
    assert np.abs(last - first).max() < 1e-4
