# SPDX-License-Identifier: GPL-2.0-only
"""Towers that are drawn standing and will fall over."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance

TOWER = """gravity (0, 0, {g}) m/s^2
{floor}
repeat k in 1 .. {n} {{
  object cube[k] {{
    shape box (10, 10, 10) cm
    position (({k}) mm, 0, ({z}) cm)
    orientation axis (0, 0, 1) angle 5*k deg
    density {density}
    elasticity 1 MPa
    damping 0.2
  }}
}}
{more}
control {{ time 2.5 s  frames 10 fps  resolution 5 cm  {control} }}
"""


def tower(prepared, load, n=6, **other):
    """Cubes on each other; ``load`` is that of one, rho g a / E."""
    text = {"g": -9.81, "floor": "ground z 0", "n": n, "k": "2*(k mod 2)", "z": "10*k - 5", "more": "", "control": "friction 0.5"}
    return prepared(TOWER.format(density=load * 1e7 / 9.81, **text | other))


LID = "object lid { shape box (10, 10, 10) cm  position (0, 0, 65) cm  density 1000  elasticity 1 MPa  hold all }"


def told(ready):
    """The note on towers, if there is one."""
    return [n for n in ready.certificate.notes if "fall over" in n.message]


@pytest.mark.parametrize(("load", "falls"), [(1e-3, False), (3e-3, True)])
def test_check_tells_which_tower_falls(prepared, load, falls):
    """Six cubes of two cells: the note says what becomes of them."""
    ready = tower(prepared, load)
    assert bool(told(ready)) == falls
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        top = instance.array("x")[ready.system.object == 5]
    assert (top[:, 2].mean() < 0.4) == falls
    assert (np.hypot(*top[:, :2].mean(axis=0)) > 0.03) == falls


def test_the_way_out_is_enough(prepared):
    """Name both ends, the height, and an elasticity with which there is no note any more."""
    (note,) = told(tower(prepared, 3e-3))
    assert note.message.startswith("cube[1] to cube[6] stand 60 cm high and will fall over: from 49.")
    assert note.hint == "write an elasticity of 1.8 MPa, a lower density, or a lower tower" and note.severity == "note"
    assert not told(tower(prepared, 3e-3 / 1.8)) and told(tower(prepared, 3e-3 / 1.6))


@pytest.mark.parametrize(
    "other",
    [
        pytest.param({"control": "contact-model paper", "z": "11*k - 5"}, id="the paper's law, where nothing stands"),
        pytest.param({"z": "15*k - 5", "floor": ""}, id="in the air"),
        pytest.param({"g": 9.81}, id="falls upward"),
        pytest.param({"n": 3}, id="low"),
        pytest.param({"more": LID}, id="below a lid"),
    ],
)  # fmt: skip
def test_no_note_where_nothing_stands_so(prepared, other):
    """Only what stands one on one, from a floor on, free at its top."""
    assert told(tower(prepared, 3e-3)) and not told(tower(prepared, 3e-3, **other))


def test_a_column_of_one_object(prepared):
    """A needle on the ground or held at its foot buckles too, one that hangs or is held at both ends does not."""
    text = (
        "gravity (0, 0, -9.81)\n{floor}\nobject bar {{ shape {shape}  position (0, 0, 100) cm  density 1000  elasticity 1 MPa  "
        "{hold} }}\ncontrol {{ time 1 s  resolution 5 cm  friction 0.5 }}"
    )
    for floor, hold, falls in (
        ("ground z 0", "", 1), ("", "hold face -z", 1), ("", "hold face +z", 0), ("", "hold faces z", 0), ("ground z -1", "", 0),
    ):  # fmt: skip
        for shape in ("box (10, 10, 200) cm", "cylinder 6 cm 200 cm"):
            assert len(told(prepared(text.format(floor=floor, hold=hold, shape=shape)))) == falls, (floor, hold, shape)
    assert not told(prepared(text.format(floor="ground z 0", hold="", shape="box (100, 200, 200) cm")))


def test_the_height_is_greenhills(prepared):
    """Follow m g H^2 = 7.837 E I, with a spacing more for the foot and half of one for each joint, to nine tenths."""
    low, high = 1e-3, 3e-3
    for _ in range(8):
        load = np.sqrt(low * high)
        low, high = (low, load) if told(tower(prepared, load)) else (load, high)
    want = 0.9**3 * 7.837 / 12.0 * 0.1**3 / (0.6**2 * (0.6 + 0.05 * 3.5))
    assert low == pytest.approx(want, rel=0.02)
