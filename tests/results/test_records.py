# SPDX-License-Identifier: GPL-2.0-only
"""Records of a scene: columns, units, the force of contact by momentum, and windows of ``expect``."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from mdanim_lammps import Interrupted, OutputError, Run, Scene
from mdanim_lammps.effects.measured import Measured
from mdanim_lammps.errors import SceneError
from mdanim_lammps.results.records import Records
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.quantities import Asked

G = 9.81
RESTING = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object low   { shape box (10, 10, 10) cm  position (0, 0, 5) cm  mass 1 kg  elasticity 1 MPa  damping 0.3 }
object high  { shape box (8, 8, 8) cm  position (0, 0, 14) cm  mass 0.5 kg  elasticity 1 MPa  damping 0.3 }
object stone { shape box (10, 10, 10) cm  position (1, 0, 0.05) m  mass 2 kg  elasticity rigid }
object ball  { shape sphere 4 cm  position (1, 0, 0.14) m  mass 0.3 kg  elasticity rigid }
object light { shape box (6, 6, 6) cm  position (2, 0, 0.03) m  mass 0.3 kg  elasticity 3 MPa  damping 0.3 }
object lid   { shape box (6, 6, 6) cm  position (2, 0, 0.09) m  mass 0.1 kg  elasticity rigid }
control { time 0.8 s  frames 25 fps  friction 0.5  resolution 4 cm }
"""
MASS = {"low": 1.0, "high": 0.5, "stone": 2.0, "ball": 0.3, "light": 0.3, "lid": 0.1}


def test_contact_of_what_rests_is_its_weight(tmp_path):
    """In the mean of each frame once it has come to rest: elastic and rigid ones, on the ground, on each other, mixed."""
    text = RESTING + "".join(f"record {name}.contact.z\n" for name in MASS)
    run = Scene.from_text(text + "record world.contact.z\nrecord world.contact.x\n", "resting").run(tmp_path / "r")
    for name, mass in MASS.items():
        np.testing.assert_allclose(run.records[f"{name}.contact.z"][-5:], mass * G, rtol=1e-3, err_msg=name)
        assert np.isnan(run.records[f"{name}.contact.z"][0])
    np.testing.assert_allclose(run.records["world.contact.z"][-5:], -G * sum(MASS.values()), rtol=1e-3)
    np.testing.assert_allclose(run.records["world.contact.x"][-5:], 0.0, atol=1e-3)


FLIES = """
gravity at 0 s (0, 0, -9.81) m/s^2
gravity at 0.2 s (1, 0, -9.81) m/s^2
gravity at 0.5 s (0, 0, -3) m/s^2
object ball { shape sphere 5 cm  position (0, 0, 5) m  mass 1 kg  elasticity 1 MPa  velocity (3, 0, 1) m/s  drag 0.8 N*s/m
  force (0, 2, 0) N from 0.13 s to 0.31 s }
object cube { shape box (5, 5, 5) cm  position (1, 0, 5) m  mass 1 kg  elasticity rigid  drag 0.5 N*s/m  force (0, 3, 0) N }
control { time 0.6 s  frames 20 fps  resolution 5 cm }
"""


def test_potential_energy_of_a_fall(free_fall):
    """m g h less than at the start, m v^2/2 more."""
    from mdanim_lammps.results.quantities import series

    t = free_fall.trajectory
    measured = Measured(free_fall.scene.record, t.names, None, t.times, t.centers, t.center_velocities, 0.0, None, t)
    potential, speed = (series(Asked("other", word), measured) for word in ("potential", "speed"))
    np.testing.assert_allclose(potential, -0.5 * t.metadata.object_mass[0] * speed**2, atol=1e-9)
    assert potential[0] == 0.0 and potential[-1] < -1.0


def test_nothing_touches_what_flies(tmp_path):
    """Weight that changes, drag and forces in windows are known, so what is left of the momentum is nothing."""
    text = FLIES + "".join(f"record {name}.contact\nrecord {name}.force.{axis}\n" for name in ("ball", "cube") for axis in "xyz")
    records = Scene.from_text(text, "flies").run(tmp_path / "r").records
    for name in ("ball", "cube"):
        np.testing.assert_allclose(records[f"{name}.contact"][1:], 0.0, atol=1e-5)
        assert np.abs(records[f"{name}.force.z"][1:]).max() > 2.0
    assert list(records)[:3] == ["time", "ball.contact", "ball.force.x"]  # once each


TURNS = """
object wheel { shape cylinder 10 cm 5 cm position (0, 0, 0) m  mass 2 kg  elasticity rigid  spin (0, 0, 20) rad/s
  velocity (1, 0, 0) m/s }
object far { shape sphere 5 cm  position (0, 1, 0) m  mass 1 kg  elasticity 1 MPa  velocity (0, 2, 0) m/s }
control { time 1 s  frames 30 fps  resolution 5 cm }
record wheel.angle.z
record wheel.kinetic
record far.kinetic
record far.elastic
record wheel.distance(far)
"""


def test_angle_and_energy_of_a_wheel(tmp_path):
    """Turns add up beyond one; energies are m v^2/2 + I w^2/2 with the inertia of the shape; distances follow both."""
    run = Scene.from_text(TURNS, "turns").run(tmp_path / "r")
    records, t = run.records, run.records["time"]
    np.testing.assert_allclose(records["wheel.angle.z"], 20.0 * t, atol=1e-6)
    np.testing.assert_allclose(records["wheel.kinetic"], 0.5 * 2 * 1 + 0.5 * (0.5 * 2 * 0.1**2) * 20**2, rtol=1e-9)
    np.testing.assert_allclose(records["far.kinetic"], 2.0, rtol=1e-9)
    np.testing.assert_allclose(records["far.elastic"], 0.0, atol=1e-12)
    np.testing.assert_allclose(records["wheel.distance(far)"], np.hypot(t, 1.0 + 2.0 * t), rtol=1e-9)
    assert "wheel.angle.z [rad]" in (run.folder / "records.csv").read_text().splitlines()[0]
    assert list(records.to_pandas()) == list(records) == list(Run(run.folder).records)


HOPS = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object ball { shape sphere 5 cm  position (0, 0, 0.2) m  mass 1 kg  elasticity 1 MPa }
object other { shape sphere 5 cm  position (1, 0, 0.3) m  mass 1 kg  elasticity rigid }
control { time 0.3 s  frames 20 fps  resolution 2.5 cm }
"""
ASKED = "".join(f"record {word}\n" for word in ("ball.contact.z", "ball.spin", "ball.elastic", "other.angle.y", "other.speed"))


def test_records_change_no_bit_and_are_the_same_however_it_is_run(tmp_path):
    """With and without records, on two executors, stopped and resumed; what was stopped has those so far."""
    plain = Scene.from_text(HOPS, "hops").run(tmp_path / "plain")
    run = Scene.from_text(HOPS + ASKED, "hops").run(tmp_path / "one")
    for frame in range(len(run.trajectory)):
        np.testing.assert_array_equal(run.trajectory.position(frame), plain.trajectory.position(frame))
    assert not (plain.folder / "records.csv").exists()
    with pytest.raises(OutputError, match="the scene has no record line"):
        _ = plain.records
    two = Scene.from_text(HOPS + ASKED, "hops").run(tmp_path / "two", executors=2)
    place = tmp_path / "hops.out"
    with pytest.raises(Interrupted):
        Scene.from_text(HOPS + ASKED, "hops").run(place, on_progress=lambda p: p.frame == 3 and (place / "stop").touch())
    so_far = (place / "records.csv").read_text()
    stopped = Run(place).resume()
    texts = [(one.folder / "records.csv").read_text() for one in (run, two, stopped)]
    assert texts[0] == texts[1] == texts[2] and texts[0].startswith(so_far) and so_far.count("\n") == 5


def test_a_fault_of_records_does_not_hide_that_a_run_was_stopped(tmp_path, monkeypatch):
    def fail(*_):
        raise ValueError("zero-size array")

    monkeypatch.setattr(Records, "of", fail)
    place = tmp_path / "hops.out"
    with pytest.raises(Interrupted):
        Scene.from_text(HOPS + ASKED, "hops").run(place, on_progress=lambda p: p.frame == 1 and (place / "stop").touch())


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("record post.contact", "the force of contact on post is not known: it is held, and what holds it"),
        ("record world.contact", "the force of contact on world is not known, nor that on door: its joint pulls at it"),
        ("record door.contact.x", "the force of contact on door is not known: its joint pulls at it"),
        ("expect door.contact.z < 3 N", "the force of contact on door is not known: its joint pulls at it"),
    ],
)
def test_a_force_of_contact_that_is_not_known_is_refused(line, message):
    """Before the run, with the place of the line."""
    scene = """
ground z -1 m
object post { shape box (10, 10, 10) cm  position (0, 0, 0) m  mass 1 kg  elasticity 1 MPa  hold all }
object door { shape box (10, 2, 10) cm  position (0.2, 0, 0) m  mass 1 kg  elasticity rigid }
joint hinge door post { at (0.1, 0, 0) m  axis (0, 0, 1) }
control { time 0.1 s }
"""
    with pytest.raises(SceneError) as error:
        _ = Scene.from_text(scene + line + "\n").certificate
    (problem,) = error.value.problems
    assert problem.message.startswith(message) and problem.span.line == 7
    assert problem.hint == "take the line out: no object here has it"


VASE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object vase { shape box (10, 10, 20) cm  position (0, 0, 10) cm  density 2500  elasticity rigid  pieces 4  strength 50 MPa }
control { time 0.2 s }
"""


def test_glue_is_not_contact(tmp_path):
    """Forces of glue between pieces are not told from contact, and add nothing to the force on the world."""
    with pytest.raises(SceneError) as error:
        _ = Scene.from_text(VASE + "record vase.piece[1].contact.z\n").certificate
    (problem,) = error.value.problems
    assert problem.message.startswith("the force of contact on vase.piece[1] is not known: glue holds its pieces together")
    found = Scene.from_text(VASE + "record world.contact.z\n").run(tmp_path / "vase").records["world.contact.z"]
    weight = 2500 * 0.1 * 0.1 * 0.2 * G
    assert found[1:].mean() == pytest.approx(-weight, rel=0.02)  # it swings on the ground at about 1 mm/s, of g t = 2 m/s


def test_an_arrow_that_is_not_known_has_one_problem():
    """At its line, once for its three components."""
    text = (
        RESTING.replace("object light {", "object light { hold all ") + "render { plot ball.speed\n arrows contact of light }\n"
    )
    with pytest.raises(SceneError) as error:
        _ = Scene.from_text(text).certificate
    (problem,) = error.value.problems
    assert problem.message.startswith("the force of contact on light is not known") and problem.span.line == 12


# --- expect over many frames ------------------------------------------------------------------------------------------

BALL = "object ball { shape sphere 10 cm position (0, 0, 1) m mass 1 kg elasticity 150 kPa }\ncontrol { time 1 s }\n"


@pytest.mark.parametrize(
    ("line", "found", "met"),
    [
        ("max other.speed < 2 m/s", G * 0.3, False),
        ("min other.position.z > 0.2 m", 0.3 - G * 0.3**2 / 2, False),
        ("mean other.velocity.z from 0.05 s to 0.13 s = -0.8829 m/s +- 0.1 %", -G * 0.09, True),
        ("other.velocity.z from 0.1 s to 0.12 s < -0.9 m/s", -0.981, True),
        ("other.speed from 0.1 s to 0.12 s = 1 m/s +- 10 %", G * 0.12, False),
        ("mean other.force.z from 0.1 s to 0.2 s = -9.81 N +- 0.01 %", -G, True),
    ],
)
def test_expect_of_many_frames(free_fall, line, found, met):
    """Least, largest and mean values, and the worst one of a window, in a fall."""
    from mdanim_lammps.results.expect import evaluate

    (expect,) = parse_scene(BALL.replace("ball", "other") + f"expect {line}\n").expects
    t = free_fall.trajectory
    measured = Measured(free_fall.scene.record, t.names, None, t.times, t.centers, t.center_velocities, 0.0, None, t)
    (outcome,) = evaluate((expect,), measured)
    assert outcome.found == pytest.approx(found, rel=2e-3) and outcome.met == met
    assert f"expect {line.split(' <')[0].split(' >')[0].split(' =')[0]}" in str(outcome)


@pytest.fixture(scope="module")
def free_fall(tmp_path_factory):
    """Half of a metre of a fall, with 20 frames a second."""
    text = """
gravity (0, 0, -9.81) m/s^2
object other { shape sphere 5 cm  position (1, 0, 0.3) m  mass 1 kg  elasticity rigid }
control { time 0.3 s  frames 20 fps  resolution 5 cm }
"""
    return Scene.from_text(text, "fall").run(tmp_path_factory.mktemp("fall") / "r")


@pytest.mark.parametrize(
    ("line", "message", "hint"),
    [
        ("expect ball.speed at 0.1 s from 0 s to 1 s < 1 m/s", "an expect is at a time, or from one to another", "leave one"),
        ("expect max ball.speed at 0.1 s < 1 m/s", "max is of many moments, found one", "write from T0 to T1"),
        ("expect ball.speed from 0.5 s to 0.2 s < 1 m/s", "the window ends at 0.2 s and begins at 0.5 s", "earlier time first"),
        ("expect ball.speed from 0 s to 2 s < 1 m/s", "2 s lies outside the run, which ends at 1 s", "an earlier time"),
        (
            "expect maximum ball.speed < 1 m/s",
            "expect maximum ball: 'maximum' is none of the words",
            "write expect max ball.position.z",
        ),
        ("record ball.sped", "sped is not a quantity of ball", "did you mean 'speed'?"),
        ("record bal.speed", "no object is called bal", "did you mean 'ball'?"),
        ("record ball", "record ball names no quantity", "e.g. ball.position.z"),
        ("record ball.distance", "distance needs another object in brackets", "write distance(cube)"),
        ("record ball.speed, ball.spin", "',' cannot follow here; record is complete", "write record again for the next"),
        ("expect ball.speed = 2 m/s within 2 %", "'within' cannot follow here", "a tolerance is written as +-"),
        ("expect ball.speed max < 3 m/s", "'=' is missing in expect, found 'max'", "expect max ball.speed"),
        ("record ball.speed = 3 m/s", "'=' cannot follow here; record is complete", ""),
    ],
)
def test_what_is_asked_in_vain(line, message, hint):
    """Each with its cause and a way out."""
    with pytest.raises(SceneError) as error:
        parse_scene(f"{BALL}{line}\n")
    (problem,) = error.value.problems
    assert problem.message.startswith(message) and hint in problem.hint


def test_an_object_may_be_called_as_a_number_is_asked_for():
    """``max`` before a point is a name."""
    scene = parse_scene(BALL.replace("ball", "max") + "expect max max.speed < 1 m/s\nexpect max.speed < 1 m/s\n")
    assert [e.said for e in scene.expects] == ["max max.speed", "max.speed"]


@pytest.mark.parametrize("text", ["", "tme [s]\n1\n", "time [s],a\n1\n", "time [s],a,a\n1,2,3\n", "time [s]\nx\n"])
def test_a_damaged_table_is_refused(tmp_path, text):
    """Whatever is missing in it."""
    (tmp_path / "records.csv").write_text(text)
    with pytest.raises(OutputError, match=r"records.csv cannot be read"):
        Records.read(tmp_path / "records.csv")


def test_a_table_is_read_back_to_the_bit(tmp_path):
    """Units, empty cells and names with brackets."""
    columns = {
        "time": np.array([0.0, 0.1]),
        "a.contact(b[2])": np.array([np.nan, 1 / 3]),
        "liquid.residual": np.array([0.0, 1e-17]),
    }
    Records(columns, {"time": "s", "a.contact(b[2])": "N", "liquid.residual": ""}).write(tmp_path / "r.csv")
    again = Records.read(tmp_path / "r.csv")
    assert again.heads() == ["time [s]", "a.contact(b[2]) [N]", "liquid.residual"]
    assert all(np.array_equal(again[what], columns[what], equal_nan=True) for what in columns)
    with open(tmp_path / "r.csv", newline="") as file:
        assert next(csv.DictReader(file))["a.contact(b[2]) [N]"] == ""
    with pytest.raises(KeyError, match=r"did you mean 'liquid.residual'"):
        _ = again["liquid.residul"]
