# SPDX-License-Identifier: GPL-2.0-only
"""``material oak``, ``material NAME { ... }``: what follows for an object from what it is made of."""

import math
from pathlib import Path

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.materials import page
from mdanim_lammps.features.materials.resolve import STIFF
from mdanim_lammps.features.materials.table import CHOSEN, MATERIALS, PAIRS, SOURCES
from mdanim_lammps.features.rigid.words import Rigid
from mdanim_lammps.scene.explain import explain
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.shapes import SpringConstant, Young

CONTROL = "control { time 1 s }\n"
AT = "position (0, 0, 1) m shape sphere 5 cm"
ROPE = "shape rope from (0, 0, 1) m to (1, 0, 1) m thickness 1 cm"
DOCS = Path(__file__).parents[2] / "docs" / "materials.md"


def solids(text: str) -> dict:
    """Objects of a scene by name."""
    return {s.name: s for s in parse_scene(text + CONTROL).solids}


def one(body: str, before: str = ""):
    """The object of a scene of one."""
    return solids(f"{before}\nobject a {{ {body} }}\n")["a"]


def problems(text: str) -> list:
    """The problems of a bad scene."""
    with pytest.raises(SceneError) as error:
        parse_scene(text + CONTROL)
    return error.value.problems


@pytest.mark.parametrize("name", MATERIALS)
def test_the_figures_are_those_of_the_table(name):
    """Each material gives an object the values of its row, rigid or elastic by the speed of waves in it."""
    of, a = MATERIALS[name], one(f"material {name} {AT}")
    assert (a.density, a.mass, a.friction, a.color) == (of.density.value, None, of.friction.value, of.color)
    if math.sqrt(of.elasticity.value / of.density.value) >= STIFF:
        assert a.elasticity == Rigid() and a.restitution == of.restitution.value and a.damping == 0.0
    else:
        assert a.elasticity == Young(of.elasticity.value) and a.damping == of.damping.value and a.restitution is None


def test_what_cannot_be_rigid_has_its_elasticity():
    """A rope, a sheet and what is held in a part bend; what is held as a whole is rigid, and has restitution."""
    beam = one("material oak shape box (1, 0.1, 0.1) m position (0, 0, 1) m hold face -x")
    assert (beam.elasticity, beam.restitution, beam.damping) == (Young(11e9), None, 0.0)
    rope = one(f"material cotton {ROPE}")
    assert (rope.elasticity, rope.restitution, rope.damping) == (Young(5e8), None, 0.2)
    sheet = one("material cotton shape sheet (1, 1) m thickness 1 mm position (0, 0, 1) m")
    assert (sheet.elasticity, sheet.density, sheet.restitution) == (Young(1e7), 470.0, None)  # of cloth, not of its threads
    held = one(f"material oak {AT} hold all")
    assert (held.elasticity, held.restitution) == (Rigid(), 0.5)
    mat = one(f"material rubber {AT} hold all")
    assert (mat.elasticity, mat.restitution) == (Young(2e6), 0.75)
    loose = one(f"material rubber {AT} hold all release 0.1 s")  # it is held until then, and deforms
    assert (loose.elasticity, loose.restitution, loose.damping) == (Young(2e6), None, 0.6)
    thrown = one(f"material oak {AT} hold all release 0.1 s")
    assert (thrown.elasticity, thrown.restitution) == (Rigid(), 0.5)


@pytest.mark.parametrize("order", ["material oak {own} {at}", "{own} {at} material oak", "{at} {own} material oak"])
def test_words_beside_it_count_wherever_they_stand(order):
    """Also mass in place of density; damping follows an elasticity of its own, restitution goes."""
    write = lambda own: one(order.format(own=own, at=AT))
    assert (write("density 900 kg/m^3").density, write("friction 0").friction) == (900.0, 0.0)
    assert (write("mass 3 kg").mass, write("mass 3 kg").density) == (3.0, None)
    soft = write("elasticity 3 MPa")
    assert (soft.elasticity, soft.restitution, soft.damping) == (Young(3e6), None, 0.0)
    assert write("elasticity spring 300 N/m").elasticity == SpringConstant(300.0)
    hard = one(order.format(own="elasticity rigid", at=AT).replace("oak", "rubber"))
    assert (hard.elasticity, hard.restitution, hard.damping) == (Rigid(), 0.75, 0.0)


def test_materials_in_settings_that_are_used():
    """A let with a material in it; what the let says counts before its material, what the object says before both."""
    wood = "let wood = { material oak color navy }\n"
    assert (one(f"use wood {AT}", wood).color, one(f"use wood {AT}", wood).density) == ("#000080", 700.0)
    assert one(f"use wood material pine {AT}", wood).density == 500.0
    assert one(f"use wood {AT} density 1 kg/m^3", wood).density == 1.0


def test_own_materials():
    """They may stand below their use, build on others, and stand for another form of a known one; the rule is the same."""
    balsa = "material balsa { material pine density 170 kg/m^3 }\n"
    a = solids(f"object a {{ material balsa {AT} }}\n" + balsa)["a"]
    assert (a.density, a.friction, a.elasticity, a.material) == (170.0, 0.4, Rigid(), "balsa")
    dark = "material oak { material oak color black }\n"
    assert (one(f"material oak {AT}", dark).color, one(f"material oak {AT}", dark).density) == ("#000000", 700.0)
    goo = "material goo { density 1000 kg/m^3 elasticity 3 kPa damping 0.5 restitution 0.1 }\n"
    b = one(f"material goo {AT}", goo)
    assert (b.elasticity, b.damping, b.restitution, b.color) == (Young(3e3), 0.5, None, None)
    assert one(f"material goo {AT}", goo + "object goo { material oak shape sphere 1 m position (0, 0, 5) m }\n").damping == 0.5


def test_cloth_of_own_materials():
    """The base of a block gives a sheet the figures of cloth, unless the block has its own."""
    sheet = "shape sheet (1, 1) m thickness 1 mm position (0, 0, 1) m"
    soft = one(f"material canvas {sheet}", "material canvas { material cotton color navy }")
    assert (soft.elasticity, soft.density) == (Young(1e7), 470.0)
    own = one(f"material canvas {sheet}", "material canvas { material cotton elasticity 50 MPa density 600 kg/m^3 }")
    assert (own.elasticity, own.density) == (Young(5e7), 600.0)
    assert one(f"material paper {sheet}").elasticity == Young(3e9)


def test_scenes_without_the_word_and_locks():
    """The same records; the lock has what followed from the material, and is read as the same scene."""
    plain = f'object a {{ density 930 kg/m^3 elasticity 2 MPa damping 0.6 friction 1 color "#3a3d42" {AT} }}\n{CONTROL}'
    scene = parse_scene(f"object a {{ material rubber {AT} }}\n{CONTROL}")
    assert scene == parse_scene(plain) and scene.solids[0].material == "rubber"
    assert lock_text(scene) == lock_text(parse_scene(plain))
    own = parse_scene(f"material goo {{ material jelly }}\nobject a {{ material goo {AT} }}\n{CONTROL}")
    assert parse_scene(lock_text(own), own.name) == own


MISTAKES = [
    ("unknown", f"object a {{ material oka {AT} }}", 1, 21, "no material is called oka", "did you mean 'oak'?"),
    ("in itself", f"material goo {{ material bar }}\nobject a {{ material oak {AT} }}", 1, 25, "no material is called bar",
     "known here: steel,"),
    ("wood", f"object a {{ material wood {AT} }}", 1, 21, "no material is called wood", "did you mean 'oak' or 'pine'?"),
    ("far off", f"object a {{ material xyzzy {AT} }}", 1, 21, "no material is called xyzzy", "known here: steel,"),
    ("own one", f"material goo {{ }}\nobject a {{ material gop {AT} }}", 2, 21, "no material is called gop", "'goo'"),
    ("twice", f"object a {{ material oak material pine {AT} }}", 1, 25, "material is given twice", "scene:1:12"),
    ("no name", f"object a {{ material {AT} }}", 1, 12, "nothing follows material", "e.g. material oak"),
    ("in quotes", f'object a {{ material "oak" {AT} }}', 1, 21, "material needs a name, found", "leave out the quotes"),
    ("a circle", f"material u {{ material w }}\nmaterial w {{ material u }}\nobject a {{ material u {AT} }}", 2, 23,
     "is made of itself: u -> w -> u", "take one"),
    ("too little", f"material goo {{ density 3 kg/m^3 }}\nobject a {{ material goo {AT} }}", 2, 8,
     "object a has no elasticity", ""),
    ("own name twice", "material u { }\nmaterial u { }", 2, 10, "the name u is given twice", "scene:1:10"),
    ("a bad value", f"material u {{ density -3 kg/m^3 elasticity 1 MPa }}\nobject a {{ material u {AT} }}", 1, 22,
     "density must be > 0", ""),
    ("no setting of a material", "material u { mass 3 kg }", 1, 14, "'mass' cannot stand inside material { }", "object { }"),
    ("paper", f"object a {{ material oak {AT} }}\ncontrol {{ time 1 s contact-model paper }}\n#", 1, 21, "a is rigid", ""),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line", "column", "words", "hint"), [m[1:] for m in MISTAKES], ids=[m[0] for m in MISTAKES])
def test_mistakes(text, line, column, words, hint):
    """One problem at the place, with cause and way out."""
    found = problems(text + "\n") if "control" not in text else problems(text)
    (problem,) = [p for p in found if (p.line, p.column) == (line, column) and words in p.message] or found
    assert (problem.line, problem.column) == (line, column), str(problem)
    assert words in problem.message and hint in problem.hint
    assert words.startswith("object a has") or not any("a has no" in p.message for p in found), found


def test_a_wrong_word_behind_a_material_hides_nothing():
    """A setting that is complete before a word that cannot follow is looked at, too."""
    told = [p.message for p in problems(f"object a {{ material wood velocty (1, 0, 0) m/s {AT} }}\n")]
    assert told == ["no material is called wood", "'velocty' cannot follow here; material is complete"]


def test_a_problem_in_a_material_names_its_use():
    """A fault for an object alone is told at the material, with the place that uses it."""
    text = f"material u {{ density 3 kg/m^3 elasticity rigid }}\nobject a {{ material u {AT} damping 0.3 }}\n"
    (problem,) = problems(text)
    assert "a is rigid" in problem.message
    (problem,) = problems(f"material u {{ density 3 kg/m^3 elasticity rigid }}\nobject a {{ material u {ROPE} }}\n")
    assert (problem.line, [str(s) for s in problem.span.used_at]) == (1, ["scene:2:12"])


def test_every_figure_has_its_range_and_source():
    """The value lies in the range; what has no source says so."""
    for name, material in MATERIALS.items():
        for word, figure in material.figures().items():
            assert figure.low <= figure.value <= figure.high, (name, word)
            assert all(key in SOURCES for key in figure.sources()), (name, word)
            assert figure.source != CHOSEN or figure.low == figure.high
        assert (material.restitution is None) or 0.0 <= material.restitution.value <= 1.0
        stiff = page.speed(material)
        assert stiff >= 1.5 * STIFF or stiff <= STIFF / 1.5, f"{name} is near the rule, where a digit more would decide"
    used = {key for m in MATERIALS.values() for f in (*m.figures().values(), *m.sheet.values()) for key in f.sources()} | set(
        "".join(p[4] for p in PAIRS)
    )
    assert used | {"J"} == set(SOURCES)


def test_the_page_and_explain_have_the_table():
    """docs/materials.md is printed from the table, and so is `explain`."""
    assert DOCS.read_text(encoding="utf-8") == page.page(), (
        "run python -m mdanim_lammps.features.materials.page > docs/materials.md"
    )
    told = explain("oak")
    assert "density 700 kg/m^3   found 590 kg/m^3 to 930 kg/m^3" in told and "so its objects are rigid" in told
    assert "rubber" in explain("rubber") and "elastic" in explain("rubber")
    assert "instead: material oak or material pine" in explain("wood")
    for row in PAIRS:
        assert f"| {row[0]}, {row[1]} | " in page.page()
