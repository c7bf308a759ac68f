# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/air: forces against numpy, its work, large steps, ranks, and what is refused."""

import numpy as np
import plugin_lab as lab
import pytest
from bag_lab import FACES, cube
from twin.air import Skin

RHO, C, DT = 0.3, 1.2, 0.05
WIND = (0.7, -0.4, 0.2)
CUBE = [[(i, 1.0)] for i in range(8)]
MIDDLE = [(i, 0.125) for i in range(8)]
SKINS = {
    "triangles, outer": Skin(CUBE, FACES),
    "triangles, both": Skin(CUBE, FACES, both=True),
    "weights": Skin([[(0, 0.5), (3, 0.5)], [(1, 1.0)], [(5, 1.2), (6, -0.2)], MIDDLE], [(0, 1, 2), (1, 2, 3)], both=True),
    "cylinders": Skin(CUBE, cylinders=[(0, 1, 0.1), (1, 3, 0.2), (3, 6, 0.1)]),
    "torn cylinders": Skin(CUBE, cylinders=[(0, 1, 0.1, 2.0), (1, 3, 0.2, 0.5), (3, 6, 0.1)]),
    "ball": Skin([MIDDLE], balls=[(0, 0.8)]),
    "panels": Skin([*CUBE, MIDDLE], frame=(0, 1, 2, 4), panels=[(8, (0, 0, -1)), (7, (0.3, 0.1, 0.2)), (3, (1, 0, 0))]),
}  # fmt: skip


def air(tmp_path, skin: Skin | str, more: str = "", group: str = "all") -> list[str]:
    (tmp_path / "skins").write_text(skin if isinstance(skin, str) else skin.text(1))
    wind = " ".join(map(str, WIND))
    return [f"fix air {group} mdanim/air {RHO} {C} wind {wind} {more} skins {tmp_path}/skins", f"timestep {DT}"]


@pytest.mark.parametrize("speed", [0.1, 1.0, 30.0, 1e4])
@pytest.mark.parametrize("name", SKINS)
def test_forces(tmp_path, name, speed):
    """They are those of the twin, also where a step would take more than a quarter of the motion."""
    body, skin = cube(speed), SKINS[name]
    lmp = lab.load(body, tmp_path, [*air(tmp_path, skin), "run 0"])
    found = lab.by_tag(lmp, "f")
    lmp.close()
    expected = skin.forces(body.x, body.v, body.mass, RHO, C, WIND, DT)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    assert np.abs(found).max() > 0.0


def test_only_above_a_height(tmp_path):
    """Elements below feel nothing."""
    body, skin = cube(), SKINS["triangles, outer"]
    lmp = lab.load(body, tmp_path, [*air(tmp_path, skin, "above 0.6"), "run 0"])
    found = lab.by_tag(lmp, "f")
    lmp.close()
    expected = skin.forces(body.x, body.v, body.mass, RHO, C, WIND, DT, above=0.6)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)
    assert not np.allclose(expected, skin.forces(body.x, body.v, body.mass, RHO, C, WIND, DT))


def test_a_wind_that_changes(tmp_path):
    """Straight from point to point, by the number of the step."""
    body, skin = cube(), SKINS["triangles, both"]
    (tmp_path / "skins").write_text(skin.text(1))
    path = "path 0.1 1 0 0 0.3 0 0 3"
    fix = f"fix air all mdanim/air {RHO} {C} {path} skins {tmp_path}/skins"
    lmp = lab.load(body, tmp_path, ["reset_timestep 4", f"timestep {DT}", fix, "run 0"])
    found = lab.by_tag(lmp, "f")
    lmp.close()
    expected = skin.forces(body.x, body.v, body.mass, RHO, C, (0.5, 0.0, 1.5), DT)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", [name for name in SKINS if "torn" not in name])
def test_the_books_close(tmp_path, name):
    """The wind brings in as much as the air takes and particles get, to the second order of the step."""
    body, skin, off = cube(), SKINS[name], []
    for refined in (1, 2):
        commands = [*air(tmp_path, skin), "fix run all mdanim/leapfrog", f"timestep {DT / 50 / refined}", f"run {400 * refined}"]
        lmp = lab.load(body, tmp_path, commands)
        work, taken = lmp.extract_fix("air", 0, 1, 0), lmp.extract_fix("air", 0, 1, 1)
        gained = 0.5 * (body.mass[:, None] * (lab.by_tag(lmp, "v") ** 2 - body.v**2)).sum()
        lmp.close()
        assert taken > 0.01
        off.append(abs(work - taken - gained) / taken)
    assert off[0] < 1e-3 and off[1] < 0.6 * off[0]


@pytest.mark.parametrize("name", ["triangles, both", "panels", "ball", "cylinders"])
def test_a_light_object_in_a_storm_does_not_overshoot(tmp_path, name):
    """A step takes a part of the motion relative to the air at most, however light the object is: it comes to the speed of the
    wind and never gains energy against it."""
    body, skin = cube(speed=0.0), SKINS[name]
    light = lab.particles(body.x, molecule=body.molecule, mass=np.full(8, 1e-6))
    lmp = lab.load(light, tmp_path, [*air(tmp_path, skin), "fix run all mdanim/leapfrog"])
    before = np.sum(np.square(WIND)) * 8
    for step in range(20):
        lmp.command("run 1" if step == 0 else "run 1 pre no post no")
        now = ((lab.by_tag(lmp, "v") - WIND) ** 2).sum()
        assert now <= before * (1.0 + 1e-12)
        before = now
    lmp.close()
    assert before < np.sum(np.square(WIND)) * 8


def test_objects_that_are_alike_and_a_group(tmp_path):
    """Each feels the air by its own motion; particles out of the group are not pushed, and do no work."""
    first, second = cube(seed=1), cube(seed=2)
    two = lab.join(first, lab.particles(second.x + [5.0, 0, 0], molecule=np.full(8, 1), v=second.v, mass=second.mass))
    two = lab.particles(two.x, molecule=np.repeat([1, 2], 8), v=two.v, mass=two.mass)
    skin = SKINS["triangles, outer"]
    lmp = lab.load(
        two, tmp_path, ["group some id 1:12", *air(tmp_path, skin.text(1) + "object 2 like 1\n", group="some"), "run 0"]
    )
    found = lab.by_tag(lmp, "f")
    told = [[lmp.extract_fix("air", 0, 2, n, k) for k in range(3)] for n in range(2)]
    lmp.close()
    for n, body in enumerate((first, second)):
        expected = skin.forces(body.x, body.v, body.mass, RHO, C, WIND, DT)
        np.testing.assert_allclose(
            found[8 * n : 8 * n + 8], expected * ([[1.0]] * 8 if n == 0 else [[1.0]] * 4 + [[0.0]] * 4), atol=1e-13
        )
        np.testing.assert_allclose(told[n], expected.sum(axis=0), atol=1e-13)


def test_same_bits_on_any_number_of_ranks(tmp_path):
    """Particles wander from rank to rank."""
    body = cube()
    commands = [*air(tmp_path, SKINS["weights"]), "fix run all mdanim/leapfrog", "run 40"]
    one, three = (lab.in_child(body, tmp_path, commands, ranks=ranks) for ranks in (1, 3))
    assert one == three


@pytest.mark.parametrize(("text", "told"), [
    ("", "there is no surface to push at"),
    ("point 1 1", "point belongs behind a line object MOLECULE outer"), ("object 1 inner", "got inner"),
    ("object 1 like 2", "an object is like one of those before it"), ("object 0 outer", "0 is not a molecule ID"),
    ("object 1 outer\npoint", "a point has particles and weights"), ("object 1 outer\npoint 0 1", "count from 1, got 0"),
    ("object 1 outer\npoint 1 1\ntriangle 1 1 2", "there is no point 2; its object has 1 so far"),
    ("object 1 outer\npoint 1 1", "object 1 has no surface"),
    ("object 1 outer\npoint 1 1\nball 1 0", "diameter of a ball must be above 0"),
    ("object 1 outer\npoint 1 1\npanel 1 0 0 1", "a panel belongs behind the frame"), ("object 1 outer\nsail 1", "got sail"),
    ("object 1 outer\npoint 1 1\nball 1 1\nobject 1 outer", "object 1 is there already"),
    ("object 7 outer\npoint 1 1\nball 1 1", r"there is no object 7 \(molecule ID\)"),
    ("object 1 outer\npoint 9 1\nball 1 1", r"object 1 \(molecule ID\) has no particle 9"),
])  # fmt: skip
def test_files(tmp_path, text, told):
    """Lines that are missing, unknown, or of what is not there."""
    with pytest.raises(Exception, match=told):
        lab.load(cube(), tmp_path, [*air(tmp_path, text), "run 0"])


@pytest.mark.parametrize(("words", "told"), [
    ("", "missing"), ("0 1.2 skins f", "DENSITY must be"), ("1 -1 skins f", "C must be"), ("1 1 wind 1 2", "missing"),
    ("1 1 path skins f", "a path has a point"), ("1 1 path 0 1 0 0 0 1 0 0 skins f", "times of a path ascend, got 0 behind 0"),
    ("1 1 path 0 1 0 skins f", "each point of a path is T wx wy wz"), ("1 1 gust 2", "gust"), ("1 1", "write skins FILE"),
])  # fmt: skip
def test_words(tmp_path, words, told):
    """Words that are missing, unknown, or out of range."""
    with pytest.raises(Exception, match=told):
        lab.load(cube(), tmp_path, [f"fix air all mdanim/air {words}", "run 0"])


def test_a_restart_file_has_the_last_forces(tmp_path):
    """They act half a step longer: places, velocities and books go on as if nothing had been."""
    body = cube(1.0)
    script = [*air(tmp_path, SKINS["triangles, outer"]), "fix run all mdanim/leapfrog"]
    lmp = lab.load(body, tmp_path, [*script, "run 20", f"write_restart {tmp_path}/half"])
    half = books(lmp)
    lmp.command("run 20 pre no")
    whole, x = books(lmp), lab.by_tag(lmp, "x").copy()
    lmp.close()
    again = lab.restarted(tmp_path / "half", body, [*script, "run 20"])
    np.testing.assert_array_equal(lab.by_tag(again, "x"), x)
    np.testing.assert_allclose(half + books(again), whole, rtol=1e-13)
    again.close()


def books(lmp) -> np.ndarray:
    """Work of the wind, and what the air has taken."""
    return np.array([lmp.extract_fix("air", 0, 1, n) for n in range(2)])
