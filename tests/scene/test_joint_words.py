# SPDX-License-Identifier: GPL-2.0-only
"""The words of joints: what is read, what is refused with place, cause and way out, all in one pass."""

import numpy as np
import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.joints.links import NOTHING, links_of
from mdanim_lammps.features.joints.measure import joints_between
from mdanim_lammps.features.joints.strength import strengths
from mdanim_lammps.scene.explain import explain
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene

BODY = "object {name} {{ shape box (10, 10, 10) cm position {at} m density 700 elasticity {kind} }}\n"
ROD, BAR = (BODY.format(name=name, at=at, kind="rigid") for name, at in (("rod", "(0, 0, 1)"), ("bar", "(0.1, 0, 1)")))
POST = ROD.replace("rod", "post").replace("rigid", "rigid hold all").replace("(0, 0, 1)", "(0, 0.1, 1)")
END = "control { time 1 s }\n"
PLACE = "{ at (0.05, 0, 1) m axis (0, 1, 0) "


def problems(text: str) -> list[str]:
    """All problems of a scene as `line cause | way out`."""
    with pytest.raises(SceneError) as error:
        parse_scene(text, "odd")
    return [f"{p.span.line} {p.message} | {p.hint}" for p in error.value.problems]


def test_every_misuse_is_told_in_one_pass():
    """Each with its place, the cause, the value and a way out."""
    told = problems(
        ROD
        + BAR
        + POST
        + """joint hinge rod world { at (0, 0, 1) m }
joint weld rod bar { motor speed 3 rad/s }
joint hing rod bar { axis (0, 0, 1) }
joint hinge rod rod { axis (0, 0, 0) }
joint hinge rod bart { axis (0, 0, 1) }
joint slider rod bar { axis (0, 0, 1) motor speed 60 rpm torque 2 N*m limits 10 deg to 20 deg }
joint ball post world { }
joint ball rod bar { breaks 0 N }
joint spring rod world { }
joint ball world rod { }
joint hinge rod bar { axis (0, 1, 0) limits 10 deg to 20 deg friction 2 N contact maybe }
joint ball rod bar { breaks 3 N torque 2 N*m stiffness -5 N/m }
joint ball rod ground { }
hinge rod bar { }
expect rod.joint.angle = 3
expect rod.joint.angle(bar) = 3 m
expect rod.joint.force(rod) = 3 N
"""
        + END
    )
    wanted = [
        "4 joint hinge rod world has no axis | e.g. axis (0, 1, 0)",
        "5 a weld has no motor: it holds both objects as they are | leave it out, or write joint hinge or slider",
        "6 the kind of joint is missing: it is one of weld, ball, hinge, slider, spring, found 'hing' | did you mean 'hinge'?",
        "7 rod cannot be joined to itself | write the name of another object, or world",
        "7 the axis of a joint needs a direction, found (0, 0, 0) | e.g. axis (0, 1, 0)",
        "8 no object is called bart | did you mean 'bar'?",
        "9 a slider has its motor in m/s, found 6.28319 rad/s: it slides along an axis | units that fit: m/s km/h",
        "9 a slider has its limits in m, found 0.174533 rad",
        "10 post is held: nothing of joint ball post world can move | take hold all out of one of them",
        "11 breaks must be > 0, found 0 N",
        "12 joint spring rod world does not say where it ends in the world | e.g. to (0, 0, 2) m",
        "13 the world stands behind the object that it is joined to | write joint ball rod world",
        "14 'maybe' is not one of the choices of contact",
        "15 stiffness must be > 0, found -5 N/m",
        "16 ground is not an object | write world for what never moves",
        "17 hinge is a kind of joint | write joint hinge A B { ... }",
        "18 joint.angle needs another object, or world, in brackets | write joint.angle(world)",
        "19 rod.joint.angle is an angle, found 3 m, a length",
        "20 the joint.force of rod and itself is 0",
    ]
    for line in wanted:
        assert any(found.startswith(line) for found in told), (line, told)


@pytest.mark.parametrize(
    ("block", "cause"),
    [
        (
            "joint hinge rod bar " + PLACE + "limits 10 deg to 20 deg }",
            "limits from 0.175 rad to 0.349 rad do not hold the start, which is 0 | it counts from the start, which lies between",
        ),
        ("joint hinge rod bar " + PLACE + "limits 20 deg to -10 deg }", "which is 0 | the lower one stands first"),
        (
            "joint hinge rod bar " + PLACE + "motor speed 1 rad/s torque 2 N }",
            "M of motor must be a torque, found 2 N, a force | units that fit: N*m",
        ),
        (
            "joint hinge rod bar " + PLACE + "friction 2 kg }",
            "friction must be a torque or a force, found 2 kg | units that fit: N*m N kN",
        ),
        ("joint spring rod bar { length 0 m }", "length must be > 0, found 0 m | e.g. length 20 cm"),
        ("joint spring rod bar { stiffness 0 N/m }", "stiffness must be > 0, found 0 N/m | e.g. stiffness 2000 N/m"),
        ("joint spring rod bar { damping -1 }", "damping must be >= 0, found -1 N*s/m | e.g. damping 3 N*s/m"),
        ("expect rod.joint.angle = 3", "| write joint.angle(world), or in place of world the name of the object"),
        ("expect rod.joint.torque(world) = 3 N", "rod.joint.torque is a torque, found 3 N, a force | units that fit: N*m"),
        ("joint hinge rod bar " + PLACE + "friction 2 N }", "a hinge has its friction in N*m, found 2 N"),
        ("joint hinge rod bar " + PLACE + "motor speed 1 rad/s force 2 N }", "the motor of a hinge has no force"),
        ("joint hinge rod bar " + PLACE + "motor speed 1 rad/s torque 0 N*m }", "the torque of a motor must be > 0, found 0"),
        ("joint ball rod bar { breaks 3 N torque 2 N*m }", "a ball bears no torque"),
        ("joint ball rod bar { length 3 cm }", "a ball has no length"),
        ("joint spring rod bar { at (0, 0, 1) m }", "a spring has no at: it pulls and pushes along the line of its two ends"),
        ("joint hinge rod bar " + PLACE + "motor speed 1 kg }", "w of motor must be an angular speed or a speed, found 1 kg"),
    ],
)
def test_values_that_do_not_fit_the_kind(block, cause):
    assert any(cause in found for found in problems(ROD + BAR + block + "\n" + END)), problems(ROD + BAR + block + "\n" + END)


def test_a_place_beside_a_skin_is_within_a_spacing(prepared):
    """A string is tied to a balloon 5 mm off its skin, which is 1 mm thick and has particles 4 cm apart."""
    balloon = "object balloon { shape sphere 20 cm sheet thickness 1 mm  position (0, 0, 1) m  density 1000\n"
    balloon += "  elasticity 1 MPa  resolution 4 cm }\n"
    prepared(balloon + "joint ball balloon world { at (0, 0, 1.205) m }\n" + END)
    with pytest.raises(SceneError, match="outside of balloon: 9"):
        prepared(balloon + "joint ball balloon world { at (0, 0, 1.3) m }\n" + END)


def test_places_far_from_what_is_joined_are_refused(prepared):
    """With the distance; of a spring each end by itself. They are told beside other mistakes of the file."""
    far = "joint ball rod bar { at (0, 0, 3) m }\njoint spring rod bar { from (0, 0, 1) m to (0, 0, 0) m }\n"
    told = problems(ROD + BAR.replace("0.1, 0", "0.5, 0") + far + "joint spring rod bar { length 0 m }\n" + END)
    assert "joint ball rod bar is outside of both objects: 1.95 m from rod" in told[0]
    assert "joint spring rod bar is outside of bar: 1.05 m" in told[1] and "length must be > 0" in told[2]
    with pytest.raises(SceneError, match="no joint connects rod and bar"):
        prepared(ROD + BAR + "joint ball rod world { }\nexpect rod.joint.force(bar) = 1 N\n" + END)
    with pytest.raises(SceneError, match="no hinge connects rod and world"):
        prepared(ROD + "joint ball rod world { }\nexpect rod.joint.angle(world) = 1\n" + END)


def refused(prepared, text: str) -> list[str]:
    """Ways out of a scene that is read and then refused."""
    with pytest.raises(SceneError) as error:
        prepared(text + END)
    return [p.hint for p in error.value.problems]


def test_a_hinge_beside_its_only_object_tells_of_rods_and_springs(prepared):
    (way_out,) = refused(prepared, ROD + "joint hinge rod world { at (0, 0, 2) m axis (0, 1, 0) }\n")
    assert "joint spring rod world { from (0, 0, 1) m to (0, 0, 2) m }" in way_out and "joint weld" in way_out


def test_what_an_object_is_joined_to_is_advised(prepared):
    (way_out,) = refused(prepared, ROD + BAR + "joint hinge rod bar " + PLACE + "}\nexpect rod.joint.angle(world) = 0\n")
    assert way_out == "write rod.joint.angle(bar)"


def test_of_several_joints_of_two_objects_one_is_meant(prepared):
    """The kind says which; without it a number would be that of any. Among joints of one kind it is the first, with a word."""
    both = ROD + BAR + "joint slider rod bar { axis (1, 0, 0) }\njoint spring rod bar { stiffness 9 N/m }\n"
    (way_out,) = refused(prepared, both + "expect rod.joint.force(bar) = 1 N\n")
    assert way_out == "write rod.joint.slider.force(bar) or rod.joint.spring.force(bar)"
    (way_out,) = refused(prepared, both + "expect rod.joint.spring.force(world) = 1 N\n")
    assert way_out == "write rod.joint.spring.force(bar)"
    chosen = prepared(both + "expect rod.joint.spring.force(bar) = 1 N\nrecord bar.joint.torque(rod)\n" + END)
    assert [[one.joint.kind for one in of_asked(chosen, n)] for n in (0, 1)] == [["spring"], ["slider"]] and not chosen.warnings
    twice = ROD + BAR + "".join(f"joint hinge rod bar {{ at (0.05, {y}, 1) m axis (0, 1, 0) }}\n" for y in (0, 0.04))
    assert not prepared(twice + "expect rod.joint.angle(bar) = 0\n" + END).warnings
    opposite = twice[::-1].replace(")0 ,1 ,0(", ")0 ,1- ,0(", 1)[::-1]
    assert len(prepared(opposite + "expect rod.joint.angle(bar) = 0\n" + END).warnings) == 1  # which sign?
    (told,) = prepared(twice + "expect rod.joint.force(bar) < 1 N\nrecord rod.joint.force(bar)\n" + END).warnings
    assert told.message == "rod.joint.force(bar) is that of the first of 2 joints hinge of both, at (5 cm, 0 m, 1 m)"


def of_asked(ready, n: int):
    """Joints that a line is about."""
    one = ready.context.scene.asked[n]
    return joints_between(ready.context.scene, one.subject, one.argument, one.quantity)


def test_a_joint_that_stands_twice_is_warned_of(prepared):
    """In either order of its objects and either direction of its axis; not at another place."""
    once = "joint hinge rod bar " + PLACE + "}\n"
    twice = once.replace("rod bar", "bar rod").replace("(0, 1, 0)", "(0, -1, 0)")
    told = prepared(ROD + BAR + once + twice + END).warnings
    assert ["the same place as joint hinge rod bar" in str(w.message) for w in told] == [True]
    assert not prepared(ROD + BAR + once + twice.replace("0.05, 0, 1", "0.05, 0.04, 1") + END).warnings


def test_names_of_repeats_and_groups():
    """A repeat without its index stands for all of it; in a group its own objects are meant, and joints move along."""
    wheels = "repeat i in 1 .. 4 { object wheel[i] { shape sphere 5 cm position (i, 0, 1) m density 700 elasticity rigid } }\n"
    scene = parse_scene(ROD + wheels + "joint hinge wheel rod { axis (0, 1, 0) }\n" + END, "cart")
    assert [(link.first, link.second, link.begin[0]) for link in links_of(scene).all] == [(i, 0, float(i)) for i in range(1, 5)]
    cart = "group cart { " + ROD + BAR + "joint hinge rod bar { at (0.05, 0, 1) m axis (0, 1, 0) } joint ball rod world { } }\n"
    text = cart + "place cart as left { position (1, 0, 0) m orientation axis (0, 0, 1) angle 90 deg }\n" + END
    scene = parse_scene(text, "carts")
    hinge, ball = links_of(scene).all
    assert scene.joints[0].first == "left.rod" and (hinge.first, hinge.second) == (0, 1) and ball.second == NOTHING
    np.testing.assert_allclose(hinge.begin, (1.0, 0.05, 1.0), atol=1e-15)
    np.testing.assert_allclose(hinge.axis, (-1.0, 0.0, 0.0), atol=1e-15)


def test_a_chain_of_twenty_and_a_net():
    """A chain is two repeats; joints that hold nothing in a place leave it free, others bound where it may go."""
    link = (
        "repeat i in 1 .. 20 { object link[i] { shape box (8, 2, 2) cm position (10*i, 0, 9) cm density 700 elasticity rigid } }"
        "\n"
    )
    text = (
        link + "joint ball link[1] world { }\nrepeat i in 1 .. 19 { joint ball link[i] link[i + 1] { at (10*i + 5, 0, 9) cm } }\n"
    )
    links = links_of(parse_scene(text + END, "chain"))
    assert len(links.all) == 20 and links.pairs == links.passing == [(i, i + 1) for i in range(19)]
    assert links.leashes[19].length == pytest.approx(1.9, rel=0.02) and links.leashes[19].point == (0.1, 0.0, 0.09)
    links = links_of(parse_scene(text.replace("joint ball link[1] world { }", "") + END, "loose"))
    assert links.leashes[19].length == np.inf


def test_the_lock_has_all_of_it():
    """Values with two units keep theirs."""
    text = (
        ROD
        + BAR
        + POST
        + "joint hinge rod bar "
        + PLACE
        + """motor speed 60 rpm torque 2 N*m limits -10 deg to 1 rad }
joint hinge bar rod { axis (0, 1, 0) friction 3 }
joint slider bar post { axis (1, 0, 0) motor speed 2 m/s force 3 N limits -1 cm to 2 cm breaks 3 N torque 2 N*m contact on }
joint spring rod bar { stiffness 3 N/m length 2 m damping 1 N*s/m pulls only }
"""
    )
    scene = parse_scene(text + END, "all")
    assert parse_scene(lock_text(scene), "all") == scene
    assert "hinge rod bar" in lock_text(scene) and "speed 6.28318530717958" in lock_text(scene)


def test_what_never_moves_stands_second():
    """A held object may be written first: the angle is that of the moving one about the opposite axis."""
    link = links_of(parse_scene(ROD + POST + "joint hinge post rod { at (0, 0.05, 1) m axis (0, 0, 1) }\n" + END, "x")).all[0]
    assert (link.first, link.second, link.named, link.axis) == (0, NOTHING, 1, (-0.0, -0.0, -1.0))


def test_words_are_explained():
    for word in ("joint", "hinge", "weld", "motor", "limits", "joint.angle", "joint gap"):
        assert explain(word)
    assert "a kind of joint" in explain("slider")


def test_stiffness_follows_from_what_hangs_on_it(prepared):
    """The gap of rigid objects at four times the weight is 1/200 of the thinnest part; of elastic ones E h; else as written."""
    gravity = "gravity (0, 0, -9.81) m/s^2\n"
    text = gravity + ROD + BAR + "joint ball rod world { }\njoint ball bar rod { at (0.05, 0, 1) m }\n" + END
    upper, lower = strengths(prepared(text).context)
    assert lower.load == pytest.approx(0.7 * 9.81) and upper.load == pytest.approx(1.4 * 9.81)
    assert upper.stiffness == pytest.approx(4.0 * upper.load / (0.005 * 0.1))
    soft = prepared(text.replace("rigid", "1 MPa", 1))
    assert strengths(soft.context)[0].stiffness == pytest.approx(1e6 * np.cbrt(soft.system.cell_volume[0]))
    told = strengths(prepared(text.replace("joint ball rod world { }", "joint ball rod world { stiffness 5000 N/m }")).context)
    assert told[0].stiffness == 5000.0


def test_a_net_shares_its_loads(prepared):
    """Nine balls on four corners: the corners bear all weight, each a quarter."""
    text = """gravity (0, 0, -9.81) m/s^2
repeat i in 0 .. 2 { repeat k in 0 .. 2 {
  object ball[3*i + k] { shape sphere 2 cm position (0.1*i, 0.1*k, 1) m density 1000 elasticity rigid }
} }
repeat i in 0 .. 2 { repeat k in 0 .. 1 {
  joint spring ball[3*i + k] ball[3*i + k + 1] { pulls only }
  joint spring ball[3*k + i] ball[3*k + 3 + i] { pulls only }
} }
repeat i in 0 .. 1 { repeat k in 0 .. 1 { joint ball ball[6*i + 2*k] world { } } }
control { time 1 s }
"""
    corners = [one.load for one in strengths(prepared(text).context) if one.second is None]
    np.testing.assert_allclose(corners, 9 * 1000 * 4 / 3 * np.pi * 8e-6 * 9.81 / 4, rtol=1e-9)


def test_a_start_that_tears_a_joint_is_warned_of(prepared):
    """A rod that turns about its hinge does not; one that flies off does."""
    turns = ROD.replace("rigid", "rigid spin (0, 2, 0) rad/s velocity (0, 0, -0.1) m/s")
    assert not prepared(turns + "joint hinge rod world { at (-0.05, 0, 1) m axis (0, 1, 0) }\n" + END).warnings
    flies = ROD.replace("rigid", "rigid velocity (0, 0, 3) m/s")
    told = prepared(flies + "joint hinge rod world { at (-0.05, 0, 1) m axis (0, 1, 0) }\n" + END).warnings
    assert "moves apart at 3 m/s at the start" in str(told[0].message)
