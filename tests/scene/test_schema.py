# SPDX-License-Identifier: GPL-2.0-only
"""A keyword is one field of a record: parser, range check, message, docs and lock follow from it."""

import re
from dataclasses import dataclass, replace

import pytest
from mdanim_lammps.errors import SceneError, UsageError
from mdanim_lammps.features.contact.words import ContactModel
from mdanim_lammps.scene import keywords as language
from mdanim_lammps.scene import scene as records
from mdanim_lammps.scene import schema
from mdanim_lammps.scene.limits import Limit
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.page import language_page
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.render import Floor, Quality, Render
from mdanim_lammps.scene.scene import Control, SceneRecord, Solid
from mdanim_lammps.scene.schema import Rule, keywords, setting
from scene_parts import CONTROL, text


@dataclass(frozen=True, slots=True)
class RoughSolid(Solid):
    """A Solid with one field more: this line is all that a keyword needs."""

    grip: float = setting("<mu>", "How rough it is.", "0.3", Rule.NOT_NEGATIVE, default=0.0, limit=Limit("grip", 5.0))


@dataclass(frozen=True, slots=True)
class FineControl(Control):
    """Another kind of value: a length, or ``auto``."""

    grain_size: float | None = setting("auto | <d:m>", "Size of a grain.", "3 mm", Rule.POSITIVE, default=None)


@dataclass(frozen=True, slots=True)
class Touch:
    """A block with the names of two objects."""

    a: str
    b: str
    grip: float = setting("<mu>", "How rough the two are on each other.", "0.3", Rule.NOT_NEGATIVE)
    reach: float | None = setting("auto | <d:m>", "How far apart they feel it.", "1 cm", Rule.POSITIVE, default=None)


@dataclass(frozen=True, slots=True)
class TouchingScene(SceneRecord):
    """A scene that holds such blocks."""

    touches: tuple[Touch, ...] = ()


@pytest.fixture
def extended(monkeypatch):
    """The language with a field more in two blocks, and a block for pairs of objects."""

    def put(block: language.Block) -> None:
        monkeypatch.setitem(language.BLOCKS, block.name, block)
        monkeypatch.setitem(language.KEYWORDS, block.name, keywords(block.name, block.record))

    put(replace(language.BLOCKS["object"], record=RoughSolid))
    put(replace(language.BLOCKS["control"], record=FineControl))
    pair = language.Block(
        "touch", Touch, "touches", "Two objects that touch.", names=("a", "b"), indexed=True, of_objects=True, many=True
    )
    put(pair)
    monkeypatch.setattr(language, "SCENE", TouchingScene)


def problem(scene: str):
    """The one problem of a scene."""
    with pytest.raises(SceneError) as error:
        parse_scene(scene)
    (found,) = error.value.problems
    return found


def test_field_is_a_keyword(extended):
    """Parsed, range-checked, documented, locked, read back."""
    scene = parse_scene(text(grip="0.5"))
    assert scene.solids[0].grip == 0.5
    assert (scene.solids[0].spans["grip"].line, scene.solids[0].spans["grip"].column) == (6, 8)
    assert parse_scene(text()).solids[0].grip == 0.0
    assert re.search(r"^  grip +0\.5$", lock_text(scene), re.M)
    assert parse_scene(lock_text(scene), strict=True) == scene
    assert "| **grip** `mu` | - | >= 0 | `0` | How rough it is. |" in language_page()


@pytest.mark.parametrize(("value", "column", "words", "hint"), [
    ("-1", 8, "grip must be >= 0, found -1", ""), ("6", 8, "grip is too large: it goes up to 5, found 6", ""),
    ("1 m", 8, "grip must be a plain number, found 1 m, a length", "leave out the unit"),
    ("(1, 2, 3)", 8, "grip is a number, found the vector", ""), ("", 3, "nothing follows grip", "e.g. grip 0.3"),
])  # fmt: skip
def test_field_is_checked(extended, value, column, words, hint):
    """Every message that keywords have, at its place."""
    found = problem(text(grip=value))
    assert words in found.message
    assert hint in found.hint
    assert (found.line, found.column) == (6, column)


def test_field_is_suggested(extended):
    """A mistyped word is compared with it."""
    assert problem(text(gripp="1")).hint == "did you mean 'grip'?"


def test_field_with_a_unit_or_auto(extended):
    """None is written and read as auto; a hyphen stands for the underscore."""
    scene = parse_scene(text().replace("3 s", "3 s grain-size 3 mm"))
    assert scene.control.grain_size == 0.003
    assert "grain-size        0.003 m" in lock_text(scene)
    assert parse_scene(lock_text(scene)) == scene
    assert parse_scene(text().replace("3 s", "3 s grain-size auto")).control == parse_scene(text()).control
    assert "| **grain-size** `auto`<br>or `d` | m | > 0 | `auto` | Size of a grain. |" in language_page()


ROW = "repeat i in 1 .. 2 { object b[i] { shape sphere 1 cm position (i, 0, 0) m mass 1 kg elasticity 1 MPa } }\n"


def test_block_of_two_objects(extended):
    """A block that names two objects is read into a record with both names, also in a repeat, and written back."""
    pairs = "touch b[1] ball { grip 0.5 reach 2 cm }\nrepeat i in 1 .. 1 { touch b[i] b[i + 1] { grip i/10 } }\n"
    scene = parse_scene(ROW + text() + pairs)
    assert scene.touches == (Touch("b[1]", "ball", 0.5, 0.02), Touch("b[1]", "b[2]", 0.1))
    assert "touch b[1] ball {\n  grip  0.5\n  reach 0.02 m\n}\n" in lock_text(scene)
    assert parse_scene(lock_text(scene)) == scene
    assert "touch NAME[index] NAME[index] { ... }" in language_page()


def test_block_of_two_objects_is_checked(extended):
    """An unknown object, a missing name, a missing setting."""
    assert problem(ROW + text() + "touch b[1] bal { grip 1 }\n").message == "no object is called bal"
    assert "a name is missing after touch" in problem(ROW + text() + "touch b[1] { grip 1 }\n").message
    assert "touch b[1] ball has no grip" in problem(ROW + text() + "touch b[1] ball { }\n").message


def test_without_it_the_words_are_unknown():
    """The tests above see the fields, not words that the language has anyway."""
    assert "'grip' is not a setting of object" in problem(text(grip="1")).message
    assert "'touch' is not a word" in problem(ROW + text() + "touch b[1] ball { grip 1 }\n").message


def test_order_of_blocks_is_free():
    """Control may stand first or last."""
    assert parse_scene(text()).control == parse_scene(CONTROL + text().replace(CONTROL, "")).control


def test_words_of_an_enumeration_are_taken_in_python():
    """``Render(quality="final")`` is what a scene says; another word is refused with those that there are."""
    assert Render(quality="final", floor="none") == Render(quality=Quality.FINAL, floor=Floor.NONE)
    control = records.Control(1.0, accuracy="preview", contact_model="paper", save="boundary")
    assert (control.accuracy, control.save) == (records.Accuracy.PREVIEW, records.Save.BOUNDARY)
    assert control.contact_model is ContactModel.PAPER
    for wrong in ("finest", 3, None):
        with pytest.raises(UsageError, match=re.escape(f"Render(quality={wrong!r}): it is one of draft, final")):
            Render(quality=wrong)
    with pytest.raises(UsageError, match="it is one of preview, balanced, reference"):
        replace(control, accuracy="fine")


def test_a_setting_of_a_feature_needs_a_type(monkeypatch):
    """Without one it would not be a field, and nobody would hear of it."""

    class Words:
        OBJECT = type("Bare", (), {"__annotations__": {}, "sail": setting("<A>", "A sail.", "2", default=1.0)})

    monkeypatch.setattr(schema, "facets", lambda kind: [Words])
    with pytest.raises(TypeError, match="the setting sail of OBJECT has no type"):
        schema.with_words(records.Solid, "OBJECT")
