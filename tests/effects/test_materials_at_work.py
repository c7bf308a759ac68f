# SPDX-License-Identifier: GPL-2.0-only
"""Scenes of materials against closed forms, at the defaults of the language."""

import math

import numpy as np
import pytest
from mdanim_lammps.certificate import note_lines
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.materials.page import rule
from mdanim_lammps.features.materials.table import MATERIALS

G = 9.81
DOWN = "gravity (0, 0, -9.81) m/s^2\n"


def places(ready, seconds, looks):
    """Centres of all objects [m], shape (looks + 1, M, 3), evenly from 0 s on."""
    found = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for look in range(looks + 1):
            found.append(ready.system.center_of_mass(instance.array("x")))
            if look < looks:
                instance.run(max(1, round(seconds / looks / ready.certificate.timestep)))
    return np.array(found)


def test_a_block_slides_on_ice(prepared):
    """Way v^2 / 2 mu g with the friction that the table gives both, for blocks of several materials and sizes; that of a block
    that says its own is by its own."""
    names = {"oak": 10, "steel": 5, "rubber": 4, "brick": 20}
    text = DOWN + "object rink { material ice shape box (400, 400, 10) cm position (100, 0, -5) cm hold all }\n"
    for y, (name, size) in enumerate(names.items()):
        more = "elasticity rigid" if name == "rubber" else ""
        text += f"object {name} {{ material {name} {more} shape box ({size}, {size}, {size / 2}) cm "
        text += f"position (0, {0.4 * y}, {size / 400}) m velocity (0.7, 0, 0) m/s }}\n"
    text += "object bare { material oak friction 0.24 shape box (10, 10, 5) cm position (0, -0.4, 0.025) m "
    text += "velocity (0.7, 0, 0) m/s }\n"
    ready = prepared(text + "control { time 1.5 s }\n")
    way = places(ready, 1.4, 1)[-1, 1:, 0]
    mu = [rule(name, "ice") for name in names] + [math.sqrt(0.24 * MATERIALS["ice"].friction.value)]
    assert way == pytest.approx([0.7**2 / (2 * m * G) for m in mu], rel=5e-3)  # friction of the first contact builds up in a step


def test_balls_bounce_by_the_lower_restitution(prepared):
    """Marbles of glass and steel and a ball of rubber fall half a metre onto stone: heights e^2 h; that of rubber is what its
    damping was chosen for."""
    balls = {"glass": 0.8, "steel": 2.5, "rubber": 5.0}
    text = DOWN + "object floor { material stone shape box (100, 60, 4) cm position (0, 0, -2) cm hold all }\n"
    for x, (name, r) in enumerate(balls.items()):
        text += f"object {name} {{ material {name} shape sphere {r} cm position ({0.3 * (x - 1)}, 0, {0.5 + r / 100}) m }}\n"
    ready = prepared(text + "control { time 0.7 s }\n")
    height = places(ready, 0.64, 160)[:, 1:, 2] - np.array(list(balls.values())) / 100
    kept = np.sqrt(height[80:].max(axis=0) / 0.5)
    lower = [min(MATERIALS[name].restitution.value, MATERIALS["stone"].restitution.value) for name in balls]
    assert kept == pytest.approx(lower, abs=0.06)  # promised of restitution: contacts do not pull, and dashpots lag by a step


def test_cork_swims_and_steel_sinks(prepared):
    """The share of the cork that is immersed is its density over that of the water; the steel lies on the bottom."""
    text = DOWN + "liquid water { basin from (-20, -20, 0) cm to (20, 20, 30) cm density 1000 kg/m^3 level 15 cm }\n"
    text += "object cork { material cork shape box (8, 8, 8) cm position (-8, 0, 17.6) cm }\n"
    text += "object weight { material steel shape sphere 4 cm position (8, 0, 9) cm }\ncontrol { time 2 s }\n"
    place = places(prepared(text), 1.5, 30)
    draft = 0.15 - (place[15:, 0, 2].mean() - 0.04)  # both displace as much as at the start, where the level is given
    assert draft == pytest.approx(0.17 * 0.08, abs=3e-4)  # it still bobs by so much
    assert place[-1, 1, 2] == pytest.approx(0.04, abs=0.001)


def test_what_is_rigid_by_material_is_told_in_one_short_line(prepared):
    """Nearly every scene has such objects: the note names them and gives no advice."""
    block = "object {0} {{ material {1} shape box (1, 1, 1) m position ({2}, 0, 2) m }}\n"
    text = "".join(block.format(*row) for row in (("a", "steel", 0), ("b", "steel", 2), ("c", "oak", 4)))
    certificate = prepared(text + "control { time 0.1 s }").certificate
    (note,) = [n for n in certificate.notes if "rigid by material" in n.message]
    assert note.message == "rigid by material: a and 1 more (steel), c (oak)" and not note.hint
    assert [line for line in note_lines(certificate) if "c (oak)  [" in line]


BALL = "ground z 0\nobject ball { shape sphere 10 cm  position (0, 0, 1) m  elasticity rigid  friction 1 "


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (f"gravity (0, 0, -9.81)\n{BALL}mass 500 kg }}\n", "ball: 119 366 kg/m^3, and gold has 19 300"),
        (f"gravity (0, 0, -9.81)\n{BALL}mass 0.1 g }}\n", "ball: 0.0239 kg/m^3, and air has 1.2"),
        (f"gravity (0, 0, 9.81)\n{BALL}mass 4 kg }}\n", "gravity points up, and the ground is below"),
        (f"gravity (0, 0, -9.81)\n{BALL}mass 80 kg }}\n", ""),
    ],
    ids=["too heavy", "too light", "upward", "lead"],
)
def test_masses_and_gravity_that_are_likely_mistyped(prepared, text, told):
    """A note with a way out; none on what materials have."""
    notes = [f"{note.message} {note.hint}" for note in prepared(text + "control { time 0.1 s }\n").certificate.notes]
    assert [note for note in notes if told in note and ("kg/m^3" in note or "write gravity (0, 0, -9.81) m/s^2" in note)] == notes
    assert len(notes) == bool(told), notes
