# SPDX-License-Identifier: GPL-2.0-only
"""Sheets in runs: against closed forms, their energy, and what they lie on; tests/lab/sheet_cases.py has the scenes."""

import numpy as np
import pytest
import sheet_cases
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from rope_cases import DOWN, made

SHORT = ("stretch by its weight, hangs from +y", "cloth over a held table")


def check(name: str) -> None:
    case, most = sheet_cases.CASES[name]
    found, expected = case()
    assert found == pytest.approx(expected, rel=most, abs=0.0 if expected else most)


def before_and_after(ready, time: float) -> tuple[dict[str, float], dict[str, float], np.ndarray]:
    """Energies at the start and after a time [s], and positions then."""
    with Instance(ready.plan) as instance:
        instance.setup()
        begin = energies(instance, ready.system.center_of_mass(instance.array("x")))
        instance.run(round(time / ready.certificate.timestep))
        x = instance.array("x").copy()
        return begin, energies(instance, ready.system.center_of_mass(x)), x


@pytest.mark.parametrize("name", SHORT)
def test_closed_forms(name):
    """One way each."""
    check(name)


@pytest.mark.soak
@pytest.mark.parametrize("name", [name for name in sheet_cases.CASES if name not in SHORT])
def test_all_closed_forms(name):
    """All, as bench/sheets.py prints them."""
    check(name)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_fall_keeps_energy(friction):
    """Flat on the ground from 0.5 m: a thousandth."""
    assert abs(sheet_cases.fall(friction)) < 1e-3


def test_a_sheet_that_flies_keeps_momentum_and_energy():
    """Bent, spun and loose: its centre of mass goes straight on."""
    text = sheet_cases.sheet("(0.4, 0.3)", "2 mm", "elasticity 500 kPa  velocity (1, 0, 0) m/s  spin (0, 3, 9) rad/s")
    ready = made(text, 0.3)
    begin, end, x = before_and_after(ready, 0.3)
    centre = ready.system.center_of_mass(x)[0]
    assert centre == pytest.approx((0.3, 0.0, 0.0), abs=1e-4)
    assert sum(end.values()) == pytest.approx(sum(begin.values()), rel=1e-5)


CLOTH = sheet_cases.sheet("(1, 1)", "1 mm", "elasticity 10 MPa  hold faces x  hold faces y")
COMES = {
    "a heavy ball": "shape sphere 6 cm  position (0.01, 0, 0.065) m  mass 10 kg  velocity (0, 0, -5) m/s",
    "a marble between particles": "shape sphere 1.5 cm  position (0, 0.016, 0.02) m  mass 100 g  velocity (0, 0, -4) m/s",
    "a box": "shape box (12, 12, 12) cm  position (0, 0.02, 0.065) m  mass 10 kg  velocity (0, 0, -5) m/s",
}


@pytest.mark.parametrize("what", COMES)
def test_a_held_sheet_bears_what_comes(what):
    """By the hardness and the points that it chooses; all three passed by those of its material. No energy comes or goes."""
    text = f"{CLOTH}object thing {{ {COMES[what]}  elasticity rigid }}\n"
    ready = prepare(parse_scene(f"{text}control {{ time 0.1 s  accuracy preview }}\n"))
    begin, end, x = before_and_after(ready, 0.04)
    cloth, thing = x[: ready.system.first[1]], x[ready.system.first[1] :]
    assert cloth[:, 2].min() < thing[:, 2].min() + 0.01
    assert sum(end.values()) == pytest.approx(sum(begin.values()), abs=1e-3 * begin["kinetic"])


def test_a_sheet_over_a_rod_thinner_than_its_spacing_hangs_on_it_and_keeps_energy():
    """Particles 4 cm apart have a radius of 3.3 mm, three cells of the rod: they touched it from any distance, and the sheet
    gained 2e-3. Points between them hold it where no particle comes onto the rod."""
    sheet = "resolution 4 cm  elasticity 1 MPa  position (0, 0.017, 0.03) m"
    rod = "shape cylinder 5 mm 30 cm  position (0, 0, 0) m  orientation axis (0, 1, 0) angle 90 deg  elasticity rigid  hold all"
    ready = made(f"{DOWN}object rod {{ {rod}  mass 1 kg }}\n" + sheet_cases.sheet("(0.3, 0.3)", "1 mm", sheet), 0.2)
    begin, end, x = before_and_after(ready, 0.2)
    assert x[ready.system.object == 1, 2].max() > 0.0
    assert sum(end.values()) == pytest.approx(sum(begin.values()), abs=1e-4 * end["kinetic"])


MAT = """object mat {
  shape sheet (0.4, 0.4) m thickness 1 mm  resolution 3 cm  position (0, 0, 0) m  density 300  elasticity 1 MPa  damping 0.1
  hold faces x  tear-strain 0.1
}
object ball { shape sphere 1.2 cm  position (0.01, 0.013, 0.017) m  density 7800  elasticity rigid  velocity (0, 0, -5) m/s }
control { time 0.3 s  accuracy preview }
"""


def test_a_sheet_that_tears_is_torn_by_what_comes():
    """A marble narrower than the spacing came through between particles, and no link was gone; its points hold it until they are
    torn."""
    ready = prepare(parse_scene(MAT))
    ball = slice(int(ready.system.first[1]), None)
    torn, below = [], []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(20):
            instance.run(round(0.001 / ready.certificate.timestep))
            x = instance.array("x")
            torn.append((instance.column("torn") > 0).sum())
            below.append(x[ball, 2].mean() < np.percentile(x[: ball.start, 2], 1) - 0.01)
    assert below[-1] and torn[below.index(True)] > 0


def test_points_between_particles_go_with_their_links():
    """A marble flies through a gap that a tear has opened, as if nothing were there."""
    ready = prepare(parse_scene(MAT))
    system, (i, j) = ready.system, ready.system.spring.T
    left = system.position[:, 0] < 0.013
    ready.plan.columns["torn"][(left[i] != left[j])] = 1
    ball = slice(int(system.first[1]), None)
    with Instance(ready.plan) as instance:
        instance.array("x")[~left & (system.object == 0), 0] += 0.08
        instance.array("x")[ball, 0] += 0.04
        instance.setup()
        instance.run(round(0.01 / ready.certificate.timestep))
        x, v = instance.array("x")[ball], instance.array("v")[ball]
    assert x[:, 2].max() < -0.02
    np.testing.assert_allclose(v, np.tile([0.0, 0.0, -5.0], (8, 1)), atol=1e-9)


def test_a_tied_sheet_lies_on_a_rod_thinner_than_its_spacing():
    """It fell through: only loose sheets had points between particles for what stays where it is."""
    sheet = "resolution 4 cm  elasticity 1 MPa  position (0, 0.017, 0.03) m  hold face -x"
    rod = (
        "shape cylinder 5 mm 30 cm  position (0.05, 0, 0) m  orientation axis (1, 0, 0) angle 90 deg  elasticity rigid  hold all"
    )
    ready = made(f"{DOWN}object rod {{ {rod}  mass 1 kg }}\n" + sheet_cases.sheet("(0.3, 0.3)", "1 mm", sheet), 0.2)
    _, _, x = before_and_after(ready, 0.2)
    over = (ready.system.object == 1) & (abs(ready.system.position[:, 0] - 0.05) < 0.03)
    assert x[over, 2].max() > -0.01


@pytest.mark.parametrize("joint", ["ball", "weld"])
def test_a_weight_hangs_from_a_corner(joint):
    """A joint at a corner holds a box there."""
    more = "position (0, 0, 1) m  elasticity 100 kPa  damping 0.2  hold face -x  resolution 5 cm"
    text = DOWN + sheet_cases.sheet("(0.4, 0.3)", "5 mm", more)
    text += "object box { shape box (10, 10, 10) cm  position (0.2, 0.15, 0.92) m  mass 100 g  elasticity rigid }\n"
    ready = made(f"{text}joint {joint} cloth box {{ at (0.2, 0.15, 1) m }}\n", 0.1)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(0.1 / ready.certificate.timestep))
        x = instance.array("x").copy()
    middle = x[ready.system.first[1] :].mean(axis=0)
    corner = x[ready.models[0].frame.woven.sides["+x"][-1]]
    assert np.linalg.norm(corner - middle) == pytest.approx(0.08, rel=0.02)
    assert 0.02 < 0.92 - middle[2] < 0.06
