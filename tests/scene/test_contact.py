# SPDX-License-Identifier: GPL-2.0-only
"""Friction in the scene language: of objects, of the scene, of two objects; and which model of contact has any."""

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.contact.pairs import any_friction, frictions, pair_rules
from mdanim_lammps.features.contact.words import ContactModel, ContactPair
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.naming import objects_by_name, pairs_of
from mdanim_lammps.scene.parse import parse_scene
from scene_parts import ball, text

SURFACE = "contact-model surface"
ROW = "repeat i in 1 .. 3 { object b[i] { shape sphere 1 cm position (i, 0, 0) m mass 1 kg elasticity 1 MPa } }\n"
"""Stands on line 1."""


def pile(contacts: str = "", control: str = SURFACE, top: str = "", **settings: str) -> str:
    """Three balls of a repeat and one more; what is said of contacts begins on line 9."""
    return ROW + text(top, **settings).replace("time 3 s", f"time 3 s {control}") + contacts


def problems(scene: str):
    """All problems of a scene."""
    with pytest.raises(SceneError) as error:
        parse_scene(scene)
    return error.value.problems


def test_friction_of_objects_and_of_the_scene():
    """Each is read, has its place, and is absent until it is written."""
    scene = parse_scene(pile(control=f"{SURFACE} friction 0.5 contact-damping 0.2", friction="0.25"))
    assert [s.friction for s in scene.solids] == [None, None, None, 0.25]
    assert (scene.solids[3].spans["friction"].line, scene.solids[3].spans["friction"].column) == (7, 12)
    assert (scene.control.friction, scene.control.contact_damping) == (0.5, 0.2)
    assert scene.control.contact_model is ContactModel.SURFACE
    bare = parse_scene(pile(control=""))
    assert (bare.control.friction, bare.control.contact_damping, bare.control.contact_model) == (0.0, None, ContactModel.SURFACE)
    assert ball().friction is None and bare.contacts == ()


def test_contacts_survive_the_lock():
    """Single objects, a repeat, its single objects, planes; both settings, or one of them."""
    said = (
        "contact b ball { friction 0.1 }\ncontact b b { friction 0 contact-damping 0.5 }\n"
        "contact ground b[2] { friction 0 }\ncontact ball walls { friction 1 }\n"
        "contact b[1] ground { friction 2 }\n"
    )
    top = "ground z -1 m\nwalls from (-9, -9, -9) m to (9, 9, 9) m\n"
    scene = parse_scene(pile(said, top=top))
    assert scene.contacts == (
        ContactPair("b", "ball", 0.1),
        ContactPair("b", "b", 0.0, 0.5),
        ContactPair("ground", "b[2]", 0.0),
        ContactPair("ball", "walls", 1.0),
        ContactPair("b[1]", "ground", 2.0),
    )
    assert "contact b b {\n  friction        0.0\n  contact-damping 0.5\n}\n" in lock_text(scene)
    assert parse_scene(lock_text(scene), strict=True) == scene


def test_contacts_in_a_repeat():
    """An index may be worked out."""
    scene = parse_scene(pile("repeat i in 1 .. 2 { contact b[i] b[i + 1] { friction i/10 } }\n"))
    assert scene.contacts == (ContactPair("b[1]", "b[2]", 0.1), ContactPair("b[2]", "b[3]", 0.2))


@pytest.mark.parametrize(
    ("control", "contacts", "settings", "place", "what"),
    [
        pytest.param("friction 0.5", "", {}, (8, 49), "friction", id="friction of the scene"),
        pytest.param("contact-damping 0.5", "", {}, (8, 56), "contact-damping", id="damping"),
        pytest.param("", "", {"friction": "0.5"}, (7, 12), "friction", id="friction of an object"),
        pytest.param("", "contact b ball { friction 0 }", {}, (9, 9), "a contact block", id="contact block"),
        pytest.param("", "contact b ball { friction 1 }", {"friction": "1"}, (10, 9), "a contact block", id="two of them"),
    ],
)
def test_the_contact_of_the_paper_has_no_friction(control, contacts, settings, place, what):
    """One problem that says what to write; with what it says there is none."""
    (found,) = problems(pile(contacts, f"contact-model paper {control}", **settings))
    assert found.message.startswith(f"{what} needs contact-model surface")
    assert found.hint == "take contact-model paper out of control"
    assert (found.line, found.column) == place
    said, taken_out = (parse_scene(pile(contacts, f"{word} {control}", **settings)) for word in (SURFACE, ""))
    assert taken_out.control.contact_model is ContactModel.SURFACE
    assert parse_scene(lock_text(taken_out), strict=True) == said


def test_no_friction_is_what_the_paper_has():
    """Zeros say what holds anyway."""
    scene = parse_scene(pile(control="contact-model paper friction 0 contact-damping 0", friction="0"))
    assert scene.warnings == () and parse_scene(lock_text(scene), strict=True) == scene


@pytest.mark.parametrize("more", ["friction 0.1", "OBJECT", "CONTACT"])
def test_damping_without_friction_is_flagged(more):
    """Warn where nothing has friction, and only there."""
    (warning,) = parse_scene(pile(control=f"{SURFACE} contact-damping 0.5")).warnings
    assert "where there is friction" in warning.message and "friction 0.5" in warning.hint
    control = f"{SURFACE} contact-damping 0.5 {more if more.islower() else ''}"
    contacts = "contact b ball { friction 1 }" if more == "CONTACT" else ""
    assert parse_scene(pile(contacts, control, **({"friction": "1"} if more == "OBJECT" else {}))).warnings == ()


MISTAKES = [
    ("unknown object", "contact b bal { friction 1 }", 9, 11, "no object is called bal", "did you mean 'ball'?"),
    ("unknown repeat", "contact bb b[1] { friction 1 }", 9, 9, "no object is called bb", "did you mean 'b'?"),
    ("unknown index", "contact ball b[4] { friction 1 }", 9, 14, "no object is called b[4]", "did you mean 'b[3]'?"),
    ("no ground", "contact ground b { friction 1 }", 9, 9, "the scene has no ground", "e.g. ground z 0 m"),
    ("no walls", "contact b walls { friction 1 }", 9, 11, "the scene has no walls", "e.g. walls from"),
    ("no basin", "contact b basin { friction 1 }", 9, 11, "the scene has no basin", "e.g. basin from"),
    ("itself", "contact ball ball { friction 1 }", 9, 9, "ball does not touch itself", "two objects"),
    ("itself, of a repeat", "contact b[1] b[1] { friction 1 }", 9, 9, "b[1] does not touch itself", "two objects"),
    ("twice", "contact ball b[1] { friction 1 }\ncontact b[1] ball { friction 1 }", 10, 9,
     "the contact of b[1] and ball is given twice", "first given at scene:9:9"),
    ("twice, in a repeat", "contact b b { friction 1 }\ncontact b[1] b[3] { friction 1 }", 10, 9,
     "the contact of b[1] and b[3] is given twice", "first given at scene:9:9"),
    ("empty", "contact ball b { }", 9, 9, "contact ball b says nothing", "friction 0.1"),
    ("one name", "contact ball { friction 1 }", 9, 14, "a name is missing after contact", "e.g. contact ball floor {"),
    ("too rough", "contact ball b { friction 11 }", 9, 27, "goes up to 10, found 11", "rubber"),
    ("negative", "contact ball b { friction -1 }", 9, 27, "friction must be >= 0, found -1", ""),
    ("too damped", "contact ball b { contact-damping 2 }", 9, 34, "goes up to 1, found 2", "critical"),
    ("with a unit", "contact ball b { friction 1 N }", 9, 27, "friction must be a plain number", "leave out the unit"),
    ("another setting", "contact ball b { drag 1 }", 9, 18, "'drag' cannot stand inside contact { }", "object"),
]  # fmt: skip


@pytest.mark.parametrize(("said", "line", "column", "words", "hint"), [m[1:] for m in MISTAKES], ids=[m[0] for m in MISTAKES])
def test_mistake(said, line, column, words, hint):
    """One problem, with its place, the cause, and a way out."""
    (found,) = problems(pile(said + "\n"))
    assert words in found.message and hint in found.hint
    assert (found.line, found.column) == (line, column), str(found)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        pytest.param("contact ground walls { friction 1 }", "ground and walls never touch", id="two planes"),
        pytest.param("contact ground ground { friction 1 }", "ground and ground never touch", id="a plane and itself"),
        pytest.param(
            "contact ground b { friction 1 }\ncontact b[2] ground { friction 1 }",
            "the contact of ground and b[2] is given twice",
            id="plane twice",
        ),
        pytest.param(
            "contact ground b { contact-damping 0 }", "the contact-damping of ground is that of control", id="damping of a plane"
        ),
    ],
)
def test_mistake_with_planes(said, words):
    """The same for ground and walls that are there."""
    (found,) = problems(pile(said, top="ground z -1 m\nwalls from (-9, -9, -9) m to (9, 9, 9) m\n"))
    assert words in found.message and found.hint


def test_a_name_with_two_meanings():
    """Refuse a word that is a plane and an object, or an object and a repeat; where it is one of them, that one is meant."""
    named = pile("contact b ground { friction 1 }").replace("object ball", "object ground")
    assert parse_scene(named).contacts == (ContactPair("b", "ground", 1.0),)
    (found,) = problems("ground z -9 m\n" + named)
    assert "ground is the name of an object and of a plane of the scene" in found.message and "another name" in found.hint
    (found,) = problems(pile("contact b b[1] { friction 1 }").replace("object ball", "object b"))
    assert "b is the name of an object and of a repeat" in found.message and "another name" in found.hint


def test_too_many_pairs(monkeypatch):
    """Refuse before they are listed."""
    monkeypatch.setattr("mdanim_lammps.features.contact.words.MOST_PAIRS", 8)
    (found,) = problems(pile("contact b b { friction 1 }"))
    assert "name more than 8 pairs" in found.message and "in the objects" in found.hint


def test_a_closing_brace_before_a_contact_is_missed():
    """Name the block that is not closed, not the words of the next."""
    (found,) = problems(
        pile().replace("s contact-model surface }", "s\n contact-model surface\n") + "contact b ball {\n friction 1 }\n"
    )
    assert "control, opened at line 8, is not closed before 'contact'" in found.message


def test_settings_with_a_hyphen_may_share_a_line():
    """A plain number ends before the next setting; an unknown one is told as such."""
    (contact,) = parse_scene(pile("contact b ball { friction 2*0.1 contact-damping 0.5 }")).contacts
    assert (contact.friction, contact.contact_damping) == (0.2, 0.5)
    (found,) = problems(pile("contact b ball { friction 0.1 contact-dumping 0.5 }"))
    assert "'contact' cannot follow here; friction is complete" in found.message


def test_a_switch_is_no_block():
    """`effects { contact off }` still switches the effect."""
    assert "contact" in parse_scene(pile("effects { contact off liquid off }")).effects


def test_what_a_name_stands_for():
    """An object, or all of a repeat."""
    assert objects_by_name(["a", "b[1]", "b[2]", "c[7]"]) == {
        "a": [0], "b[1]": [1], "b[2]": [2], "c[7]": [3], "b": [1, 2], "c": [3],
    }  # fmt: skip


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ([3], [1], [(1, 3)]),
        ([1, 2], [3], [(1, 3), (2, 3)]),
        ([0, 1, 2], [0, 1, 2], [(0, 1), (0, 2), (1, 2)]),
        ([0, 1], [1, 2], [(0, 1), (0, 2), (1, 2)]),
        ([2], [0, 1, 2], [(0, 2), (1, 2)]),
        ([4], [4], []),
    ],
)
def test_pairs_of_two_sets(first, second, expected):
    """Each pair once, whichever way it is named."""
    assert sorted(pairs_of(first, second)) == expected and sorted(pairs_of(second, first)) == expected


RULES = """contact b ball { friction 0.1 }
contact b b { contact-damping 0.5 }
contact ground b[2] { friction 0.9 }
"""


def test_friction_of_pairs():
    """A block's own; else the geometric mean of the objects', and damping where there is friction."""
    scene = parse_scene(pile(RULES, f"{SURFACE} friction 0.25", top="ground z -1 m\n", friction="0.64"))
    names = [s.name for s in scene.solids]
    assert sorted(pair_rules(scene, names)) == [
        (0, 1, 0.25, 0.5), (0, 2, 0.25, 0.5), (0, 3, 0.1, 0.3), (1, 2, 0.25, 0.5), (1, 3, 0.1, 0.3), (2, 3, 0.1, 0.3),
    ]  # fmt: skip
    assert pair_rules(scene, ["b[2]", "ball"]) == [(0, 1, 0.1, 0.3)]
    mixed = parse_scene(pile("contact b[1] ball { contact-damping 0 }", f"{SURFACE} friction 0.25", friction="0.64"))
    smooth = parse_scene(pile("contact b[1] ball { friction 0 }", f"{SURFACE} friction 0.25"))
    assert pair_rules(smooth, names) == [(0, 3, 0.0, 0.0)]
    assert pair_rules(mixed, names) == [(0, 3, pytest.approx(0.4), 0.0)]
    assert frictions(scene) == [0.25, 0.25, 0.25, 0.64]
    assert frictions(scene, "ground") == [0.25, 0.9, 0.25, 0.64] and frictions(scene, "walls") == frictions(scene)


@pytest.mark.parametrize(
    ("control", "contacts", "settings", "expected"),
    [
        ("", "", {}, False),
        ("friction 0.1", "", {}, True),
        ("", "contact b b { friction 0 }", {}, False),
        ("", "contact b b { friction 0.1 }", {}, True),
        ("", "", {"friction": "0.1"}, True),
    ],
)
def test_whether_anything_has_friction(control, contacts, settings, expected):
    """The scene, an object, or a pair."""
    assert any_friction(parse_scene(pile(contacts, f"{SURFACE} {control}", **settings))) == expected


def test_the_contact_of_the_paper_needs_one_spacing():
    """A resolution of an object with contact-model paper is refused at its word; without the model it is read."""
    text = (
        "object a { shape sphere 1 m position (0, 0, 0) m mass 1 kg elasticity 1 MPa resolution 10 cm }\n"
        "control { time 1 s contact-model paper }"
    )
    with pytest.raises(SceneError) as error:
        parse_scene(text)
    (found,) = error.value.problems
    assert found.message.startswith("a has a resolution of its own") and (found.span.line, found.span.column) == (1, 88)
    assert parse_scene(text.replace(" contact-model paper", "")).solids[0].resolution == 0.1
