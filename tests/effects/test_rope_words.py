# SPDX-License-Identifier: GPL-2.0-only
"""Words of ropes: what is read, what is refused with its place, what `check` remarks, and the lock."""

import re

import numpy as np
import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.contact.rigid_surfaces import moduli
from mdanim_lammps.features.contact.surface import SurfaceContact, surface_stiffness
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.scene import HoldEnds, Rope

LINE = """object line {{
  {shape}
  density 1000
  elasticity 10 MPa
  {more}
}}
control {{ time 1 s }}
"""
SLACK = "shape rope from (0, 0, 1) m to (1, 0, 1) m thickness 1 cm length 1.2 m"
BOX = "object box { shape box (20, 20, 20) cm  position (0, 0, 0.1) m  density 500  elasticity 1 MPa }\n"


def line(shape: str = SLACK, more: str = "") -> str:
    return LINE.format(shape=shape, more=more)


def problem(text: str):
    with pytest.raises(SceneError) as error:
        prepare(parse_scene(text))
    return error.value.problems[0]


def test_it_is_read_and_written_back():
    """Without a position; a length that is absent is the distance; a chain is one that does not bend."""
    scene = parse_scene(line(more="hold start  hold end"))
    (solid,) = scene.solids
    assert solid.shape == Rope((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), 0.01, 1.2) and solid.hold == (
        HoldEnds(True, False),
        HoldEnds(False, True),
    )
    assert solid.position[0] == pytest.approx(0.5) and 0.7 < solid.position[2] < 0.9
    again = parse_scene(lock_text(scene))
    assert again == scene
    chain = parse_scene(line("shape chain from (0, 0, 1) m to (1, 0, 1) m thickness 1 cm")).solids[0].shape
    assert not chain.bends and chain.length == 1.0


def test_a_group_moves_and_turns_it():
    """It hangs along -z wherever its ends are."""
    text = (
        "group g {\n"
        + line().partition("control")[0]
        + "}\nplace g { position (0, 0, 2) m  orientation axis (0, 0, 1) angle 90 deg }\n"
    )
    solid = parse_scene(text + "control { time 1 s }\n").solids[0]
    assert solid.shape.start == pytest.approx((0, 0, 3)) and solid.shape.end == pytest.approx((0, 1, 3))
    assert solid.position[:2] == pytest.approx((0, 0.5)) and solid.position[2] < 3.0 and solid.rotation[0][0] == 1.0


REFUSED = {
    "a position": (line(more="position (0, 0, 1) m"), "line has its position by its shape", "leave out position"),
    "an orientation": (line(more="orientation axis (1, 0, 0) angle 0"), "line has its orientation by its shape", "leave out"),
    "one point": (line(SLACK.replace("(1, 0, 1)", "(0, 0, 1)")), "both ends of the rope are at one point", "put them apart"),
    "too thick": (line(SLACK.replace("1 cm", "70 cm")), "shorter than twice its thickness", "smaller thickness"),
    "stretched": (line(SLACK.replace("1.2 m", "0.5 m")), "stretched too far", "write a length of 0.667 m or more"),
    "steep": (line(SLACK.replace("(1, 0, 1)", "(0, 0, 0)")), "one end is above the other", "put the ends 0.012 m apart"),
    "negative": (line(SLACK.replace("1 cm", "-1 cm")), "must be > 0", ""),
    "rigid": (line().replace("10 MPa", "rigid"), "its springs follow from Young's modulus", "write elasticity 100 MPa"),
    "one k": (line().replace("10 MPa", "spring 10 N/m"), "its springs follow from Young's modulus", "write elasticity 100 MPa"),
    "faces": (line(more="hold faces x"), "line is a rope and has no faces", "write hold ends"),
    "no particle": (line(more="hold within box (5, 5, 5) m to (6, 6, 6) m"), "catches no particle", "hold ends holds both ends"),
    "restitution": (line(more="restitution 0.5"), "restitution is of rigid and held objects", "leave it out"),
    "too fine": (line(more="resolution 1 mm"), "at least as long as it is thick", "write resolution 1 cm or more"),
    "too coarse": (line(more="resolution 1 m"), "there are two or more", "write resolution 1 cm or more"),
    "paper": (
        line().replace("time 1 s", "time 1 s contact-model paper") + BOX,
        "touches others with its surface",
        "take contact-model",
    ),
    "liquid": (
        "gravity (0, 0, -9.81)\nliquid sea { basin from (-1, -1, 0) m to (2, 1, 2) m density 1000 level 0.5 m }\n" + line(),
        "a liquid finds objects by their cells",
        "take the liquid out",
    ),
    "ends of a box": (
        BOX.replace("MPa }", "MPa  hold ends }") + "control { time 1 s }",
        "box is not a rope",
        "write hold faces x",
    ),
    "fine cells": (
        BOX.replace("MPa }", "MPa  resolution 4 mm }") + line(SLACK.replace("1 cm", "2 cm")),
        "line is 2 cm thick, more than two cells of box, which are 4 mm wide",
        "write resolution 1 cm in box",
    ),
    "a hinge": (
        line() + BOX + "joint hinge line box { at (1, 0, 1) m axis (0, 1, 0) }\n",
        "has no direction across",
        "write joint ball",
    ),
    "beside": (
        line() + BOX + "joint ball line box { at (1, 0, 1.004) m }\n",
        "is 4 mm beside the line of line",
        "write at (1, 0, 1) m, where its nearest particle is",
    ),
    "a spring without its end": (
        line() + BOX + "joint spring box line { from (1, 0, 1) m }\n",
        "joint spring box line has no to: where along line is it?",
        "write to (0, 0, 1) m, its end that is nearer to box",
    ),
    "a joint without a place": (
        line() + BOX + "joint ball line box { }\n",
        "joint ball line box has no at: where along line is it?",
        "write at (0, 0, 1) m, its end that is nearer to box",
    ),
    "no length": (line(SLACK.replace("1.2 m", "0 m")), "L of rope must be > 0, found 0 m", "write L > 0"),
    "in a box": (BOX + line(SLACK.replace("(0, 0, 1)", "(0, 0, 0.1)")), "line starts inside box", "move it"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_fit_is_refused_with_its_place(name):
    """Cause and way out."""
    text, cause, way_out = REFUSED[name]
    found = problem(text)
    assert found.span is not None and re.search(cause, found.message) and way_out in found.hint, (found.message, found.hint)


def test_many_joints_off_ropes_are_told_once():
    """A repeat makes many of one line of text."""
    joints = "repeat i in 1 .. 3 { joint ball line box { at (0.2*i, 0, 1) m } }\n"
    with pytest.raises(SceneError) as error:
        prepare(parse_scene(line() + BOX + joints, "odd"))
    (found,) = error.value.problems
    assert found.message.endswith("beside the line of line, and 2 more so") and "without it they are straight" in found.hint


@pytest.mark.parametrize(
    "joint", ["spring box line { from (0, 0, 0.15) m to (0.5, 0, 1) m }", "ball box line { at (0.5, 0, 0.2) m }"]
)
def test_a_joint_off_a_rope_is_one_problem(joint):
    """It does not tell of the same place twice."""
    with pytest.raises(SceneError) as error:
        prepare(parse_scene(line() + BOX + f"joint {joint}\n", "odd"))
    assert ["beside the line" in p.message for p in error.value.problems] == [True]


def test_a_group_that_turns_one_end_above_the_other_is_refused():
    """At the shape, with the place of the group."""
    text = (
        "group g {\n"
        + line().partition("control")[0]
        + "}\nplace g { orientation axis (0, 1, 0) angle 90 deg }\ncontrol { time 1 s }\n"
    )
    assert "one end is above the other" in problem(text).message


def test_check_tells_what_passes_through(prepared):
    """Ropes do not touch each other; long links beside something thin."""
    two = "gravity (0, 0, -9.81)\n" + line() + line().replace("object line", "object other").partition("control")[0] + BOX
    told = [p.message for p in prepared(two).certificate.notes]
    assert any("line, other do not touch each other" in m for m in told)
    thin = BOX.replace("(20, 20, 20) cm", "(20, 20, 4) cm")
    told = [p.message for p in prepared("gravity (0, 0, -9.81)\n" + line(more="resolution 6 cm") + thin).certificate.notes]
    assert any("links of line are 6 cm long and box is 4 cm thin" in m for m in told)


SWING = """gravity (0, 0, -9.81) m/s^2
object seat { shape box (40, 20, 4) cm  position (0, 0, 0.5) m  mass 20 kg  elasticity SEAT }
object left { shape rope from (-0.18, 0, 2.5) m to (-0.18, 0, 0.5) m thickness 1 cm  density 800  elasticity 100 MPa  hold start }
object right { shape rope from (0.18, 0, 2.5) m to (0.18, 0, 0.5) m thickness 1 cm  density 800  elasticity 100 MPa  hold start }
joint ball left seat { at (-0.18, 0, 0.5) m }
joint ball right seat { at (0.18, 0, 0.5) m }
control { time 1 s }
"""
OTHER = "object other { shape box (4, 4, 4) cm  position (-0.17, 0, 0.6) m  density 500  elasticity 1 MPa }\n"


@pytest.mark.parametrize("seat", ["rigid", "1 MPa"])
def test_ropes_and_what_hangs_on_them_need_no_contact(prepared, seat):
    """A swing: ropes do not touch each other, nor the seat that they are joined with."""
    swing = SWING.replace("SEAT", seat)
    ready, off = prepared(swing), prepared(swing + "effects { contact off }")
    assert not ready.resolved.on("contact") and ready.certificate.timestep == off.certificate.timestep
    assert ready.verdicts["contact"].reason == "all that could meet is joined, or ropes, which do not touch each other"


def test_what_never_touches_counts_in_no_bound(prepared):
    """With something else on the swing, ropes touch that alone: contact is as stiff as that is, and nothing with what a joint
    holds on to all that there is."""
    contact = SurfaceContact()
    for text, partners in (
        (OTHER.replace("-0.17", "0"), [1e6, 1e6, 1e6, 1e8]),
        (OTHER + "joint ball left other { at (-0.18, 0, 0.6) m }\n", [1e6, 0.0, 1e6, 1e8]),
    ):
        ready = prepared(SWING.replace("SEAT", "1 MPa") + text)
        context = ready.context
        assert ready.resolved.on("contact")
        young = moduli(context)
        share = 2.0 * np.array(partners) / (young + partners)
        assert contact.stiffness(context) == pytest.approx(surface_stiffness(context, young, share), rel=1e-12)
        assert (contact.rate(context)[context.system.object == 1] == 0.0).all() == (partners[1] == 0.0)


def test_a_rope_outside_the_walls_is_told_at_its_shape():
    """It has no position of its own."""
    found = problem(
        "walls from (0, 0, 0) m to (1, 1, 2) m\n" + line("shape chain from (2, 0, 1) m to (3, 0, 1) m thickness 1 cm")
    )
    assert "line stands outside the walls" in found.message and (found.line, found.column) == (3, 20)


# --- rollers ---------------------------------------------------------------------------------------------------------------

WHEEL = "object wheel {{ shape {shape}  position (0, {y}, 1) m  {turned}  mass 1 kg  elasticity rigid  hold all }}\n"
ROUND, TURNED, OVER = "cylinder 10 cm 6 cm", "orientation axis (1, 0, 0) angle 90 deg", "runs over wheel"
HUNG = "shape rope from (-10.5, 0, 60) cm to (10.5, 0, 60) cm thickness 1 cm"


def over(more: str = OVER, shape: str = HUNG, round: str = ROUND, y: str = "0", turned: str = TURNED) -> str:
    return WHEEL.format(shape=round, y=y, turned=turned) + line(shape, more)


def test_a_rope_over_a_wheel_is_as_long_as_its_way():
    """It is at rest in each link, comes back from the lock, and goes along with its group."""
    scene = parse_scene(over())
    rope = scene.solids[1]
    assert rope.shape.length == pytest.approx(0.8 + np.pi * 0.105, rel=1e-12) and rope.position[2] > 0.8
    again = parse_scene(lock_text(scene))
    assert again == scene and again.solids[1].shape.rollers == rope.shape.rollers
    x = np.array(rope.shape.curve.points(100))
    assert np.abs(np.linalg.norm(np.diff(x, axis=0), axis=1) / (0.01 * rope.shape.length) - 1.0).max() < 2e-4
    inner, _, control = over().partition("control")
    place = "place g { position (3, 0, 0) m  orientation axis (0, 0, 1) angle 90 deg }\n"
    moved = parse_scene(f"group g {{\n{inner}}}\n{place}{_}{control}")
    assert moved.solids[1].shape.curve.length == pytest.approx(rope.shape.length)
    assert moved.solids[1].shape.rollers[0].name == "g.wheel"


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        (over("runs over reel"), "no object is called reel"),
        (over(round="sphere 10 cm"), "line runs over wheel, which does not have the shape cylinder"),
        (over(turned=""), "the axis of wheel stands upright"),
        (over(y="0.2"), "it runs beside wheel"),
        (over(shape=HUNG.replace("10.5, 0, 60) cm to", "10.5, 1, 60) cm to")), "its ends are 0.01 m apart along the axis"),
        (over(shape=HUNG.replace("(10.5", "(-10.5").replace("to (-10.5, 0, 60", "to (-10.5, 0, 30")), "at one place across it"),
        (over(shape=HUNG.replace("60)", "130)")), "a straight line passes over wheel and does not touch it"),
        (over(shape=HUNG.replace("-10.5, 0, 60)", "-5, 0, 100)")), "its start and wheel are in each other"),
        (over(shape=HUNG + " length 1.5 m"), "it hangs through: it is 1.5 m long, its way is 1.12987 m"),
        (over(shape=HUNG + " length 0.5 m"), "it is stretched too far"),
        (over().replace("wheel {", "wheel { runs over line "), "wheel is not a rope, and runs over nothing"),
    ],
)  # fmt: skip
def test_a_rope_that_cannot_run_over_a_wheel(text, cause):
    """With the place of its word and a way out."""
    found = problem(text)
    assert cause in found.message and found.hint and found.line
