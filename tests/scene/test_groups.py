# SPDX-License-Identifier: GPL-2.0-only
"""Groups: objects that are placed together, where they go, what they are called, and what is wrong with them."""

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.naming import objects_by_name
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.rotation import product, rotation_about

CONTROL = "control { time 1 s }\n"
REST = "mass 1 kg elasticity 1 MPa"
BALL = f"shape sphere 5 cm {REST}"


def problems(text: str) -> list:
    """The errors of a bad scene."""
    with pytest.raises(SceneError) as error:
        parse_scene(text + CONTROL)
    return [p for p in error.value.problems if p.severity == "error"]


def solids(text: str) -> dict:
    """Objects of a scene by name."""
    return {s.name: s for s in parse_scene(text + CONTROL).solids}


PAIR = f"""group pair {{
  object a {{ {BALL} position (1, 0, 0) m velocity (0, 3, 0) m/s spin (0, 1, 0) rad/s }}
  object b[7] {{ {BALL} position (0, 2, 0) m orientation axis (1, 0, 0) angle 30 deg hold face -x }}
}}
"""


def test_where_objects_of_a_group_are():
    """Positions, velocities and spins are turned and moved; a spin of the group adds the velocity of the place."""
    motion = "velocity (0, 0, 1) m/s spin (0, 0, 2) rad/s"
    found = solids(PAIR + f"place pair {{ position (0, 0, 5) m orientation axis (0, 0, 1) angle 90 deg {motion} }}\n")
    assert list(found) == ["pair.a", "pair.b[7]"]
    a, b = found.values()
    assert a.position == pytest.approx((0, 1, 5), abs=1e-15)
    assert a.velocity == pytest.approx((-3 - 2, 0, 1), abs=1e-15)  # turned (-3, 0, 0), plus (0, 0, 2) x (0, 1, 0)
    assert a.spin == pytest.approx((-1, 0, 2), abs=1e-15)
    assert b.position == pytest.approx((-2, 0, 5), abs=1e-15)
    by_hand = product(rotation_about((0, 0, 1), 1.5707963267948966), rotation_about((1, 0, 0), 0.5235987755982988))
    assert [x for row in b.rotation for x in row] == pytest.approx([x for row in by_hand for x in row], abs=1e-15)
    assert b.hold == solids(PAIR + "place pair { }\n")["pair.b[7]"].hold


def test_a_group_that_is_not_moved_keeps_all_bits():
    """Without settings the objects of a place are those of the group, to the bit."""
    alone = f"object a {{ {BALL} position (0.1, 0.2, 0.3) m velocity (0.1, 0.7, 0) m/s orientation euler (10, 20, 30) deg }}\n"
    (one,), (other,) = solids(alone).values(), solids(f"group g {{ {alone} }} place g {{ }}\n").values()
    assert (one.position, one.rotation, one.velocity, one.spin) == (other.position, other.rotation, other.velocity, other.spin)


def test_groups_in_groups():
    """A place in a group is moved along with it: the same as to compose the motions by hand."""
    text = PAIR + (
        "group two { place pair as left[1] { position (1, 0, 0) m velocity (1, 0, 0) m/s spin (0, 0, 1) rad/s } }\n"
        "place two { position (0, 0, 1) m orientation axis (0, 0, 1) angle 180 deg spin (0, 0, 3) rad/s }\n"
    )
    found = solids(text)
    assert list(found) == ["two.left[1].a", "two.left[1].b[7]"]
    a = found["two.left[1].a"]
    assert a.position == pytest.approx((-2, 0, 1), abs=1e-15)
    # In the frame of two: 1 from the place, 3 of its own and 1 x 1 of the spin of the place. Turned, plus 3 x (-2, 0, 0).
    assert a.velocity == pytest.approx((-1, -4 - 6, 0), abs=1e-14)
    assert a.spin == pytest.approx((0, -1, 4), abs=1e-14)


def test_lets_of_a_group_are_settings_of_its_place():
    """A place may give a let another value; the names around a group are those where it stands."""
    text = (
        "let n = 2\n"
        "group row { let step = 10 cm\n let r = step/4\n"
        f"  repeat i in 1 .. n {{ object ball[i] {{ shape sphere r {REST} position (i*step, 0, 0) }} }} }}\n"
        "repeat k in 1 .. 2 { place row[k] { position (0, k, 0) m set step = 10*k cm } }\n"
        "place row as wide { position (0, 0, 1) m set r = 1 cm }\n"
    )
    found = solids(text)
    assert list(found) == [f"{row}.ball[{i}]" for row in ("row[1]", "row[2]", "wide") for i in (1, 2)]
    assert found["row[2].ball[2]"].position == pytest.approx((0.4, 2, 0))
    assert found["row[2].ball[1]"].shape.radius == pytest.approx(0.05)
    assert found["wide.ball[2]"].shape.radius == pytest.approx(0.01)


def test_rand_in_a_group_depends_on_its_name():
    """One more place changes none of the others; two places differ."""
    group = f"group g {{ object a {{ {BALL} position (rand(0, 1), 0, 0) m }} }}\n"
    few = solids(group + "place g as x { } place g as y { position (0, 1, 0) m }\n")
    more = solids(group + "place g as w { position (0, 2, 0) m } place g as x { } place g as y { position (0, 1, 0) m }\n")
    assert few["x.a"].position == more["x.a"].position
    assert few["x.a"].position[0] != few["y.a"].position[0]


def test_held_box_goes_along_by_right_angles():
    """A box of the world that holds particles is moved, and turned by right angles alone."""
    group = f"group g {{ object a {{ {BALL} position (0, 0, 0) m hold within box (0, 0, 0) m to (1, 2, 3) m }} }}\n"
    (hold,) = solids(group + "place g { position (10, 0, 0) m orientation axis (0, 0, 1) angle 90 deg }\n")["g.a"].hold
    assert hold.low == pytest.approx((8, 0, 0))
    assert hold.high == pytest.approx((10, 1, 3))
    (problem,) = problems(group + "place g { orientation axis (0, 0, 1) angle 10 deg }\n")
    assert "its group is turned" in problem.message
    assert (problem.line, [str(s) for s in problem.span.used_at]) == (1, ["scene:2:7"])


def test_contact_blocks_of_a_group():
    """In a group its own objects are meant; outside, a name stands for all objects of a place, or of all places."""
    group = f"""group cart {{
      object body {{ {BALL} position (0, 0, 1) m }}
      repeat i in 1 .. 2 {{ object wheel[i] {{ {BALL} position (i, 0, 0) m }} }}
      contact body wheel {{ friction 0.1 }}
    }}
    """
    text = (
        group + "repeat k in 1 .. 2 { place cart[k] { position (0, 3*k, 0) m } }\ncontact cart[1].wheel cart[2] { friction 1 }\n"
    )
    contacts = parse_scene(text + CONTROL).contacts
    assert [(c.first, c.second) for c in contacts] == [
        ("cart[1].body", "cart[1].wheel"), ("cart[2].body", "cart[2].wheel"), ("cart[1].wheel", "cart[2]")
    ]  # fmt: skip


def test_names_that_stand_for_several_objects():
    """A name of a group, of one of its places, of a repeat in it, of that in all places."""
    names = ["cart[1].body", "cart[1].wheel[1]", "cart[2].wheel[1]", "cart[2].wheel[2]", "ball"]
    found = objects_by_name(names)
    assert found["cart"] == [0, 1, 2, 3]
    assert found["cart[2]"] == found["cart[2].wheel"] == [2, 3]
    assert found["cart.wheel"] == [1, 2, 3]
    assert found["cart[2].wheel[1]"] == [2]
    assert found["ball"] == [4]
    assert "body" not in found


def test_names_of_objects_in_groups_elsewhere():
    """Expectations, distances and cameras take them."""
    checks = "expect pair.b[7].position.z at 0.5 s = 0 m +- 1 m\nexpect pair.a.distance(pair.b[7]) < 3 m\n"
    scene = parse_scene(PAIR + "place pair { }\n" + checks + "render { camera from (3, 3, 3) m look pair.b[7] }\n" + CONTROL)
    assert [(e.subject, e.quantity, e.argument) for e in scene.expects] == [
        ("pair.b[7]", "position.z", None), ("pair.a", "distance", "pair.b[7]")
    ]  # fmt: skip
    assert scene.render.camera[0].look == "pair.b[7]"


def test_lock_of_groups():
    """The objects stand in scene.lock.txt, at their places; it reads back the same."""
    text = (
        PAIR
        + "place pair as x[1] { position (1, 2, 3) m orientation axis (1, 2, 3) angle 50 deg }\ncontact x.a x.b { friction 1 }\n"
    )
    scene = parse_scene(text + CONTROL)
    assert "group" not in lock_text(scene)
    assert parse_scene(lock_text(scene), scene.name) == scene


MISTAKES = [
    ("no such group", PAIR + "place pai { }", 5, 7, "no group is called pai", "did you mean 'pair'?", []),
    ("no such let", PAIR + "place pair { set r = 3 }", 5, 18, "the group pair has no 'let r'", "lets of its group", []),
    ("set twice", "group g { let r = 1 }\nplace g { set r = 1 set r = 2 }", 2, 25, "r is set twice", "", []),
    ("wrong kind of a let",
     f"group g {{ let r = 1 m\n object a {{ {BALL} position (r, 0, 0) }} }}\nplace g {{ set r = 2 kg }}", 3, 19,
     "r is a length in the scene, found 2 kg", "mm cm", []),
    ("two of one name", PAIR + "place pair { }\nplace pair { }", 6, 7, "the name pair is given twice",
     "first given at scene:5:7", []),
    ("two groups of one name", "group g { }\ngroup g { }", 2, 7, "the group g is given twice", "scene:1:7", []),
    ("itself", "group g { place g { } }\nplace g { }", 1, 17, "the group g places itself", "", ["scene:2:7"]),
    ("each other", "group g { place h { } }\ngroup h { place g { } }\nplace g { }", 2, 17, "the group g places itself", "",
     ["scene:3:7", "scene:1:17"]),
    ("a value in a group", f"group g {{ object a {{ {BALL} position (0, 0, q) m }} }}\nplace g as x {{ }}", 1, 83,
     "'q' has no value (in x)", "", ["scene:2:7"]),
    ("a range in a group", "group g { object a { shape sphere -1 m } }\nplace g as x { }", 1, 35, "r of sphere must be > 0",
     "", ["scene:2:7"]),
    ("a missing word in a group", f"group g {{ object a {{ {BALL} }} }}\nplace g as x {{ }}", 1, 18,
     "object x.a has no position", "",
     ["scene:2:7"]),
    ("a name from the place",
     f"group g {{ object a {{ {BALL} position (0, 0, k) m }} }}\nrepeat k in 1 .. 2 {{ place g[k] {{ }} }}", 1, 83,
     "'k' has no value (in g[1])", "", ["scene:2:28"]),
    ("gravity in a group", "group g { gravity (0, 0, -9) m/s^2 }", 1, 11, "'gravity' cannot stand inside group { }",
     "outermost", []),
    ("expect in a group", "group g { expect a.speed = 1 }", 1, 11, "'expect' cannot stand inside group { }", "outermost", []),
    ("mass of a place", "group g { }\nplace g { mass 3 kg }", 2, 11, "'mass' cannot stand inside place { }", "object", []),
    ("an axis without direction", PAIR + "place pair { orientation axis (0, 0, 0) angle 1 rad }", 5, 31, "needs a direction",
     "", []),
    ("an index before as", PAIR + "place pair[1] as x { }", 5, 7, "a group has no index", "place pair as pair[1]", []),
    ("no name", "place { }", 1, 7, "the name of a group is missing after place", "", []),
    ("no name after as", PAIR + "place pair as { }", 5, 15, "a name is missing after as", "", []),
    ("no value of set", "group g { let r = 1 }\nplace g { set r 3 }", 2, 17, "an = is missing after set r", "", []),
    ("group in a repeat", "repeat i in 1 .. 2 { group g { } }", 1, 22, "group cannot stand in a repeat", "", []),
    ("not closed", "group g {\n  object a { }\ncontrol { time 2 s }", 1, 1, "group g, opened at line 1, is not closed", "", []),
    ("too far away", f"group g {{ object a {{ {BALL} position (1e9, 0, 0) m }} }}\nplace g {{ position (1e9, 0, 0) m }}", 1, 18,
     "the position of g.a is too large", "", ["scene:2:7"]),
    ("contact of nothing", PAIR + "place pair { }\ncontact pair.c pair { friction 1 }", 6, 9, "no object is called pair.c", "",
     []),
    ("expect of several", PAIR + "place pair { }\nexpect pair.torn = 1", 6, 8, "pair stands for ", "name one of them, e.g. pair.",
     []),
    ("expect of nothing", PAIR + "place pair { }\nexpect pair.b[6].speed = 1", 6, 8, "no object is called pair.b[6]", "", []),
    ("a long name", f"object {'.'.join('abcdefghij')} {{ }}", 1, 25, "this name has more than 9 parts", "", []),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "line", "column", "words", "hint", "used_at"), [m[1:] for m in MISTAKES], ids=[m[0] for m in MISTAKES]
)
def test_mistakes(text, line, column, words, hint, used_at):
    """One of the problems is at the place, says what is wrong and how to go on, and where the group is placed."""
    found = problems(text + "\n")
    (problem,) = [p for p in found if (p.line, p.column) == (line, column)] or found
    assert (problem.line, problem.column) == (line, column), str(problem)
    assert words in problem.message
    assert hint in problem.hint
    assert [str(span) for span in problem.span.used_at] == used_at
    assert all(f"used at {place}" in str(problem) for place in used_at)


def test_group_that_is_not_placed():
    """It is not a part of the scene; say so."""
    scene = parse_scene(PAIR + f"object c {{ {BALL} position (0, 0, 0) m }}\n" + CONTROL)
    assert [s.name for s in scene.solids] == ["c"]
    assert "the group pair is not placed" in scene.warnings[0].message


@pytest.mark.parametrize("by", ["repeats", "places"])
def test_groups_that_multiply(by):
    """Groups of groups of groups are refused in no time, at a place: 60 of each in seven levels would be 2.8e12."""
    inside = (
        "repeat i in 1 .. 60 { place g%d as a[i] { } }"
        if by == "repeats"
        else " ".join(f"place g%d as a{i} {{ }}" for i in range(60))
    )
    base = f"object a {{ {BALL} position (0, 0, 0) m }}" if by == "repeats" else ""
    text = f"group g0 {{ {base} }}\n" + "".join(f"group g{k} {{ {inside.replace('%d', str(k - 1))} }}\n" for k in range(1, 8))
    (problem,) = problems(text + "place g7 { }\n")
    assert "the most is 1 000 000" in problem.message or "more than 100 000 times" in problem.message
    assert problem.line > 0


def test_groups_deep_in_each_other():
    """Eight levels are enough."""
    text = "".join(f"group g{k} {{ place g{k - 1} {{ }} }}\n" for k in range(1, 9))
    base = f"group g0 {{ object a {{ {BALL} position (0, 0, 0) m }} }}\n"
    assert list(solids(base + text + "place g7 { }\n")) == [".".join(f"g{k}" for k in range(7, -1, -1)) + ".a"]
    (problem,) = problems(base + text + "place g8 { }\n")
    assert "more than 8 levels deep" in problem.message


def test_ballast_in_a_turned_group():
    """A box of ballast is moved and turned by right angles; another angle is refused at its own line."""
    text = """group g {
      object a {
        shape box (20, 10, 10) cm  position (0, 0, 0.05) m  density 300  elasticity rigid
        ballast 3000 kg/m^3 within box (0, -1, -1) m to (1, 1, 1) m
      } }
    place g { position (2, 0, 0.05) m  orientation axis (0, 0, 1) angle """
    (box,) = solids(text + "90 deg }\n")["g.a"].ballast
    assert box.low == pytest.approx((1, 0, -0.95), abs=1e-15) and box.high == pytest.approx((3, 1, 1.05), abs=1e-15)
    (problem,) = problems(text + "30 deg }\n")
    assert problem.message.startswith("a box of ballast lies along the axes of the world, and its group is turned")
    assert "hold" not in problem.hint and problem.span.line == 4
