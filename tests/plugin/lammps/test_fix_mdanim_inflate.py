# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/inflate: forces are the gradient of its energy, which has a closed form; ranks; what is refused."""

import numpy as np
import plugin_lab as lab
import pytest
from bag_lab import FACES, cube

P, V, OUTSIDE = 3.0, 0.8, 2.0


def volume_in(x, triangle):
    """Volume that triangles of points enclose."""
    a, b, c = (x[triangle[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def bags(tmp_path, text: str = "", faces=FACES, head: str = f"object 1 {P} {V} {OUTSIDE}", group: str = "all") -> list[str]:
    triangles = "".join(f"triangle {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    (tmp_path / "bags").write_text(text or f"{head}\n{triangles}")
    return [f"fix gas {group} mdanim/inflate bags {tmp_path}/bags"]


def found(tmp_path, body, commands, more=()):
    """Forces, the energy, volume and pressure."""
    lmp = lab.load(body, tmp_path, [*commands, *more, "run 0"])
    f, energy = lab.by_tag(lmp, "f"), lmp.extract_fix("gas", 0, 0)
    row = [lmp.extract_fix("gas", 0, 2, 0, n) for n in range(2)]
    lmp.close()
    return f, energy, row


@pytest.mark.parametrize("outside", [0.0, 2.0, 50.0])
def test_forces_are_the_gradient_of_the_energy(tmp_path, outside):
    """Pressure by the law of an ideal gas; forces by differences of the energy; they have no sum and no torque."""
    body = cube()
    script = bags(tmp_path, head=f"object 1 {P} {V} {outside}")
    f, energy, (volume, pressure) = found(tmp_path, body, script)
    assert volume == pytest.approx(volume_in(body.x, np.array(FACES)), rel=1e-12)
    assert (pressure + outside) * volume == pytest.approx((P + outside) * V, rel=1e-12)
    amount = (P + outside) * V
    rest = amount / outside if outside else V
    assert energy == pytest.approx(outside * (volume - rest) - amount * np.log(volume / rest) if outside else
                                   -amount * np.log(volume / V), rel=1e-9)  # fmt: skip
    for i, axis in ((0, 0), (3, 1), (6, 2), (7, 0)):
        ends = []
        for way in (1e-5, -1e-5):
            x = body.x.copy()
            x[i, axis] += way
            ends.append(found(tmp_path, lab.particles(x, molecule=np.ones(8, int)), script)[1])
        assert f[i, axis] == pytest.approx(-(ends[0] - ends[1]) / 2e-5, rel=1e-6, abs=1e-6)
    np.testing.assert_allclose(f.sum(axis=0), 0.0, atol=1e-14 * np.abs(f).max() * 8)
    np.testing.assert_allclose(np.cross(body.x, f).sum(axis=0), 0.0, atol=1e-13)


def test_energy_is_kept(tmp_path):
    """A bag without anything else breathes: kinetic energy and that of the gas."""
    body = cube(0.1)
    script = [*bags(tmp_path), "fix run all mdanim/leapfrog", "timestep 0.002", "compute ke all ke"]
    lmp = lab.load(body, tmp_path, [*script, "run 0"])
    energy = lambda: lmp.extract_compute("ke", 0, 0) + lmp.extract_fix("gas", 0, 0)
    before = energy()
    drift = []
    for _ in range(20):
        lmp.command("run 25")
        drift.append(energy() - before)
    lmp.close()
    assert np.abs(drift).max() < 1e-4 * P * V


def test_particles_of_the_group_alone_are_pushed(tmp_path):
    """An object of which no particle is in it has no energy."""
    body = cube()
    f, energy, _ = found(tmp_path, body, ["group some id 1 2", *bags(tmp_path, group="some")])
    assert np.abs(f[:2]).min() > 0.0 and not f[2:].any()
    f, energy, _ = found(tmp_path, body, ["group none empty", *bags(tmp_path, group="none")])
    assert not f.any() and energy == 0.0


def test_objects_share_triangles(tmp_path):
    """One with the surface of another one has its own pressure."""
    two = lab.particles(np.concatenate([cube().x, cube().x + 5.0]), molecule=np.repeat([1, 2], 8))
    triangles = "".join(f"triangle {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    script = bags(tmp_path, f"object 1 {P} {V} {OUTSIDE}\n{triangles}object 2 {2 * P} {V} {2 * OUTSIDE} like 1\n")
    f, _, _ = found(tmp_path, two, script)
    np.testing.assert_allclose(f[8:], 2.0 * f[:8], rtol=1e-9, atol=1e-12)


CLOSED = "triangle 1 2 3\ntriangle 1 3 2\n"
WRONG = {
    "no word": ("", "fix gas all mdanim/inflate", "write fix ID group mdanim/inflate bags FILE"),
    "empty": ("# nothing\n", "", "there is no object in"),
    "no triangle": ("object 1 1 1 1\n", "", "object 1 has no triangle"),
    "open": ("object 1 1 1 1\ntriangle 1 2 3\n", "", "is open at the edge from particle 1 to particle 2"),
    "twice": (f"object 1 1 1 1\n{CLOSED}object 1 1 1 1\n", "", "object 1 is there already"),
    "like none": ("object 1 1 1 1 like 2\n", "", "stands before it"),
    "no gas": ("object 1 -1 1 1\n", "", "there is no gas"),
    "volume": ("object 1 1 0 1\n", "", "the volume must be above 0"),
    "word": ("object 1 1 1 1 as 2\n", "", "comes like N or nothing, got as"),
    "part": ("object 1 1 1 1\nedge 1 2\n", "", "begins with object or triangle, got edge"),
    "particle": ("object 1 1 1 1\ntriangle 0 1 2\n", "", "count from 1, got 0"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_refused(tmp_path, name):
    text, command, message = WRONG[name]
    script = bags(tmp_path, text or "#\n")
    with pytest.raises(Exception, match=message):
        lab.load(cube(), tmp_path, [command] if command else script)


def test_particles_that_are_not_there(tmp_path):
    """The message counts them as the file does."""
    faces = [tuple(9 if i == 7 else i for i in face) for face in FACES]
    with pytest.raises(Exception, match=r"object 1 \(molecule ID\) has no particle 10, counted from its lowest tag, 1"):
        found(tmp_path, cube(), bags(tmp_path, faces=faces))
    with pytest.raises(Exception, match="there is no object 3"):
        found(tmp_path, cube(), bags(tmp_path, head=f"object 3 {P} {V} {OUTSIDE}"))


def test_a_bag_that_is_pressed_to_nothing(tmp_path):
    """An end with a message, not a pressure of any size."""
    flat = lab.particles(cube().x * [1.0, 1.0, -1.0], molecule=np.ones(8, int))
    with pytest.raises(Exception, match="gas needs room"):
        found(tmp_path, flat, bags(tmp_path))
