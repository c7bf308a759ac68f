# SPDX-License-Identifier: GPL-2.0-only
"""Flat surfaces bear all of what is glued together that lies there, as springs that do not pull."""

import numpy as np
import pytest
import rigid_lab as lab
from glue_lab import DENSITY, EDGE, bar, world

GRAVITY = 9.81
STRESS = 23  # column of the array of the fix


def cubes(**at):
    """A bar of six cubes that comes to rest."""
    return [b.put(mu=0.5, beta=1.0) for b in bar(6, **at)]


def stresses(one, bodies):
    """The largest stress that each cube bore."""
    return np.array([one.lmp.extract_fix("r", 0, 2, n, STRESS) for n in range(len(bodies))])


def slab(x, wide):
    """Held, with its top at height 0."""
    return lab.box((wide, 1.0, 0.2), at=(x, 0.0, -0.1), mu=0.5, beta=1.0, held=True)


GROUNDS = {
    "plane": (["plane z lo 0.0"], []),
    "slab": ([], [slab(0.0, 2.0)]),
    "slabs side by side": ([], [slab(-1.0, 2.0), slab(1.0, 2.0)]),
}


@pytest.mark.parametrize("ground", GROUNDS)
def test_a_bar_that_lies_on_flat_ground_does_not_bend(tmp_path, ground):
    """Its weight is borne where it is. On its ends the stress would be 3/4 rho g L^2/h."""
    planes, beside = GROUNDS[ground]
    bodies = cubes(at=(0.0, 0.0, EDGE / 2))
    frequency = lab.frequency_of(0.1, EDGE)
    with world(
        tmp_path, bodies, 1e6, beside=beside, planes=planes, gravity=(0, 0, -GRAVITY), frequency=frequency, thin=EDGE
    ) as one:
        one.run(300)
        # Rounding decides whether edges touch that meet at their ends, and bear nothing.
        assert 4.0 <= one.number("touching") <= 8.0
        assert stresses(one, bodies).max() < 1e-3 * 0.75 * DENSITY * GRAVITY * (6 * EDGE) ** 2 / EDGE


def test_pressure_under_a_bar_is_that_of_springs(tmp_path):
    """Its last cube is pushed down: p = W/L (1 + 12 e x/L^2), and the bending of each section is what p and weights leave."""
    bodies, push, steps = cubes(at=(0.0, 0.0, EDGE / 2)), 0.5 * GRAVITY * DENSITY * EDGE**3, 600
    down = ["group end id 41:48", f"variable push equal -{push / 8!r}*step/{steps}", "fix push end addforce 0.0 0.0 v_push"]
    more = {"planes": ["plane z lo 0.0"], "gravity": (0, 0, -GRAVITY), "frequency": 2e3, "thin": EDGE, "commands": down}
    with world(tmp_path, bodies, 1e6, **more) as one:
        one.run(steps)
        found = stresses(one, bodies)
    weight = GRAVITY * DENSITY * EDGE**3 * np.array([1.0, 1.0, 1.0, 1.0, 1.0, 1.5])
    x, length = EDGE * (np.arange(6) - 2.5), 6 * EDGE
    e = weight @ x / weight.sum()
    bend = []
    for section in x[:-1] + EDGE / 2:
        u = np.linspace(-length / 2, section, 2001)
        p = weight.sum() / length * (1 + 12 * e * u / length**2)
        left = x < section
        bend.append(np.trapezoid(p * (section - u), u) - weight[left] @ (section - x[left]))
    expected = np.abs(bend) / (EDGE**3 / 6)
    assert found.max() == pytest.approx(expected.max(), rel=0.03)


def test_what_stands_on_an_edge_bears_on_all_of_it(tmp_path):
    """A bar that is turned by 45 degrees about its length lies on one edge, as the beam on flat ground does."""
    bodies = cubes(at=(0.0, 0.0, EDGE / 2**0.5), q=lab.about((1, 0, 0), np.pi / 4))
    with world(tmp_path, bodies, 1e6, planes=["plane z lo 0.0"], gravity=(0, 0, -GRAVITY), frequency=2e3, thin=EDGE) as one:
        one.run(200)
        assert one.number("touching") == 2.0
        assert stresses(one, bodies).max() < 0.02 * 0.75 * DENSITY * GRAVITY * (6 * EDGE) ** 2 / EDGE


def test_many_pieces_bear_what_few_do(tmp_path):
    """A bar of 240 cubes that spins: rho w^2 L^2/8 in its middle, where groups of pieces take part in finding it."""
    pieces, spin = 240, 2.0
    bodies = bar(pieces, spin=(0, 0, spin))
    tension = DENSITY * spin**2 * (pieces * EDGE) ** 2 / 8
    with world(tmp_path, bodies, 2 * tension, frequency=2e3) as one:
        one.run(1)
        assert stresses(one, bodies).max() == pytest.approx(tension, rel=1e-3)
