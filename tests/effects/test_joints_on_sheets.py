# SPDX-License-Identifier: GPL-2.0-only
"""Joints on sheets: what their particles hold, what is refused with the place to write, and what LAMMPS takes."""

import re

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SHEET = "object {name} {{ material cotton elasticity 1 MPa shape sheet (1, 1) m thickness {thick} position {at} m {more} }}\n"
TILT = "orientation axis (0, 1, 0) angle 20 deg resolution 8 cm"
BALL = "object a { material pine shape sphere 10 cm position (0, 0, 1.15) m elasticity rigid }\n"
LINE = "object line { material cotton shape rope from (-1, 0, 1) m to (1, 0, 1) m thickness 1 cm resolution 5 cm }\n"
OTHER = SHEET.format(name="t", thick="1 mm", at="(0, 0, 1)", more="orientation axis (1, 0, 0) angle 90 deg resolution 8 cm")
ABOVE = SHEET.format(name="t", thick="1 mm", at="(0, 0, 1.02)", more="resolution 8 cm")
DOWN = LINE.replace("(-1, 0, 1) m to (1, 0, 1)", "(0.2, 0, 1) m to (0.2, 0, 0)")
END = "control { time 1 s }\n"


def scene(joint: str, more: str = "hold face -x resolution 8 cm", thick: str = "1 mm", others: str = BALL) -> str:
    return SHEET.format(name="s", thick=thick, at="(0, 0, 1)", more=more) + others + f"joint {joint}\n" + END


def problems(text: str) -> list:
    with pytest.raises(SceneError) as error:
        prepare(parse_scene(text, "odd"), allow_unstable=True)
    return error.value.problems


AXIS = "axis (0, 0, 1)"
REFUSED = {
    "a hinge with a motor across": (
        scene(f"hinge a s {{ at (0, 0, 1) m {AXIS} motor speed 3 rad/s }}"),
        "the axis of joint hinge a s is 90 deg out of the plane of s",
        "hold a small rigid object to s by joint weld, and put this joint between it and a",
        "axis",
    ),
    "a hinge across": (scene(f"hinge s world {{ {AXIS} }}"), "is 90 deg out of the plane of s", "between it and world", "axis"),
    "a hinge whose axis is written to two digits": (
        scene("hinge s world { at (0, 0, 1) m axis (0.94, 0, -0.34) }", TILT),
        r"is 0\.11\d* deg out of the plane of s",
        "write axis (0.939692621, 0, -0.342020143), which is in its plane",
        "axis",
    ),
    "a slider along an axis across": (
        scene(f"slider a s {{ at (0, 0, 1) m {AXIS} }}"),
        "joint slider a s is 90 deg out of the plane of s",
        "name the sheet first: joint slider s a",
        "axis",
    ),
    "beside, in the other object": (
        scene("ball a s { at (0, 0, 1.1) m }"),
        "joint ball a s is 10 cm off the plane of s, a sheet",
        "write at (0, 0, 1) m, the nearest place in the plane",
        "at",
    ),
    "between both objects": (
        scene("ball s a { at (0, 0, 1.2) m }", "", others=BALL.replace("1.15", "1.5")),
        "joint ball s a is 20 cm off the plane of s",
        "write at (0, 0, 1) m",
        "at",
    ),
    "without its place": (
        scene("weld a s { }"),
        "joint weld a s has no at, and the centre of a is 15 cm off the plane of s",
        "write at (0, 0, 1) m",
        "joint",
    ),
    "an end of a spring": (
        scene("spring a s { from (0, 0, 1.1) m to (0.2, 0, 1.05) m }"),
        "joint spring a s is 5 cm off the plane of s",
        "write to (0.2, 0, 1) m",
        "to",
    ),
    "a spring that names it first": (
        scene("spring s a { from (0.2, 0, 1.05) m }"),
        "is 5 cm off the plane of s",
        "write from (0.2, 0, 1) m",
        "from",
    ),
    "a slider beside": (
        scene(f"slider s a {{ at (0, 0, 1.05) m {AXIS} }}"),
        "joint slider s a is 5 cm off the plane of s",
        "write at (0, 0, 1) m",
        "at",
    ),
    "tilted": (
        scene("ball s world { at (-0.43, 0.1, 1.2) m }", TILT),
        "off the plane of s",
        "write at (-0.443978316, 0.1, 1.16159489) m",
        "at",
    ),
    "two sheets": (
        scene("ball s t { at (0.2, 0.03, 1.04) m }", others=OTHER),
        "joint ball s t is 4 cm off the plane of s",
        "write at (0.2, 0, 1) m",
        "at",
    ),
    "two sheets one above the other": (
        scene("ball s t { at (0.2, 0, 1.01) m }", others=ABOVE),
        "joint ball s t is 1 cm off the plane of [st]",
        "have no place in common",
        "at",
    ),
    "a rope beside": (
        scene("ball line s { at (0.5, 0, 1) m }", "resolution 8 cm", others=LINE).replace("(0, 0, 1) m", "(0, 0, 0.999) m"),
        "joint ball line s is 1 mm off the plane of s",
        "move s by (0, 0, 0.001) m: then this place of line is in its plane",
        "at",
    ),
    "a weld of sheets across each other": (
        scene("weld s t { at (0.2, 0, 1) m }", others=OTHER),
        "s and t have not the same ones there",
        "write joint ball s t",
        "joint",
    ),
    "a weld of a rope across": (
        scene("weld line s { at (0.2, 0, 1) m }", others=DOWN),
        "line and s have not the same ones there",
        "write joint ball line s",
        "joint",
    ),
    "a weld of ropes across each other": (
        LINE + DOWN.replace("object line", "object other") + "joint weld line other { at (0.2, 0, 1) m }\n" + END,
        "line and other have not the same ones there",
        "write joint ball line other",
        "joint",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_a_sheet_cannot_hold_is_refused_with_its_place(name):
    """Cause, way out, and where: one problem each, before the run."""
    text, cause, way_out, word = REFUSED[name]
    found = problems(text)
    assert len(found) == 1, [p.message for p in found]
    line = next(n for n, line in enumerate(text.splitlines(), 1) if line.startswith("joint"))
    column = text.splitlines()[line - 1].index(word if word == "joint" else f"{word} (") + (
        0 if word == "joint" else len(word) + 1
    )
    assert re.search(cause, found[0].message) and way_out in found[0].hint, (found[0].message, found[0].hint)
    assert found[0].span.line == line and (word == "joint" or found[0].span.column == column + 1), found[0].span


def test_all_problems_of_a_joint_are_told_at_once():
    """Its place and its axis."""
    found = problems(scene(f"hinge a s {{ at (0, 0, 1.1) m {AXIS} }}"))
    assert sorted(p.message.partition(" of ")[0] for p in found) == ["joint hinge a s is 10 cm off the plane", "the axis"]


@pytest.mark.parametrize("size", ["1 mm", "5 mm"])
@pytest.mark.parametrize(
    "joint",
    [
        "ball s world { at (-0.47, 0, 1.17) m }",
        "hinge s world { at (-0.4691, 0.2, 1.1718) m axis (0, 1, 0) }",
        "weld s a { at (0, 0, 1.0008) m }",
        "spring a s { to (-0.47, 0, 1.17) m }",
    ],
)
def test_a_place_with_rounded_digits_is_moved_into_the_plane(joint, size):
    """By its distance along the normal alone: LAMMPS takes it, and nothing pulls at the start."""
    text = scene(joint, TILT, size)
    ready = prepare(parse_scene(text, "odd"), allow_unstable=True)
    words = ready.plan.tables["joints"].splitlines()[1].split()
    at = np.array(words[words.index("to" if "spring" in joint else "at") + 1 :][:3], float)
    given = np.array(re.search(r"(?:at|to) \((.*?)\)", joint)[1].split(","), float)
    normal = np.array([np.sin(np.deg2rad(20.0)), 0.0, np.cos(np.deg2rad(20.0))])
    assert at - given == pytest.approx(-normal * (normal @ (given - (0.0, 0.0, 1.0))), abs=1e-12)
    with Instance(ready.plan) as instance:
        instance.setup()


OFFERED = {
    "a slider along an axis of the other object": scene("slider s a { at (0, 0, 1) m axis (0, 0, 1) }"),
    "a slider in the plane": scene("slider a s { at (0, 0, 1) m axis (1, 1, 0) }"),
    "a hinge with a motor in the plane": scene("hinge a s { at (0, 0, 1) m axis (1, 1, 0) motor speed 3 rad/s }"),
    "a hinge across, on a rigid object that is welded to the sheet": scene(
        f"weld s hub {{ at (0, 0, 1) m }}\njoint hinge a hub {{ at (0, 0, 1.02) m {AXIS} motor speed 3 rad/s }}",
        others=BALL + "object hub { shape box (6, 6, 2) cm position (0, 0, 1.011) m density 500 elasticity rigid }\n",
    ),
    "a weld of a rope along": scene("weld line s { at (0.2, 0, 1) m }", others=LINE.replace("1 cm", "1 cm hold ends")),
    "sheets in one plane": scene("weld s t { at (0.2, 0, 1) m }", others=ABOVE.replace("1.02", "1")),
}


@pytest.mark.parametrize("name", OFFERED)
def test_what_the_messages_offer_is_held(name):
    """A hundred steps, and nothing is stretched."""
    with Instance(prepare(parse_scene(OFFERED[name], "odd"), allow_unstable=True).plan) as instance:
        instance.setup()
        before = instance.array("x").copy()
        instance.run(100)
        assert np.abs(instance.array("x") - before).max() < 0.05


def test_a_held_sheet_holds_any_place_and_axis():
    """It never moves, and stands for the world."""
    text = scene(f"hinge a s {{ at (0, 0, 1.1) m {AXIS} motor speed 3 rad/s }}", "hold all resolution 8 cm")
    with Instance(prepare(parse_scene(text, "odd"), allow_unstable=True).plan) as instance:
        instance.setup()
