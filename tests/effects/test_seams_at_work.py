# SPDX-License-Identifier: GPL-2.0-only
"""A box without friction slides from one held slab on to the next, flush one, as over one slab; what stands out is a wall."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance

BOX = """gravity (0, 0, -9.81) m/s^2
object box {{ shape box (20, 20, 20) cm  position (-0.2, {y}, 0.1) m  velocity ({v}, 0, 0) m/s
  density 500  elasticity 2 MPa  damping 0.3 }}
control {{ time {time} s  frames 30 fps  resolution {h} cm }}
"""
SLAB = "object {name} {{ shape box {size} cm  position {at} cm  density 1000  elasticity 2 MPa  hold all }}\n"
EVEN = [("left", (100, 100, 10), (-50, 0, -5)), ("right", (100, 100, 10), (50, 0, -5))]


def text(v, h, slabs, y=-0.25, time=1):
    """A box that goes to +x at v [m/s] from 10 cm before x = 0; cells of h [cm]."""
    return "".join(SLAB.format(name=n, size=size, at=at) for n, size, at in slabs) + BOX.format(v=v, h=h, y=y, time=time)


def speed_after(ready, way):
    """Speed over that at the start [-] after so much time as the box had needed for a way [m]."""
    instance = Instance(ready.plan)
    instance.setup()
    mass = np.where(ready.system.held, 0.0, ready.system.mass)
    momentum = float(mass @ instance.array("v")[:, 0])
    instance.run(round(way / (momentum / mass.sum()) / ready.certificate.timestep))
    return float(mass @ instance.array("v")[:, 0]) / momentum


@pytest.mark.parametrize(
    ("v", "h"), [(0.1, 5), pytest.param(0.1, 4, marks=pytest.mark.soak), (0.3, 5), (0.3, 4), (1.0, 5), (1.0, 4)]
)
def test_a_seam_of_two_slabs_takes_no_speed(prepared, v, h):
    """Within 0.5 %. The lower edge, sunk in by 0.01 h, met the hidden side: the box turned back at 0.1 m/s, lost 11 % of 0.3."""
    assert speed_after(prepared(text(v, h, EVEN)), 0.4) == pytest.approx(1.0, abs=5e-3)


UNEVEN = {
    "on to a wider one": ([("left", (100, 80, 10), (-50, 0, -5)), ("right", (100, 150, 20), (50, 0, -10))], -0.25),
    "on to a narrower one": ([("left", (100, 150, 10), (-50, 0, -5)), ("right", (100, 80, 10), (50, 0, -5))], -0.25),
    "four tiles": ([(f"t{x}{y}", (100, 80, 10), (100 * x - 50, 80 * y - 40, -5)) for x in (0, 1) for y in (0, 1)], 0.02),
}


@pytest.mark.parametrize("name", UNEVEN)
def test_a_seam_of_uneven_slabs_takes_no_speed(prepared, name):
    """Sides that are covered in part."""
    slabs, y = UNEVEN[name]
    assert speed_after(prepared(text(0.3, 5, slabs, y)), 0.4) == pytest.approx(1.0, abs=5e-3)


@pytest.mark.parametrize("up", [1, 2.5, 10])
def test_a_wall_that_stands_out_of_its_neighbour_turns_the_box_back(prepared, up):
    """By a fifth of a cell, half a cell, two cells."""
    wall = ("wall", (20, 100, 10 + up), (10, 0, up / 2 - 5))
    assert -1.0 < speed_after(prepared(text(0.1, 5, [EVEN[0], wall])), 0.3) < -0.5


def test_a_wall_on_a_slab_turns_the_box_back(prepared):
    """It covers a part of the slab's upper side alone."""
    wall = ("wall", (20, 100, 20), (10, 0, 10))
    floor = ("floor", (200, 100, 10), (0, 0, -5))
    assert -1.0 < speed_after(prepared(text(0.1, 5, [floor, wall])), 0.3) < -0.5
