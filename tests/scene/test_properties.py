# SPDX-License-Identifier: GPL-2.0-only
"""``let wood = { ... }`` and ``use wood``: settings that several objects have in common."""

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene import scene as records
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene

CONTROL = "control { time 1 s }\n"
WOOD = "let wood = { density 500 kg/m^3 elasticity 2 MPa damping 0.1 color navy }\n"
AT = "position (0, 0, 1) m shape sphere 5 cm"


def solids(text: str, **more) -> dict:
    """Objects of a scene by name."""
    return {s.name: s for s in parse_scene(text + CONTROL, **more).solids}


def problems(text: str, **more) -> list:
    """The problems of a bad scene."""
    with pytest.raises(SceneError) as error:
        parse_scene(text + CONTROL, **more)
    return error.value.problems


def test_an_object_has_the_settings_that_it_uses():
    """The same object as with the settings written in it; it does not matter where `use` stands."""
    written = solids(WOOD + f"object a {{ density 500 kg/m^3 elasticity 2 MPa damping 0.1 color navy {AT} }}\n")["a"]
    assert solids(WOOD + f"object a {{ use wood {AT} }}\n")["a"] == written
    assert solids(WOOD + f"object a {{ {AT} use wood }}\n")["a"] == written


def test_own_settings_stand_above():
    """A setting beside `use` counts, wherever it stands; mass in place of density, too, and all of its own holds."""
    a = solids(WOOD + f"object a {{ elasticity 1 kPa use wood color red {AT} }}\n")["a"]
    assert (a.elasticity, a.color, a.density, a.damping) == (records.Young(1e3), "#ff0000", 500.0, 0.1)
    b = solids(WOOD + f"object b {{ use wood {AT} mass 3 kg }}\n")["b"]
    assert (b.mass, b.density) == (3.0, None)
    held = "let fixed = { hold face -x hold face +x }\n" + WOOD
    assert len(solids(held + f"object c {{ use wood use fixed {AT} }}\n")["c"].hold) == 2
    assert len(solids(held + f"object c {{ use wood use fixed hold all {AT} }}\n")["c"].hold) == 1


def test_settings_made_of_settings():
    """A let may use another one; its values are those where it stands, once for all objects."""
    text = WOOD + "let r = 3 cm\nlet bead = { use wood shape sphere r elasticity 5 kPa position (rand(0, 1), 0, 0) m }\n"
    found = solids(text + "object a { use bead }\nobject b { use bead position (0, 2, 0) m }\nobject c { use bead }\n")
    assert found["a"].shape.radius == 0.03
    assert (found["a"].elasticity, found["a"].density) == (records.Young(5e3), 500.0)
    assert found["a"].position == found["c"].position


def test_settings_as_a_parameter_of_a_group():
    """A place may give a group another material."""
    group = f"group g {{ let body = wood\n object a {{ use body {AT} }} }}\nlet tar = {{ use wood color black }}\n"
    found = solids(WOOD + group + "place g as x { } place g as y { position (1, 0, 0) m set body = tar }\n")
    assert (found["x.a"].color, found["y.a"].color) == ("#000080", "#000000")
    (problem,) = problems(WOOD + group + "place g { set body = 3 }\n")
    assert "body stands for settings in the scene" in problem.message
    assert (problem.line, problem.column) == (5, 22)


def test_lock_of_used_settings():
    """The settings themselves stand in scene.lock.txt."""
    scene = parse_scene(WOOD + f"object a {{ use wood {AT} }}\n" + CONTROL)
    assert "use" not in lock_text(scene).split()
    assert parse_scene(lock_text(scene), scene.name) == scene


MISTAKES = [
    ("a value", "let wood = { density -500 kg/m^3 }\n", "", 1, 22, "density must be > 0", ""),
    ("a unit", "let wood = { density 5 kg }\n", "", 1, 22, "density must be a density", ""),
    ("twice", "let wood = { density 5 kg/m^3 density 6 kg/m^3 }\n", "", 1, 31, "density is given twice in let wood",
     "scene:1:14"),
    ("unknown word", "let wood = { colour red }\n", "", 1, 14, "'colour' is not a setting of object", "color"),
    ("not closed", "let wood = { density 5 kg/m^3\n", "", 1, 12, "let wood, opened at line 1, is not closed", "add a }"),
    ("given twice", WOOD + WOOD, "", 2, 5, "'wood' is given twice", "scene:1:5"),
    ("unknown name", WOOD, f"object a {{ use wod {AT} }}", 2, 16, "no let gives settings the name wod", "did you mean 'wood'?"),
    ("no such let at all", "", f"object a {{ use wood {AT} }}", 1, 16, "no let gives settings the name wood", "let wood = {"),
    ("before its let", f"object a {{ use wood {AT} }}\n", WOOD, 1, 16, "'wood' is used before its let", "line 2"),
    ("a number", "let n = 3 kg\n", f"object a {{ use n {AT} }}", 2, 16, "n is 3 kg, not settings of an object", ""),
    ("as a number", WOOD, f"object a {{ mass wood {AT} elasticity 1 MPa }}", 2, 17, "'wood' stands for settings of an object",
     "use wood"),
    ("in a sum", WOOD, "let x = 1 + wood", 2, 13, "'wood' stands for settings of an object", "use wood"),
    ("two that give one word", WOOD + "let tin = { density 3 kg/m^3 elasticity 1 kPa }\n",
     f"object a {{ use wood use tin {AT} density 3 kg/m^3 }}", 3, 25, "both wood and tin give elasticity", "write elasticity in"),
    ("outside", WOOD + "use wood\n", "", 2, 1, "use can only stand in an object", ""),
    ("in control", WOOD + "control { use wood time 1 s }\n", "", 2, 11, "use can only stand in an object", ""),
    ("in a repeat", WOOD, f"object a {{ {AT} repeat i in 1 .. 2 {{ use wood }} }}", 2, 72, "use cannot stand in a repeat", ""),
    ("no name", WOOD, f"object a {{ {AT} use }}", 2, 55, "a name is missing after use", ""),
    ("bound of two values", "let ring = { shape torus 1 m 2 m }\n",
     f"{WOOD}object a {{ use ring use wood position (0, 0, 1) m }}", 1,
     30, "the tube of a torus is thinner", ""),
]  # fmt: skip


@pytest.mark.parametrize(
    ("top", "rest", "line", "column", "words", "hint"), [m[1:] for m in MISTAKES], ids=[m[0] for m in MISTAKES]
)
def test_mistakes(top, rest, line, column, words, hint):
    """One problem is at the place, with cause and way out; nothing is missed besides in what uses it."""
    found = problems(top + rest + "\n")
    (problem,) = [p for p in found if (p.line, p.column) == (line, column)] or found
    assert (problem.line, problem.column) == (line, column), str(problem)
    assert words in problem.message
    assert hint in problem.hint
    assert not any("has no" in p.message and "object a" in p.message for p in found if p is not problem), found


def test_place_where_a_bad_value_is_used():
    """A problem of several values names the let and the object."""
    text = WOOD + "let ring = { shape torus 1 m 2 m }\nobject a { use ring use wood position (0, 0, 1) m }\n"
    (problem,) = problems(text)
    assert (problem.line, [str(span) for span in problem.span.used_at]) == (2, ["scene:3:16"])


def test_set_of_the_command_line_gives_values_only():
    """A value inside can be set by a let of its own."""
    text = "let e = 2 MPa\nlet wood = { density 500 kg/m^3 elasticity e }\n" + f"object a {{ use wood {AT} }}\n"
    assert solids(text, overrides={"e": "3 MPa"})["a"].elasticity == records.Young(3e6)
    (problem,) = problems(text, overrides={"wood": "3"})
    assert "--set wood" in problem.message


def test_settings_that_multiply():
    """Lets that use each other are evaluated once each."""
    text = "let s0 = { }\n" + "".join(f"let s{k} = {{ {f'use s{k - 1} ' * 40}}}\n" for k in range(1, 60)) + WOOD
    assert solids(text + f"object a {{ use wood use s59 {AT} }}\n")["a"].density == 500.0
