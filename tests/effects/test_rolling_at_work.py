# SPDX-License-Identifier: GPL-2.0-only
"""Rolling resistance of scenes: `rolling` of objects and of pairs, and where it is refused."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.energy import energies
from mdanim_lammps.scene.parse import parse_scene

BALL = """object ball {{ shape sphere 10 cm  position (0, 0, 0.1) m  density 600  {kind}  velocity (0.5, 0, 0) m/s
  spin (0, 5, 0) rad/s  {words} }}
"""
SCENE = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n" + BALL + "{blocks}\ncontrol {{ time {time} s  friction 0.6 }}\n"


def scene(words="", blocks="", time=4, kind="elasticity rigid") -> str:
    """A ball that rolls."""
    return SCENE.format(words=words, blocks=blocks, time=time, kind=kind)


@pytest.mark.parametrize(
    ("words", "blocks"),
    [
        ("rolling 2 mm", ""),
        ("", "contact ball ground { rolling 2 mm }"),
        ("rolling 9 mm", "contact ball ground { rolling 2 mm  friction 0.4 }"),
    ],
)
def test_a_ball_stops_after_its_way(prepared, words, blocks):
    """v^2/(2 5/7 g r/R), and its energy is heat, with that of sinking in by 0.2 mm."""
    ready = prepared(scene(words, blocks))
    with Instance(ready.plan) as instance:
        instance.setup()
        before = energies(instance, ready.system.center_of_mass(instance.array("x")))
        instance.run(ready.certificate.steps)
        centre = ready.system.center_of_mass(instance.array("x"))
        after = energies(instance, centre)
    assert centre[0, 0] == pytest.approx(0.5**2 / (2 * 5 / 7 * 9.81 * 0.02), rel=1e-4)
    assert after["kinetic"] < 1e-12 * before["kinetic"]
    assert after["friction_heat"] + after["contact_damping_loss"] == pytest.approx(before["kinetic"], rel=1e-2)
    told = [{name: value for name, value in e.items() if name != "contact_bound"} for e in (before, after)]
    assert sum(told[1].values()) == pytest.approx(sum(told[0].values()), abs=1e-9 * before["kinetic"])


def test_the_larger_arm_of_two_counts(prepared):
    """On a held box, whichever of both has it."""
    floor = "object floor {{ shape box (4, 1, 0.2) m  position (0, 0, -0.1) m  density 600  elasticity rigid  hold all  {} }}"
    ways = []
    for own, other in (("rolling 1 mm", "rolling 4 mm"), ("rolling 4 mm", ""), ("", "rolling 4 mm")):
        ready = prepared(scene(own, floor.format(other), time=2).replace("ground z 0 m\n", ""))
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(ready.certificate.steps)
            ways.append(ready.system.center_of_mass(instance.array("x"))[0, 0])
    assert np.ptp(ways) == 0.0 and ways[0] == pytest.approx(0.5**2 / (2 * 5 / 7 * 9.81 * 0.04), rel=1e-3)


@pytest.mark.parametrize(
    "text",
    [scene("rolling 2 mm", kind="elasticity 1 MPa"), scene("", "contact ball ground { rolling 2 mm }", kind="elasticity 1 MPa")],
)
def test_elastic_objects_have_none(text):
    """They lose energy by their damping."""
    with pytest.raises(SceneError, match="ball is elastic: it loses energy by its own damping where it rolls"):
        parse_scene(text)


def test_an_arm_below_zero_is_refused():
    """With its place."""
    with pytest.raises(SceneError, match="rolling"):
        parse_scene(scene("rolling -1 mm"))
