# SPDX-License-Identifier: GPL-2.0-only
"""Reading scenes: the three scenes of the language page, one case per form, one case per mistake."""

import math
import time

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.liquid.record import LiquidModel
from mdanim_lammps.features.walls.words import Walls
from mdanim_lammps.scene import scene as records
from mdanim_lammps.scene.expressions import random_unit
from mdanim_lammps.scene.parse import load_scene, parse_scene
from paths import SCENES
from scene_parts import CONTROL, ball, pool, text


def number(expression: str, top: str = "") -> float:
    """An expression, read as the mass of the ball."""
    return ball(top, mass=expression).mass


# --- the three scenes of the contract ---------------------------------------------------------------------


def test_beam():
    """Read every value of beam.txt."""
    scene = load_scene(SCENES / "beam.txt")
    assert scene.name == "beam"
    assert scene.title == "Cube on an elastic beam"
    assert scene.gravity == (0.0, 0.0, -9.81)
    beam, cube = scene.solids
    assert beam.shape == records.Box((1.2, 0.3, 0.1))
    assert beam.position == (0.0, 0.0, 0.8)
    assert (beam.mass, beam.density) == (24.0, None)
    assert beam.elasticity == records.Young(2e6)
    assert beam.hold == (records.HoldFaces((records.Side.MINUS_X, records.Side.PLUS_X)),)
    assert cube.velocity == (0.0, 0.0, -1.0)
    assert scene.control == records.Control(time=3.0, frames=30.0)
    assert scene.path == (SCENES / "beam.txt").resolve()


def test_float():
    """Read float.txt: a let in a vector, a product with a unit, a rate, self-checks."""
    scene = load_scene(SCENES / "float.txt")
    water = scene.liquid
    assert (water.low, water.high) == ((-1.0, -1.0, 0.0), (1.0, 1.0, 1.2))
    assert (water.volume, water.level, water.drag) == (2.0, None, 4.0)
    cuboid = scene.solids[0]
    assert cuboid.shape == records.Box((0.4, 0.4, 0.2))
    assert cuboid.mass == pytest.approx(0.6 * 1000 * 0.4**3 / 2, rel=1e-15)
    assert scene.control.seed == 7
    draft = records.Expect("cuboid", "draft", 0.12, 0.01, 6.0)
    residual = records.Expect("liquid", "residual", 0.0)
    assert scene.expects[:2] == (draft, residual)


def test_crowd():
    """Read crowd.txt: an include, nested repeats, indices, random numbers within their bounds."""
    scene = load_scene(SCENES / "crowd.txt")
    assert [s.name for s in scene.solids] == [f"ball[{8 * i + j}]" for i in range(1, 9) for j in range(1, 9)]
    assert {s.elasticity for s in scene.solids} == {records.Young(150e3)}
    at = scene.solids[8 * 2 + 4]
    assert at.position == pytest.approx((3 * 0.4, 5 * 0.4, 0.6 + 0.3 * ((3 + 5) % 3)), rel=1e-15)
    speeds = [v for s in scene.solids for v in s.velocity[:2]]
    assert all(-1 <= v < 1 for v in speeds)
    assert len(set(speeds)) == 128
    # The mean of 128 numbers of variance 1/3 lies within 4 standard errors.
    assert abs(sum(speeds)) / 128 < 4 * math.sqrt(1 / 3 / 128)


# --- numbers ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("expression", "value"), [
    ("2 kg", 2.0), ("2", 2.0), ("1500 g", 1.5), ("2t", 2000.0), (".5", 0.5), ("1.", 1.0), ("1e3", 1000.0),
    ("2.5e-1 kg", 0.25), ("1 + 2*3", 7.0), ("(1 + 2)*3", 9.0), ("2^3^2", 512.0), ("-2^2 + 5", 1.0),
    ("2^-1", 0.5), ("7 mod 4", 3.0), ("12/2/3", 2.0), ("10 - 4 - 3", 3.0), ("-(-3)", 3.0), ("+3", 3.0),
    ("2*-3 + 7", 1.0), ("3 +-2", 1.0), ("sqrt(16)", 4.0), ("abs(-3)", 3.0), ("min(3, 1, 2)", 1.0),
    ("max(3, 1, 2)", 3.0), ("sin(90 deg)", 1.0), ("cos(0)", 1.0), ("tan(45 deg)", 1.0), ("pi", math.pi),
    ("2*pi kg", 2 * math.pi), ("(2 + 3) kg", 5.0), ("2 + 3 kg", 5.0), ("1 kg + 500 g", 1.5),
    ("1 kg - 500 g", 0.5), ("1 kg + 200 g + 300 g", 1.5), ("2 kg - 100 g - 200 g", 1.7), ("3*(2 kg)", 6.0),
    ("6 N*s^2/m", 6.0), ("sqrt(4 kg^2)", 2.0), ("(6 kg*m) / (2 m)", 3.0), ("max(1 kg, 500 g)", 1.0),
    ("18 t/h * 1", None), ("(36 kg/h)*(100 s)", 1.0), ("(\n 1 +\n 2\n) kg", 3.0),
])  # fmt: skip
def test_number(expression, value):
    """Calculate, with units in every place where one may stand."""
    if value is None:
        with pytest.raises(SceneError, match="a unit is expected after"):
            number(expression)
    else:
        assert number(expression) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(("top", "expression", "value"), [
    ("let a = 3\n", "a kg", 3.0),
    ("let a = 3\n", "2*a", 6.0),
    ("let m = 3\n", "m kg", 3.0),
    ("let m = 500 g\nlet b = m + 1 kg\n", "b", 1.5),
    ("let rho = 1000 kg/m^3\nlet a = 10 cm\n", "rho*a^3", 1.0),
    ("let density = 3\n", "density", 3.0),
    ("let m = 500 g\n", "1 + m + 2 + m kg", 4.0),
    ("let m = 500 g\n", "3 kg - m - 1 kg", 1.5),
    ("let v = (1, 2, 3)\nlet kg = 4\n", "kg kg", 4.0),
])  # fmt: skip
def test_let(top, expression, value):
    """Use lets as operands; right after a value the same word is a unit."""
    assert number(expression, top) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(("vector", "value"), [
    ("(1, 2, 3) m", (1, 2, 3)), ("(1, 2, 3)", (1, 2, 3)), ("(10 cm, 2, 30 mm)", (0.1, 2, 0.03)),
    ("((1 + 2)*2, -1, 4/2) cm", (0.06, -0.01, 0.02)), ("2*(1, 2, 3) m", (2, 4, 6)),
    ("(1, 2, 3) m + (0, 0, 1) m", (1, 2, 4)), ("-(1, 2, 3) m", (-1, -2, -3)), ("(2, 4, 6)/2 m", (1, 2, 3)),
    ("( 1,\n 2, # two\n 3 ) m", (1, 2, 3)), ("(1 m + 20 cm, 0, 0)", (1.2, 0, 0)),
])  # fmt: skip
def test_vector(vector, value):
    """Read vectors, with units inside and behind."""
    assert ball(position=vector).position == pytest.approx(value, rel=1e-14)


# --- every form -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("form", "shape"), [
    ("box (1, 2, 3) m", records.Box((1.0, 2.0, 3.0))),
    ("sphere 5 cm", records.Sphere(0.05)),
    ("ellipsoid (1, 2, 3) cm", records.Ellipsoid((0.01, 0.02, 0.03))),
    ("cylinder 5 cm 2 m", records.Cylinder(0.05, 2.0)),
    ("cone 5 cm 20 cm", records.Cone(0.05, 0.2)),
    ("torus 0.5 0.1", records.Torus(0.5, 0.1)),
    ("torus 50 cm 10 cm", records.Torus(0.5, 0.1)),
    ("torus (0.3 + 0.2) (0.1) m", None),
])  # fmt: skip
def test_shape(form, shape):
    """Read each shape; a number without a unit beside one with a unit is a warning."""
    if shape is None:
        scene = parse_scene(text(shape=form))
        assert scene.solids[0].shape == records.Torus(0.5, 0.1)
        assert "no unit" in scene.warnings[0].message
    else:
        assert ball(shape=form).shape == shape


def test_two_values_side_by_side_may_be_names():
    """Tell a second value from a unit: r and h are not units, so ``cylinder r h`` has two values."""
    assert ball("let r = 1\nlet h = 2\n", shape="cylinder r h").shape == records.Cylinder(1.0, 2.0)
    assert ball("let r = 1\nlet t = 2\n", shape="cylinder r (t)").shape == records.Cylinder(1.0, 2.0)


@pytest.mark.parametrize(("form", "body", "world"), [
    ("axis (0, 0, 2) angle 90 deg", (1, 0, 0), (0, 1, 0)),
    ("axis (1, 1, 1) angle 120 deg", (1, 0, 0), (0, 1, 0)),
    ("axis (1, 0, 0) angle pi/2", (0, 1, 0), (0, 0, 1)),
    ("euler (90, 0, 0) deg", (0, 1, 0), (0, 0, 1)),
    ("euler (0, 90, 0) deg", (0, 0, 1), (1, 0, 0)),
    ("euler (0, 0, 90) deg", (1, 0, 0), (0, 1, 0)),
    ("euler (90, 0, 90) deg", (0, 1, 0), (0, 0, 1)),
    ("euler (90, 90, 0) deg", (0, 1, 0), (1, 0, 0)),
    ("matrix (0, -1, 0) (1, 0, 0) (0, 0, 1)", (1, 0, 0), (0, 1, 0)),
])  # fmt: skip
def test_orientation(form, body, world):
    """Turn a body axis as worked out by hand; euler is about x, then y, then z, fixed axes."""
    rows = ball(orientation=form).rotation
    assert [sum(r * b for r, b in zip(row, body)) for row in rows] == pytest.approx(world, abs=1e-15)


@pytest.mark.parametrize(("form", "hold"), [
    ("faces z", records.HoldFaces((records.Side.MINUS_Z, records.Side.PLUS_Z))),
    ("face -x", records.HoldFaces((records.Side.MINUS_X,))),
    ("face +y", records.HoldFaces((records.Side.PLUS_Y,))),
    ("all", records.HoldAll()),
    ("within box (0, 0, 0) cm to (1, 1, 1) m", records.HoldWithin((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))),
])  # fmt: skip
def test_hold(form, hold):
    """Read each way to hold an object."""
    assert ball(hold=form).hold == (hold,)


def test_several_holds():
    """Hold an object in several places."""
    assert len(ball(hold="face -x\n  hold face +x\n  hold within box (0, 0, 0) to (1, 1, 1) m").hold) == 3


@pytest.mark.parametrize(("form", "value"), [
    ("elasticity", ("2 MPa", records.Young(2e6))),
    ("elasticity", ("spring 500 N/m", records.SpringConstant(500.0))),
    ("spin", ("(0, 0, 60) rpm", (0.0, 0.0, pytest.approx(2 * math.pi)))), ("drag", ("0.5 N*s/m", 0.5)),
    ("drag", ("0.5 kg/s", 0.5)), ("damping", ("0.1", 0.1)), ("color", ("steelblue", "#4682b4")),
    ("color", ('"#FF8000"', "#ff8000")), ("color", ('"Red"', "#ff0000")),
    ("velocity", ("(36, 0, 0) km/h", (10.0, 0.0, 0.0))),
])  # fmt: skip
def test_object_setting(form, value):
    """Read the other settings of an object."""
    assert getattr(ball(**{form: value[0]}), form) == value[1]


@pytest.mark.parametrize(("setting", "field", "value"), [
    ("frames 25 fps", "frames", 25.0), ("timestep 0.1 ms", "timestep", 1e-4),
    ("timestep auto", "timestep", None), ("resolution 4 cm", "resolution", 0.04),
    ("accuracy preview", "accuracy", records.Accuracy.PREVIEW),
    ("seed 7", "seed", 7),
    ("contact-stiffness 4", "contact_stiffness", 4.0), ("", "contact_stiffness", 1.0),
    ("save boundary", "save", records.Save.BOUNDARY), ("save all single", "single", True),
    ("save boundary double", "single", False),
])  # fmt: skip
def test_control_setting(setting, field, value):
    """Read the settings of control."""
    scene = parse_scene(text().replace("time 3 s", f"time 3 s {setting}"))
    assert getattr(scene.control, field) == value


def test_top_level():
    """Read ground, walls, effects and title, and remember where they stand."""
    scene = parse_scene(
        'title "a # b"\nground z -5 cm\nwalls from (-1, -1, 0) m to (1, 1, 2) m\neffects { contact off air-drag auto }\n' + text()
    )
    assert scene.title == "a # b"
    assert scene.ground == -0.05
    assert scene.walls == Walls((-1.0, -1.0, 0.0), (1.0, 1.0, 2.0))
    assert scene.effects == {"contact": records.Switch.OFF, "air-drag": records.Switch.AUTO}
    assert (scene.spans["ground"].line, scene.spans["effects.air-drag"].column) == (2, 23)


def test_render():
    """Read a picture of given size and a camera path that follows an object."""
    scene = parse_scene(
        text() + 'render { size (640, 480) movie "a.mp4" background white\n'
        "camera 0 s from (1, 2, 3) m look (0, 0, 0) m\ncamera 2 s from (1, 2, 4) m look ball up (0, 1, 0) }"
    )
    assert scene.render.size == (640, 480)
    assert (scene.render.movie, scene.render.background) == ("a.mp4", "#ffffff")
    assert scene.render.camera == (
        records.Camera((1.0, 2.0, 3.0), (0.0, 0.0, 0.0), 0.0),
        records.Camera((1.0, 2.0, 4.0), "ball", 2.0, (0.0, 1.0, 0.0)),
    )


def test_liquid_options():
    """Read a liquid given by its level, with the paper's model."""
    scene = parse_scene(
        "gravity (0, 0, -9.81)\nliquid sea { basin from (0, 0, 0) m to (1, 1, 1) m density 1 g/cm^3\n"
        "level 50 cm fill from (0, 0, 0) m to (0.5, 1, 0.6) m drag auto model paper sweeps 4 color navy }\n"
        "render { liquid cells }" + CONTROL
    )
    sea = scene.liquid
    assert (sea.name, sea.level, sea.volume, sea.drag, sea.sweeps) == ("sea", 0.5, None, None, 4)
    assert sea.density == 1000.0
    assert sea.model is LiquidModel.PAPER
    assert sea.fill == ((0.0, 0.0, 0.0), (0.5, 1.0, 0.6))
    assert (sea.color, scene.render.liquid) == ("#000080", "cells")


def test_the_model_of_the_paper_is_flagged():
    """Warn, at its word, that the literal rules are not Archimedes; the default needs no warning."""
    (warning,) = parse_scene(pool("volume 1 l model paper")).warnings
    assert (warning.severity, warning.line, warning.column) == ("warning", 3, 20)
    assert "not Archimedes" in warning.message and "0.4" in warning.message
    assert parse_scene(pool()).warnings == ()


@pytest.mark.parametrize(("ground", "told"), [(0.0, False), (-0.1, False), (0.01, True), (1.0, False)])
def test_ground_within_a_basin_is_flagged(ground, told):
    """Warn, at its height, where ground between floor and brim keeps solids from sinking; elsewhere it does no harm."""
    warnings = parse_scene(f"ground z {ground} m\n" + pool()).warnings
    assert len(warnings) == told
    if told:
        assert (warnings[0].severity, warnings[0].line, warnings[0].column) == ("warning", 1, 10)
        assert "above the floor of the basin" in warnings[0].message and "ground z 0 m" in warnings[0].hint


def test_expect_of_an_indexed_object():
    """Check one object of a repeat, in a repeat."""
    body = text(mass="i kg").replace("object ball", "object ball[i]").replace(CONTROL, "")
    scene = parse_scene(f"repeat i in 1 .. 2 {{ {body} expect ball[i].position.x at i s = i cm +- 1 mm }}\n" + CONTROL)
    assert [(e.subject, e.time, e.value) for e in scene.expects] == [("ball[1]", 1.0, 0.01), ("ball[2]", 2.0, 0.02)]


def test_spans_point_at_values():
    """Remember where each value of an object stands."""
    spans = ball(mass="(1 + 1) kg").spans
    assert (spans["mass"].line, spans["mass"].column, spans["mass"].width) == (4, 8, 10)
    assert (spans["object"].line, spans["object"].column, spans["object"].width) == (1, 8, 4)


def test_windows_text_reads_the_same():
    """Line ends, a byte order mark and no-break spaces change nothing."""
    plain = text()
    scene = parse_scene("\ufeff" + plain.replace("\n", "\r\n").replace("10 cm", "10\u00a0cm"))
    assert scene == parse_scene(plain)
    assert scene.solids[0].spans["mass"].line == 4


# --- repeat, rand, overrides ------------------------------------------------------------------------------

ROW = """
repeat i in 1 .. n {
  object b[i] { shape sphere 1 cm  position (rand(0, 1), i, rand(2, 3)) m  mass 1 kg  elasticity 1 MPa }
}
"""


def row(n: int, before: str = "", after: str = CONTROL) -> list[tuple]:
    """Positions of n random balls."""
    return [s.position for s in parse_scene(f"let n = {n}\n{before}{ROW}{after}").solids]


def test_a_scene_is_always_the_same_scene():
    """Random numbers depend on the seed, not on the time, a comment, or the number of repeats."""
    assert row(5) == row(5)
    assert row(5, before="# a comment\n\n") == row(5)
    assert row(9)[:5] == row(5)
    assert row(5, after="control { time 3 s seed 2 }") != row(5)


def test_seed_may_stand_after_its_use():
    """Find the seed first: blocks have no order. It may be a let."""
    late = row(3, after="control { time 3 s seed 42 }")
    early = row(3, before="let q = 42\ncontrol { time 3 s seed q }\n", after="")
    assert late == early


def test_rand_fills_its_range():
    """Draw evenly from [a, b): quarters of 4000 numbers hold 1000 each, within 5 standard deviations."""
    draws = [random_unit(1, 0, (i,)) for i in range(4000)]
    assert all(0 <= u < 1 for u in draws)
    quarters = [sum(q <= 4 * u < q + 1 for u in draws) for q in range(4)]
    assert all(abs(q - 1000) < 5 * math.sqrt(4000 * 3 / 16) for q in quarters)


def test_rands_differ_in_place_and_round():
    """No two rands of a scene, rounds of a repeat, or seeds share a number."""
    keys = [(seed, site, (i, j)) for seed in (1, 2) for site in (0, 1) for i in range(10) for j in range(10)]
    assert len({random_unit(*k) for k in keys}) == len(keys)


def test_override_takes_the_place_of_a_let():
    """--set gives a let another value: a number, or a text with a unit."""
    top = "let a = 2 kg\nlet b = 2*a\n"
    assert parse_scene(text(top, mass="b"), overrides={"a": "500 g"}).solids[0].mass == 1.0
    assert parse_scene(text("let a = 2\n", mass="a kg"), overrides={"a": 0.5}).solids[0].mass == 0.5


def test_override_without_unit_is_a_warning():
    """Tell how a bare number is read where the scene has a unit."""
    scene = parse_scene(text("let a = 200 kPa\n", elasticity="a"), overrides={"a": 150})
    assert scene.solids[0].elasticity == records.Young(150.0)
    assert "is read as 150 Pa; the scene has 200 kPa" in scene.warnings[0].message


@pytest.mark.parametrize(("overrides", "words"), [
    ({"b": "3"}, "--set b: the scene has no 'let b'"),
    ({"a": "3 m"}, "a is a mass in the scene, found 3 m"), ({"a": "3 kgg"}, "'kgg' is not a unit"),
    ({"a": ""}, "a number is expected here"), ({"a": "(1, 2, 3) kg"}, "a value of that kind is needed"),
    ({"a": "1 kg 2"}, "'2' follows another value"), ({"a": "inf"}, "'inf' has no value"),
    ({"a": float("nan")}, "'nan' has no value"), ({"a": "1e999"}, "too large"),
])  # fmt: skip
def test_bad_override(overrides, words):
    """Refuse an override that names nothing or is of another kind."""
    with pytest.raises(SceneError) as error:
        parse_scene(text("let a = 2 kg\n", mass="a"), overrides=overrides)
    assert any(words in p.message for p in error.value.problems), str(error.value)


def test_strict_wants_units():
    """Refuse bare numbers where a unit belongs, all of them in one pass; plain numbers stay plain."""
    scene = text(mass="2", position="(0, 0, 1)", damping="0.1")
    assert parse_scene(scene).solids[0].mass == 2.0
    with pytest.raises(SceneError) as error:
        parse_scene(scene, strict=True)
    assert [(p.line, p.column) for p in error.value.problems] == [(3, 12), (4, 8)]
    assert "write 2 kg" in error.value.problems[1].hint


def test_a_scene_may_ask_for_strictness_itself(tmp_path):
    """`language strict` holds wherever it stands, for included files too; `language free` is the default."""
    scene, line = text(mass="2", position="(0, 0, 1)", damping="0.1"), "language strict\n"
    (tmp_path / "ball.txt").write_text(scene)
    for strict in (line + scene, scene + line, line + 'include "ball.txt"\n'):
        with pytest.raises(SceneError) as error:
            parse_scene(strict, folder=tmp_path)
        assert ["has no unit" in p.message for p in error.value.problems] == [True, True]
    assert parse_scene("language free\n" + scene) == parse_scene(scene)


def test_strict_sees_through_sums():
    """Refuse a bare number that is added to a quantity."""
    with pytest.raises(SceneError, match="a bare number meets a quantity"):
        parse_scene(text(mass="1 kg + 0.5"), strict=True)


def test_thousands_of_objects_are_quick():
    """Expand a repeat of 3000 objects; ten times the usual processor time is allowed."""
    begin = time.process_time()
    assert len(row(3000)) == 3000
    assert time.process_time() - begin < 2.5


def test_a_large_size_without_unit_is_told():
    """``sphere 10`` is a ball of 10 m: a note with its place and a way out; with a unit, and below 5 m, none."""
    (note,) = parse_scene(text(shape="sphere 10")).warnings
    assert (note.severity, note.line, note.column) == ("note", 2, 16)
    assert "read in metres: 10 m" in note.message and "10 cm" in note.hint
    (note,) = parse_scene(text(shape="box (0.1, 20, 0.1)")).warnings
    assert "20 m" in note.message
    for shape in ("sphere 10 m", "sphere 1", "box (10, 10, 10) cm"):
        assert not parse_scene(text(shape=shape)).warnings


@pytest.mark.parametrize(
    ("let", "expression", "value"),
    [
        ("5 m", "gap + 20 cm", 5.2),
        ("5", "(gap + 20) cm", 0.25),
        ("5", "gap m + 20 cm", 5.2),
        ("5", "20 cm + gap", 5.2),
        ("5", "gap + 0.2 m", 5.2),  # a bare number is SI in any case
        ("5", "2*gap + 20 cm", 0.3),
        ("0", "gap + 20 cm", 0.2),
    ],
)
def test_sums_with_a_let_that_have_one_meaning(let, expression, value):
    """Brackets, a unit of its own, and the unit of SI say in which unit a number is."""
    scene = f"let gap = {let} object b {{ shape sphere 10 cm mass 1 kg elasticity 1 MPa position (0, 0, {expression}) }}"
    solids = parse_scene(f"{scene}\ncontrol {{ time 1 s }}".replace(" object", "\nobject")).solids
    assert solids[0].position[2] == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("lets", "expression", "column"),
    [
        ("let gap = 5", "gap + 20 cm", 0),
        ("let gap = 5", "1 m - gap + 20 cm", 6),
        ("let gap = 5", "-gap - 20 mm", 1),
        ("let a = 1 m\nlet gap = 5", "a + 2 + gap cm", 8),
        ("repeat i in 1 .. 1 { let gap = i", "gap + 20 cm", 0),
    ],
)
def test_a_let_without_unit_before_a_unit_is_refused(lets, expression, column):
    """With `let gap = 5` the sum `gap + 20 cm` would be 25 cm, and with `let gap = 5 m` 5.2 m."""
    repeat, place = "}" * lets.count("{"), "position (0, 0, "
    scene = f"{lets}\nobject b {{\nshape sphere 10 cm mass 1 kg elasticity 1 MPa\n{place}{expression})\n}}{repeat}"
    with pytest.raises(SceneError) as error:
        parse_scene(f"{scene}\ncontrol {{ time 1 s }}")
    (problem,) = error.value.problems
    unit = expression.split()[-1]
    assert (
        problem.message.removesuffix(" (with i = 1)")
        == f"gap has no unit and stands in a sum before {unit}: it could be in {unit} or in m"
    )
    assert problem.hint == f"write (gap + ...) {unit}, or gap m + ... {unit}; or give gap a unit in its let"
    assert problem.span.column == 1 + len(place) + column


def test_an_index_in_a_sum_has_the_unit_behind_it():
    """An index of a repeat is a number of the text, as a literal is."""
    scene = "repeat i in 1 .. 2 { object b[i] { shape sphere 1 cm mass 1 kg elasticity 1 MPa position (0, 0, i + 20 cm) } }"
    solids = parse_scene(f"{scene}\ncontrol {{ time 1 s }}").solids
    assert [s.position[2] for s in solids] == pytest.approx([0.21, 0.22])
