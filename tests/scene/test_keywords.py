# SPDX-License-Identifier: GPL-2.0-only
"""The keyword table: what it says about itself is true, and the docs page says the same."""

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.joints.words import TAKES
from mdanim_lammps.scene.forms import alternatives
from mdanim_lammps.scene.keywords import KEYWORDS, all_keywords
from mdanim_lammps.scene.page import language_page
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.scene import GLOBALS, QUANTITIES
from mdanim_lammps.scene.schema import Rule, syntax
from paths import REPOSITORY

WORDS = all_keywords()
PAGE = REPOSITORY / "docs" / "language.md"

BALL = {"shape": "sphere 10 cm", "position": "(0, 0, 1) m", "mass": "2 kg", "elasticity": "200 kPa"}
WATER = {"basin": "from (-1, -1, 0) m to (1, 1, 1.2) m", "density": "1000 kg/m^3", "volume": "2 m^3"}


DUCK = REPOSITORY / "scenes" / "meshes" / "duck.ply"
OF_SURFACES = ("friction", "contact-damping")
"""Settings that the contact of the paper has only as 0."""


def scene(block: str, **settings: str):
    """A small scene in which one block has these settings in place of, or beside, its usual ones."""
    blocks = {"object": dict(BALL), "liquid": dict(WATER), "control": {"time": "3 s"}, "render": {}, "effects": {}}
    if block == "contact":
        blocks |= {"contact": {}, "floor": dict(BALL)}
    if block == "place":
        blocks |= {"place": {}}
    kind = next((kind for word in settings for kind in TAKES.get(word, ())), "hinge")
    if block == "joint" or "joint." in settings.get("expect", ""):
        blocks |= {"joint": {"axis": "(0, 1, 0)"} if kind in TAKES["axis"] else {}, "floor": dict(BALL)}
    if block == "air" or "air." in settings.get("expect", ""):
        blocks |= {"air": {}}
    if block == "contact" or any(settings.get(word, "0") != "0" for word in OF_SURFACES):
        blocks["control"]["contact-model"] = "surface"
    if {"restitution", "rolling"} & set(settings):  # of rigid objects
        for name in {"object", "floor"} & set(blocks):
            blocks[name]["elasticity"] = "rigid"
    if "origin" in settings:
        blocks["object"]["shape"] = f'mesh "{DUCK}"'
    if "pieces" in settings:
        blocks["object"] |= {"elasticity": "rigid", "strength": "1 MPa"}
        del blocks["liquid"]
    if {"tear-strain", "toughness"} & set(settings):
        blocks["object"]["shape"] = "rope from (0, 0, 0) m to (1, 0, 0) m thickness 1 cm"
        del blocks["object"]["position"], blocks["liquid"]
    if "runs" in settings:
        blocks["wheel"] = BALL | {"shape": "cylinder 10 cm 6 cm", "orientation": "axis (1, 0, 0) angle 90 deg"}
        blocks["object"]["shape"] = "rope from (-1, 0, 0) m to (1, 0, 0) m thickness 1 cm"
        del blocks["object"]["position"], blocks["liquid"]
    if "inflate" in settings:
        blocks["object"]["shape"] = "sphere 10 cm sheet thickness 1 mm"
        del blocks["liquid"]
    if block == "hand":
        blocks["hand"] = {"at": "(0, 0, 0) m", "key": "0 s at (0, 0, 0) m  key 2 s at (0, 0, 1) m"}
        if "key" in settings:
            settings = {"key": f"{settings['key']}  key 2 s at (0, 0, 1) m"}
    if block == "joint" and "restitution" in settings:
        blocks["joint"]["limits"] = "-30 deg to 60 deg"
    if "(floor)" in settings.get("expect", ""):
        blocks["floor"] = dict(BALL)
    if "pool" in settings:
        del blocks["liquid"]["volume"]
        blocks["liquid"] |= {"fill": "from (-1, -1, 0) m to (0, 1, 1.2) m", "level": "0.5 m"}
    if settings.get("sweeps", "auto") != "auto":
        blocks["liquid"]["model"] = "surface"
    top = {"gravity": "(0, 0, -9.81) m/s^2"}
    chosen = blocks[block] if block else top
    for word in settings:
        for other in KEYWORDS[block][word].one_of:
            chosen.pop(other, None)
    chosen |= settings
    text = "".join(f"{word} {value}\n" for word, value in top.items())
    for name, content in blocks.items():
        heads = {
            "object": "object ball",
            "liquid": "liquid water",
            "contact": "contact ball floor",
            "floor": "object floor",
            "wheel": "object wheel",
        }
        head = (heads | {"place": "group few { } place few", "joint": f"joint {kind} ball floor", "hand": "hand ball"}).get(
            name, name
        )
        text += f"{head} {{\n" + "".join(f"  {w} {v}\n" for w, v in content.items()) + "}\n"
    return parse_scene(text)


def test_page_is_up_to_date():
    """The committed page is what ``python -m mdanim_lammps.scene.keywords`` writes."""
    assert PAGE.read_text(encoding="utf-8") == language_page()


@pytest.mark.parametrize("k", WORDS, ids=lambda k: f"{k.block}.{k.name}")
def test_example_of_each_keyword_parses(k):
    """Examples that messages propose can be written; what moves a held part, where something is held."""
    held = {"hold": "all"} if k.block == "object" and k.name in ("drive", "key", "release") else {}
    scene(k.block, **{k.name: k.example}, **held)


DEFAULTS = [k for k in WORDS if k.default and k.block != "effects" and k.name != "gravity"]


@pytest.mark.parametrize("k", DEFAULTS, ids=lambda k: f"{k.block}.{k.name}")
def test_default_of_each_keyword_is_the_default(k):
    """Writing the default changes nothing."""
    assert scene(k.block, **{k.name: k.default}) == scene(k.block)


def test_default_gravity_is_none():
    """Writing zero gravity is writing no gravity."""
    text = "object a { shape sphere 1 m position (0, 0, 0) m mass 1 kg elasticity 1 MPa } control { time 1 s }"
    assert parse_scene(f"gravity {KEYWORDS['']['gravity'].default}\n{text}") == parse_scene(text)


@pytest.mark.parametrize("k", [k for k in WORDS if k.rule is not Rule.ANY], ids=lambda k: f"{k.block}.{k.name}")
def test_rule_of_each_keyword_is_kept(k):
    """A number that breaks the rule is refused in the words of the table."""
    broken = {
        "shape": "sphere -1 m",
        "size": "(0, 5)",
        "wave": "-x amplitude -2 cm period 1 s",
        "current": "+y speed -2 m/s",
        "arrows": "velocity scale -1",
        "trail": "ball -1 s",
        "texture": "checker size -5 cm",
        "caption": '"x" from -1 s',
    }
    bad = broken.get(k.name, f"-{k.example}")
    with pytest.raises(SceneError) as error:
        scene(k.block, **{k.name: bad})
    assert any(f"must be {k.rule.value}, found" in p.message for p in error.value.problems)


@pytest.mark.parametrize("quantity", QUANTITIES, ids=".".join)
def test_every_quantity_can_be_expected(quantity):
    """Each row of the table of quantities is read, in its own unit."""
    kind, what = quantity
    name = kind if kind in GLOBALS else "ball"
    unit = QUANTITIES[quantity][0].replace("1", "")
    taken = {"object": "(floor)", "joined": "(floor)", "place": "(0.1 m, 20 cm)", "cut": "(0.1 m)"}.get(
        QUANTITIES[quantity].takes, ""
    )
    expect = scene("", expect=f"{name}.{what}{taken} at 1 s = 0.5 {unit} +- 0.1 {unit}").expects[0]
    assert (expect.subject, expect.quantity, expect.value, expect.tolerance, expect.time) == (name, what, 0.5, 0.1, 1.0)


def test_forms_are_unambiguous():
    """At most one alternative of a form begins without a word of its own."""
    for k in WORDS:
        free = [a for a in alternatives(k.form) if not hasattr(a[0], "text") or hasattr(a[0], "kind")]
        assert len(free) <= 1, k.name


def test_syntax_is_the_form_without_its_marks():
    """Show a form as people write it."""
    assert syntax(KEYWORDS["object"]["shape"]).startswith("box (lx, ly, lz) [sheet thickness t [bending f]] | sphere r [sheet")
    assert syntax(KEYWORDS["render"]["camera"]).startswith("[T] from (x, y, z) look (x, y, z)|NAME [up (x, y, z)] | top")
