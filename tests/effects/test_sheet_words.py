# SPDX-License-Identifier: GPL-2.0-only
"""Words of sheets: what is read, what is refused with its place, what `check` remarks, and the lock."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.sheets.bearing import blows
from mdanim_lammps.model.spacing import plan_spacing
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.formatting import number
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.scene import Cylinder, Sheet, Shell, Sphere

CLOTH = """object cloth {{
  shape {shape}
  position (0, 0, 1) m
  density 300
  elasticity 1 MPa
  {more}
}}
control {{ time 1 s }}
"""
USUAL = "sheet (1, 0.8) m thickness 2 mm"
BOX = "object box { shape box (20, 20, 20) cm  position (0, 0, 0.1) m  density 500  elasticity 1 MPa }\n"


def cloth(shape: str = USUAL, more: str = "") -> str:
    return CLOTH.format(shape=shape, more=more)


def problem(text: str):
    with pytest.raises(SceneError) as error:
        prepare(parse_scene(text))
    return error.value.problems[0]


@pytest.mark.parametrize(
    ("shape", "record"),
    [
        (USUAL, Sheet((1.0, 0.8), 0.002)),
        (USUAL + " bending 0", Sheet((1.0, 0.8), 0.002, 0.0)),
        (USUAL + " bending 2.5", Sheet((1.0, 0.8), 0.002, 2.5)),
        ("sphere 20 cm sheet thickness 1 mm", Shell(Sphere(0.2), 0.001)),
        ("cylinder 20 cm 1 m sheet thickness 1 mm bending 0", Shell(Cylinder(0.2, 1.0), 0.001, 0.0)),
        ("cylinder 20 cm 1 m", Cylinder(0.2, 1.0)),
    ],
)
def test_it_is_read_and_written_back(shape, record):
    """Size, thickness and what scales bending, of flat ones and of surfaces of shapes."""
    scene = parse_scene(cloth(shape, "hold face -x  hold faces y"))
    assert scene.solids[0].shape == record
    assert parse_scene(lock_text(scene)) == scene


REFUSED = {
    "too thick": (
        cloth("sheet (1, 0.8) m thickness 50 cm"),
        "less than twice as wide as it is thick",
        "write a smaller thickness",
    ),
    "negative": (cloth("sheet (1, 0.8) m thickness -1 mm"), "must be > 0", ""),
    "no width": (cloth("sheet (1, 0) m thickness 1 mm"), "must be > 0", ""),
    "bending": (cloth(USUAL + " bending -1"), "bending must be 0 or more, found -1", "write bending 0"),
    "too stiff": (cloth(USUAL + " bending 1e5"), "too stiff for its size", "write bending 40000 or less"),
    "rigid": (cloth().replace("1 MPa", "rigid"), "its springs follow from Young's modulus", "shape box for a rigid plate"),
    "one k": (cloth().replace("1 MPa", "spring 10 N/m"), "its springs follow from Young's modulus", "write elasticity 1 MPa"),
    "faces": (cloth(more="hold faces z"), "its faces along z are all of it", "write hold face -x, +x, -y or +y"),
    "ends": (cloth(more="hold ends"), "cloth is not a rope", "write hold faces x"),
    "no particle": (cloth(more="hold within box (5, 5, 5) m to (6, 6, 6) m"), "catches no particle", "hold face -x holds a side"),
    "restitution": (cloth(more="restitution 0.5"), "restitution is of rigid and held objects", "leave it out"),
    "too fine": (cloth(more="resolution 1 mm"), "at least 2 mm apart", "write resolution 2 mm or more, up to 40 cm"),
    "too coarse": (cloth(more="resolution 1 m"), "two spacings or more across", "write resolution 2 mm or more, up to 40 cm"),
    "paper": (
        cloth().replace("time 1 s", "time 1 s contact-model paper") + BOX,
        "touches others with its surface",
        "take contact-model",
    ),
    "liquid": (
        "gravity (0, 0, -9.81)\nliquid sea { basin from (-1, -1, 0) m to (2, 1, 2) m density 1000 level 0.5 m }\n" + cloth(),
        "a liquid finds objects by their cells",
        "take the liquid out",
    ),
    "shell too thick": (cloth("sphere 1 cm sheet thickness 8 mm"), "too thick for a sheet", "leave out sheet"),
    "shell bending": (cloth("sphere 1 m sheet thickness 1 mm bending -1"), "bending must be 0 or more", "write bending 0"),
    "shell without a file": (cloth('mesh "no.stl" sheet thickness 1 mm'), "is not there", "relative to this scene file"),
    "in a box": (BOX + cloth().replace("(0, 0, 1)", "(0, 0, 0.1)"), "cloth starts inside box", "move it"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_fit_is_refused_with_its_place(name):
    """Cause and way out."""
    text, cause, way_out = REFUSED[name]
    found = problem(text)
    assert found.span is not None and re.search(cause, found.message) and way_out in found.hint, (found.message, found.hint)


def notes(text: str) -> list[str]:
    return [p.message for p in prepare(parse_scene("gravity (0, 0, -9.81)\n" + text)).certificate.notes]


def test_check_says_what_a_sheet_passes_through():
    """Itself, other sheets and ropes, and what is thinner than two spacings."""
    (alone,) = notes(cloth())
    assert alone == "cloth does not touch itself: folds of it pass through each other"
    rope = "object line { shape rope from (0, 0, 2) m to (1, 0, 2) m thickness 1 cm density 1000 elasticity 1 MPa }\n"
    (met,) = [said for said in notes(rope + cloth()) if "cloth" in said]
    assert met == "cloth may meet line, and passes through: sheets and ropes touch each other where both have touches-itself"
    both = rope.replace("MPa", "MPa  touches-itself yes") + cloth(more="touches-itself yes")
    assert not [said for said in notes(both) if "touch" in said]
    far = rope.replace("(0, 0, 2)", "(40, 0, 2)").replace("(1, 0, 2)", "(41, 0, 2)")
    assert any("cloth does not touch itself" in said for said in notes(far + cloth()))
    thin = BOX.replace("(20, 20, 20)", "(20, 20, 2)")
    assert any("box is 2 cm thin: it may slip through between them" in said for said in notes(thin + cloth()))
    assert not any("slip through" in said for said in notes(thin + cloth(more="resolution 1 cm")))
    rod = BOX.replace("(20, 20, 20)", "(80, 2, 2)")
    assert any("points of contact 1.28 cm apart and a contact 2 times as stiff" in said for said in notes(rod + cloth()))
    assert not any("does not touch itself" in said for said in notes(BOX + cloth(more="hold all")))


HELD = "hold faces x  hold faces y"
SKIN = f"object skin {{ shape sheet (40, 40) cm thickness 1 mm  position (0, 0, 0.5) m  material rubber  {HELD} }}\n"
DROPPED = "object ball { material steel  shape sphere 4 cm  position (0, 0, %r) m }\ncontrol { time 0.4 s %s }\n"


def bearing(z: float, control: str, skin: str = SKIN) -> list:
    scene = parse_scene("gravity (0, 0, -9.81) m/s^2\n" + skin + DROPPED % (z, control))
    return [p for p in prepare(scene).certificate.notes if "may fall through" in p.message]


@pytest.mark.parametrize(("z", "control"), [(0.5406, "resolution 2 cm"), (0.9, "resolution 2 cm"), (0.9, "")])
def test_a_sheet_is_as_hard_as_what_comes_onto_it_asks_for(z, control):
    """A steel ball of 2.1 kg that is laid on, or falls by 36 cm: by the material alone all three came out below.

    With ``contact-stiffness`` less is left to choose."""
    hardness = []
    for more in ("", " contact-stiffness 2"):
        scene = parse_scene("gravity (0, 0, -9.81) m/s^2\n" + SKIN + DROPPED % (z, control + more))
        ready = prepare(scene)
        hardness.append(ready.models[0].frame.hardness)
        (said,) = [p.message for p in ready.certificate.notes if "bears" in p.message]
        assert f"a contact {number(hardness[-1], 2)} times as stiff as by its material, so that it bears ball, which" in said
        assert not bearing(z, control + more)
    assert hardness[0] > 2.0 and hardness[1] == pytest.approx(0.5 * hardness[0], rel=0.05)


def test_check_says_what_no_sheet_bears():
    """A thin, soft one: the stiffness would have to be more than a hundred times that of its material."""
    (found,) = bearing(0.9, "", SKIN.replace("material rubber", "density 930 kg/m^3  elasticity 200 kPa"))
    assert found.severity == "warning" and "ball may fall through skin" in found.message
    stiffness = re.search(r"contact-stiffness (\S+) in control", found.hint)[1]
    assert not bearing(0.9, f"contact-stiffness {stiffness}", SKIN.replace("material rubber", "density 930  elasticity 200 kPa"))


def test_what_points_of_a_sheet_bear_is_that_of_closed_forms():
    """A ball comes with m g (R + depth), where the depth is that of Schwerin's membrane, a quarter of the side in radius; points
    bear pi k/h^2 int_0^R (R + s - x)^2 x dx, times 16/9R, with their radius s: k = 355.9 N/m at points 2.105 cm apart."""
    ready = prepare(parse_scene("gravity (0, 0, -9.81) m/s^2\n" + SKIN + DROPPED % (0.5406, "resolution 2 cm")))
    (blow,) = blows(ready.context)
    r, around, k, h = 0.04, 0.04 + 0.02105 / 12, 355.87, 0.0210526
    most = math.pi * k / h**2 * (around**2 * r**2 / 2.0 - 2.0 * around * r**3 / 3.0 + r**4 / 4.0)
    assert blow.borne == pytest.approx(16.0 / 9.0 * most / r, rel=0.02)  # of squares in the cross-section
    weight = 7850.0 * 4.0 / 3.0 * math.pi * 0.04**3 * 9.81
    deep = 4.0 * blow.energy / blow.force
    assert blow.energy == pytest.approx(weight * (0.0406 + deep), rel=0.005)
    assert blow.force == pytest.approx(9.0 * math.pi / 16.0 * 2000.0 * deep**3 / 0.1**2, rel=1e-6)


def test_points_between_particles_have_all_of_the_area():
    """As close as a marble asks for, where particles are as far apart as it is thick; weights and areas add up."""
    marble = DROPPED.replace("sphere 4 cm", "sphere 1 cm")
    ready = prepare(parse_scene("gravity (0, 0, -9.81) m/s^2\n" + SKIN + marble % (0.7, "resolution 2 cm")))
    frame = ready.models[0].frame
    body, one = frame.contact, replace(frame, parts=1).contact
    assert frame.parts == 3 and len(body.area) == pytest.approx(9 * len(one.area), rel=0.1)
    np.testing.assert_allclose(body.share.sum(axis=1), 1.0)
    assert body.area.sum() == pytest.approx(one.area.sum()) and body.carried.sum() == pytest.approx(one.area.sum())
    inside = frame.woven.share > 0.99
    assert body.area[: len(inside)][inside] == pytest.approx(one.area[inside] / 9.0, rel=0.2)
    assert not [p for p in ready.certificate.notes if "slip through" in p.message or "fall through" in p.message]


def test_light_objects_and_loose_sheets_are_not_warned_of():
    light = DROPPED.replace("material steel", "density 200  elasticity rigid")
    assert not [p for p in notes(SKIN + light % (0.5406, "resolution 2 cm")) if "may fall through" in p]
    assert not bearing(0.5406, "resolution 2 cm", SKIN.replace(HELD, ""))


def test_its_spacing_is_its_own():
    """It does not make other objects finer; its particles are at least as far apart as it is thick."""
    alone, beside = (plan_spacing(parse_scene(text)).of for text in (BOX + "control { time 1 s }", BOX + cloth()))
    assert beside[0] == alone[0] and beside[1] == pytest.approx(np.sqrt(0.8 / 1200))
    assert plan_spacing(parse_scene(cloth("sheet (1, 0.8) m thickness 10 cm"))).of == pytest.approx([0.1])


@pytest.mark.parametrize("kind", ["sheet", "rope"])
def test_friction_between_what_never_touches_is_not_asked_for(kind):
    """A rope and a sheet, or two ropes."""
    ends = "from (0, {y}, 1.01) m to (1, {y}, 1.01) m"
    rope = f"object line {{{{ shape rope {ends} thickness 1 cm  density 1000  elasticity 1 MPa  {{more}} }}}}\n"
    rough = cloth(more="friction 0.5") if kind == "sheet" else rope.format(y=0.02, more="friction 0.5") + "control { time 1 s }\n"
    text = rope.format(y=0, more="").replace("line", "other") + rough + "gravity (0, 0, -9.81)\n"
    ready = prepare(parse_scene(text + BOX.replace("MPa", "MPa  friction 0.5")))
    told = [p.message for p in (*ready.warnings, *ready.certificate.notes)]
    assert not [said for said in told if "works as 0 against other" in said and " of box " not in said]


def test_a_narrow_sheet_beside_coarse_objects(prepared):
    """The resolution of `control` is at most half of its width: wider lattices had springs with a stiffness below 0."""
    text = "object a { shape sheet (20, 1) cm thickness 1 mm  position (0, 0, 1) m  density 1000  elasticity 1 MPa }\n"
    system = prepared(text + "control { time 0.1 s  resolution 2 cm }\n").system
    assert system.stiffness.min() > 0.0 and system.spacing[0] < 6e-3
