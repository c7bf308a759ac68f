# SPDX-License-Identifier: GPL-2.0-only
"""Warnings of contact before a run: friction without effect, speeds of falls that cannot occur."""

import numpy as np
import pytest

ONE_SIDED = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object slab { shape box (40, 40, 10) cm  position (0, 0, 5) cm  density 1000  elasticity 1 MPa  SLAB }
object cube { shape box (10, 10, 10) cm  position (0, 0, 0.15) m  density 1000  elasticity 1 MPa  friction 0.5 }
object far { shape box (10, 10, 10) cm  position (0, 0, 1) m  density 1000  elasticity 1 MPa }
control { time 0.1 s  resolution 5 cm  CONTROL }
"""


@pytest.mark.parametrize(
    ("slab", "control", "more", "against"),
    [
        pytest.param("", "", "", "slab", id="none in the slab: the nearest is told"),
        pytest.param("friction 0.3", "", "", "far", id="one has some"),
        pytest.param("friction 0", "", "", "far", id="0 is meant"),
        pytest.param("", "", "contact cube slab { friction 0.2 }", "far", id="a pair"),
        pytest.param("", "friction 0.1", "", "", id="all have some"),
        pytest.param("", "", "joint weld cube slab { }", "far", id="a joint lets them be in each other"),
        pytest.param("", "", "joint weld cube slab { contact on }", "slab", id="joined, with contact"),
        pytest.param("", "", "contact cube slab { friction 0 }\ncontact far cube { friction 0 }", "", id="pairs"),
    ],
)
def test_friction_of_one_of_two_is_told(prepared, slab, control, more, against):
    """It works as 0, the root of the product: once, with the line to write, unless a 0 is written; a warning if near."""
    ready = prepared(ONE_SIDED.replace("SLAB", slab).replace("CONTROL", control) + more)
    found = [w for w in (*ready.warnings, *ready.certificate.notes) if "works as 0" in w.message]
    assert [w.severity for w in found] == [{"slab": "warning", "far": "note"}[against]] if against else not found
    for warning in found:
        assert warning.message.startswith(f"friction 0.5 of cube works as 0 against {against}, which has none")
        assert f"contact cube {against} {{ friction 0.5 }}" in warning.hint and warning.line == 4


def test_friction_of_a_material_is_not_told_of_what_is_far(prepared):
    """It is a default's consequence, which no word of the scene asks for."""
    oak = ONE_SIDED.replace("density 1000  elasticity 1 MPa  friction 0.5", "material oak").replace("CONTROL", "")
    ready = prepared(oak.replace("SLAB", "material oak"))
    assert not [w for w in (*ready.warnings, *ready.certificate.notes) if "works as 0" in w.message]


FAST = """object slab { shape box (40, 40, 10) cm  position (0, 0, 5) cm  density 1000  elasticity 400 kPa }
object cube { shape box (10, 10, 10) cm  position (0, 0, 0.3) m  density 1000  elasticity 400 kPa  velocity (0, 0, -6.6) m/s }
control { time 0.1 s  resolution 5 cm  CONTROL }
"""


def test_fast_objects_with_friction_are_warned_of(prepared):
    """The full reach of the barrier bears them without friction: a note where there is none, else a warning."""
    bare, rough = (prepared(FAST.replace("CONTROL", more)) for more in ("", "friction 0.5"))
    told = [w for w in (*bare.warnings, *rough.warnings) if "full reach" in w.message]
    assert [n for n in bare.certificate.notes if "full reach" in n.message]
    (warning,) = told
    assert "works as 0" in warning.message and not [n for n in rough.certificate.notes if "full reach" in n.message]
    assert "more than 0.3 of the wave speed" in warning.message


def test_a_needle_keeps_the_full_reach_from_a_lower_speed_on(prepared):
    """It is one cell across along two axes: 0.1 of the wave speed, told as that."""
    needle = FAST.replace("CONTROL", "friction 0.5").replace("box (40, 40, 10)", "box (40, 5, 5)").replace("-6.6", "-3.3")
    (told,) = [w.message for w in prepared(needle).warnings if "full reach" in w.message]
    assert told.startswith("slab may meet others at more than 0.1 of the wave speed")


TABLE = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object table {{ shape box (60, 60, 10) cm  position (0, 0, 0.75) m  density 1000  elasticity 1 MPa  hold all }}
object low {{ shape box (20, 20, 20) cm  position ({x}, 0, {z}) m  density 1000  elasticity 20 kPa  friction 0.5  {low} }}
object high {{ shape box (20, 20, 10) cm  position ({x}, 0, {z} + 0.15) m  density 1000  elasticity 20 kPa  friction 0.5 }}
control {{ time 0.1 s  resolution 5 cm  friction 0.5 }}
{more}
"""


@pytest.mark.parametrize(
    ("x", "z", "low", "more", "falls"),
    [
        pytest.param(0.0, 0.9, "", "", 0, id="stands"),
        pytest.param(0.25, 0.9, "", "", 0, id="stands near the edge"),
        pytest.param(0.35, 0.9, "", "", 2, id="over the edge"),
        pytest.param(0.0, 1.1, "", "", 2, id="falls"),
        pytest.param(0.0, 0.9, "velocity (0.1, 0, 0) m/s", "", 2, id="slides off, and what stands on it with it"),
    ],
)
def test_what_stands_on_a_table_does_not_fall(prepared, x, z, low, more, falls):
    """No speed of a fall from what holds it up: no warning, and the short barrier; a tower on it likewise."""
    ready = prepared(TABLE.format(x=x, z=z, low=low, more=more))
    names = ("amplitude", "closing speed")
    speeds = {m.name: m.value for m in ready.certificate.margins if m.name in names}
    moving = ~ready.system.still
    assert np.count_nonzero(ready.context.reach.speed[moving] > 1.0) == falls
    assert (not ready.warnings) == (falls == 0) and speeds
    quick = ready.plan.columns["reach"][ready.system.boundary].any()
    assert quick == (falls > 0)


SQUEEZED = """ground z 0 m
object cube { shape box (10, 10, 10) cm  position (0, 0, 5) cm  mass 1 kg  elasticity 1 MPa }
object plate { shape box (20, 20, 2) cm  position (0, 0, 11) cm  hold all  DRIVE }
control { time 0.2 s  CONTROL }
"""
PRESSED = "key 0.1 s at (0, 0, 10.5) cm"


@pytest.mark.parametrize(
    ("drive", "control", "asked", "told"),
    [
        pytest.param(PRESSED, "", "record cube.stress.z", "42 % too low", id="4 cells, 0.58 by bench/squeezed.py"),
        pytest.param(PRESSED, "contact-stiffness 16  resolution 12.5 mm", "record cube.stress.z", "7 % too low", id="harder"),
        pytest.param(PRESSED, "contact-stiffness 100  resolution 12.5 mm", "record cube.stress.z", "", id="hard"),
        pytest.param(PRESSED, "", "record cube.position.z", "", id="nothing asks for stress"),
        pytest.param("", "", "record cube.stress.z", "", id="nothing squeezes"),
    ],
)
def test_stress_of_what_is_squeezed_is_told_to_be_low(prepared, drive, control, asked, told):
    """By how much faces sink in, which is measured in docs/physics-contact.md."""
    ready = prepared(SQUEEZED.replace("DRIVE", drive).replace("CONTROL", control) + asked)
    found = [n.message for n in ready.certificate.notes if "squeeze it" in n.message]
    assert len(found) == bool(told) and all(told in message for message in found)
