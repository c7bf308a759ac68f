# SPDX-License-Identifier: GPL-2.0-only
"""Ropes and chains against closed forms, and their energy; tests/lab/rope_cases.py has the scenes."""

import math

import numpy as np
import pytest
import rope_cases
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.ropes.chain import places, springs
from mdanim_lammps.model.rope import section
from mdanim_lammps.scene.scene import Rope
from rope_cases import CASES, DOWN, ROLLER, made, rope

SLOW = {
    n
    for n in CASES
    if n.startswith(("capstan", "whirls")) and n not in ("capstan, chain, 180 degrees", "whirls a ball on a joint, rope")
}
SLOW |= {"sag of a rope of 2 mm, 20 MPa"}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.soak] if n in SLOW else []) for n in CASES])
def test_it_agrees_with_the_closed_form(name):
    """At the defaults of the language, but for the number of particles of the catenary."""
    case, most = CASES[name]
    found, expected = case()
    assert found == pytest.approx(expected, rel=most)


@pytest.mark.parametrize(("end", "length"), [((1.0, 0.3, 0.2), 1.5), ((0.6, 0.0, -0.5), 2.0), ((0.05, 0.0, 0.0), 1.0)])
def test_a_rope_that_hangs_through_begins_at_rest_with_its_length(end, length):
    """All links are equally long, the ends are in their places, and what pulls at each particle bears its weight."""
    shape = Rope((0.0, 0.0, 0.0), end, 0.005, length)
    x = places(shape, 60)
    assert x[0].tolist() == [0.0, 0.0, 0.0] and x[-1] == pytest.approx(end, abs=1e-12)
    link = np.diff(x, axis=0)
    np.testing.assert_allclose(np.linalg.norm(link, axis=1), length / 60, rtol=1e-9)
    slope = link[:, 2] / np.linalg.norm(link[:, :2], axis=1)
    np.testing.assert_allclose(np.diff(slope), slope[1] - slope[0], rtol=1e-5)


def test_its_springs_bear_its_section_and_its_bending():
    """E A of what crosses a section, no force where it is straight, and E I theta^2/2 h of a bend."""
    shape, young, links = Rope((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.02, 1.0), 3e6, 40
    h, area, inertia = 1.0 / links, section(shape), math.pi * 0.02**4 / 64
    pair, (k, rest, unloaded) = (found := springs(shape, young, links))[0], found[1].T

    def force(x):
        d = x[pair[:, 1]] - x[pair[:, 0]]
        r = np.linalg.norm(d, axis=1)
        pull = (k * (r - rest) / r)[:, None] * d
        total = np.zeros_like(x)
        np.add.at(total, pair[:, 0], pull)
        np.add.at(total, pair[:, 1], -pull)
        return total

    def energy(x):
        r = np.linalg.norm(x[pair[:, 1]] - x[pair[:, 0]], axis=1)
        return 0.5 * (k * (r - rest) ** 2 - k * (unloaded - rest) ** 2).sum()

    straight = places(shape, links)
    np.testing.assert_allclose(force(straight), 0.0, atol=1e-9 * young * area)
    stretched = force(1.001 * straight)
    assert stretched[0, 0] == pytest.approx(1e-3 * young * area, rel=1e-9)
    np.testing.assert_allclose(stretched[1:-1], 0.0, atol=1e-9 * young * area)
    theta = 0.01
    bent = straight.copy()
    bent[21:] = bent[20] + (straight[21:] - straight[20]) @ np.array(
        [[math.cos(theta), math.sin(theta), 0.0], [-math.sin(theta), math.cos(theta), 0.0], [0.0, 0.0, 1.0]]
    )
    assert energy(bent) == pytest.approx(0.5 * young * inertia / h * theta**2, rel=1e-3)


def test_a_chain_does_not_resist_bending():
    """It has links alone."""
    pair, _ = springs(Rope((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.02, 1.0, False), 3e6, 40)
    assert (np.diff(pair, axis=1) == 1).all() and len(pair) == 40


def test_its_mass_is_that_of_its_length():
    """However far it is stretched; half of a link's at each end."""
    system = made(rope("rope from (0, 0, 0) m to (1.2, 0, 0) m thickness 2 cm length 1 m", "elasticity 5 MPa")).system
    assert system.mass.sum() == pytest.approx(1000 * math.pi * 0.01**2, rel=1e-12)
    assert system.mass[0] == pytest.approx(system.mass[1] / 2, rel=1e-12)
    assert system.center_of_mass(system.position)[0] == pytest.approx((0.6, 0.0, 0.0), abs=1e-12)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_energy_of_a_fall_stays(friction):
    """A rope falls flat on the ground, and all of its energy goes through its contacts: 1e-3, as balanced stands for."""
    assert abs(rope_cases.fall(friction)) < 1e-3


def test_it_rests_on_a_roller_at_its_surface():
    """Its particles are half of its thickness above it, less what its weight presses it in."""
    text = DOWN + rope("rope from (-0.3, 0, 0.112) m to (0.3, 0, 0.112) m thickness 2 cm", "elasticity 2 MPa  friction 0.5")
    ready = made(text + ROLLER.format(R=0.1, young="2 MPa", mu=0.5), 0.6)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(0.6 / ready.certificate.timestep))
        x = instance.array("x")[: ready.system.first[1]].copy()
    distance = np.hypot(x[:, 0], x[:, 2]).min()
    assert 0.11 - 0.002 < distance < 0.11 + 0.002
