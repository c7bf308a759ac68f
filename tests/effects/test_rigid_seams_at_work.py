# SPDX-License-Identifier: GPL-2.0-only
"""Rigid objects roll and slide from one held slab on to the next, flush one, as over one slab."""

import sys
from collections import Counter

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.model.cover import hidden_sides
from mdanim_lammps.scene.scene import Box
from model_samples import solid

SLAB = "object {name} {{ shape box {size} cm  position {at} cm  density 1000  elasticity rigid  hold all }}\n"
BALL = """gravity (0, 0, -9.81) m/s^2
object ball {{ shape sphere 5 cm  position (-0.1, {y}, 0.05) m  density 1000  elasticity rigid
  velocity ({v}, 0, 0) m/s  spin (0, {spin}, 0) rad/s }}
control {{ time {time} s  friction 0.5 }}
"""
TWO = [((50, 40, 10), (-25, 0, -5)), ((50, 40, 10), (25, 0, -5))]
FOUR = [((50, 40, 10), (x, y, -5)) for x in (-25, 25) for y in (-20, 20)]


def text(v, slabs, y=0.0):
    """A ball that rolls to +x at v [m/s] from 10 cm before x = 0."""
    made = [SLAB.format(name=f"s{n}", size=size, at=at) for n, (size, at) in enumerate(slabs)]
    return "".join(made) + BALL.format(v=v, spin=v / 0.05, y=y, time=0.2 / v)


@pytest.mark.parametrize(
    ("v", "slabs", "y"), [(0.1, TWO, 0.0), (0.3, TWO, 0.0), (1.0, TWO, 0.0), (3.0, TWO, 0.0), (0.3, FOUR, 0.03), (1.0, FOUR, 0.0)]
)
def test_a_seam_hardly_stops_a_ball(prepared, v, slabs, y):
    """Near the seam both edges bear the ball, which rises by the depth d at which it rests: m g d of its energy 7/10 m v^2. Their
    dashpots and friction take up to 0.1 % of a speed more (measured). At points of the surfaces it lost 5 % at 1 m/s, a third at
    0.2 m/s."""
    ready = prepared(text(v, slabs, y))
    first, last = ready.system.first[-2:]
    assert np.diff(ready.system.first).tolist() == [8] * (len(slabs) + 1)
    mass = ready.system.mass[first:last]
    height, sideways = [], []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(50):
            instance.run(ready.certificate.steps // 50)
            x, speed = (mass @ instance.array(of)[first:last] / mass.sum() for of in "xv")
            height.append(x[2] - 0.05)
            sideways.append(speed[1])
    deep = 1.1e-4
    """Depth at rest, 0.1 % of the ball's size (`rest depth` of check), and a tenth."""
    assert x[0] > 0.09 and speed[0] > v - 9.81 * deep / (1.4 * v) - 1e-3 * v
    assert -deep < min(height) and max(height) < deep and np.abs(sideways).max() < 1e-3 * v


SLIDERS = {
    "cube": ("box (10, 10, 10) cm", "", 5),
    "turned cube": ("box (10, 10, 10) cm", "orientation axis (0, 0, 1) angle 20 deg", 5),
    "cylinder": ("cylinder 5 cm 10 cm", "", 5),
    "log": ("cylinder 5 cm 10 cm", "orientation axis (1, 0, 0) angle 90 deg", 5),
    "ring": ("torus 6 cm 2 cm", "", 2),
}
ONE = [((100, 40, 10), (0, 0, -5))]


def slid(prepared, name, slabs):
    """Place of the object after 0.4 s, which starts 10 cm before the seam at 1 m/s [m], and the table of shapes."""
    shape, more, z = SLIDERS[name]
    made = "".join(SLAB.format(name=f"s{n}", size=size, at=at) for n, (size, at) in enumerate(slabs))
    ready = prepared(
        f"gravity (0, 0, -9.81) m/s^2\n{made}object it {{ shape {shape}  position (-10, 1, {z}) cm {more}  density 1000\n"
        "  elasticity rigid  velocity (1, 0, 0) m/s }\ncontrol { time 0.4 s  friction 0.3 }\n".replace(" }\nc", " }\nc")
    )
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        return ready.system.center_of_mass(instance.array("x"))[-1], ready.plan.tables["shapes-rigid"]


@pytest.mark.parametrize("name", SLIDERS)
def test_it_slides_over_a_seam_as_over_one_slab(prepared, name):
    """To 0.5 mm. With the edges in the seam a cube turned back there by 15 cm, and hopped 17 mm."""
    expected, bare = slid(prepared, name, ONE)
    assert "covered" not in bare
    for slabs in (TWO, FOUR):
        found, table = slid(prepared, name, slabs)
        assert table.count("covered") == len(slabs)
        assert found == pytest.approx(expected, abs=5e-4)


STEPS = [((50, 40, 10), (-25, 0, -5)), ((50, 40, 20), (25, 0, 0))]
NARROW = [((50, 40, 10), (-25, 0, -5)), ((50, 20, 10), (25, 0, -5))]


@pytest.mark.parametrize("slabs", [STEPS, NARROW], ids=["a step", "a narrow slab"])
def test_beside_what_is_hidden_in_part_the_surfaces_touch(prepared, slabs):
    """Edges there are hidden in a part of their length: a cube touches at points, where covered sides do not act."""
    cube = "object cube { shape box (10, 10, 10) cm  position (0.2, 0, 1) m  density 1000  elasticity rigid }\n"
    ready = prepared(text(1.0, slabs) + cube)
    assert np.diff(ready.system.first)[:2].tolist() == [8, 8] and np.diff(ready.system.first)[3] == 27
    assert (
        " held " not in ready.plan.tables["shapes-rigid"] and " held " in prepared(text(1.0, slabs)).plan.tables["shapes-rigid"]
    )


def held(size, at):
    """A held cuboid."""
    return solid(Box(tuple(0.01 * s for s in size)), position=np.array([0.01 * a for a in at]))


@pytest.mark.parametrize(
    ("slabs", "expected"),
    [
        (ONE, [()]),
        (TWO, [(1,), (0,)]),
        (FOUR, [(1, 3), (1, 2), (0, 3), (0, 2)]),
        (STEPS, None),
        (NARROW, None),
        ([*TWO, ((20, 20, 20), (-25, 0, 10))], [(1,), (0,), (4,)]),  # a post that stands in the middle of one
        ([*TWO, ((20, 20, 20), (0, 0, 10))], None),  # and over the seam
        ([TWO[0], ((50, 40, 10), (25.01, 0, -5))], [(1,), (0,)]),  # 0.1 mm between them
        ([TWO[0], ((50, 40, 10), (25.05, 0, -5))], None),  # 0.5 mm: neither flush nor far
        ([TWO[0], ((50, 40, 10), (25.5, 0, -5))], [(), ()]),
    ],
)
def test_hidden_sides(slabs, expected):
    """By their numbers."""
    assert hidden_sides([held(size, at) for size, at in slabs]) == expected


def test_what_overlaps_costs_its_number():
    """Calls of functions for boxes that are all in each other are in proportion to their number, not to that of their pairs."""

    def calls(count):
        boxes = [held((4, 4, 4), (0.01 * k, 0, 0)) for k in range(count)]
        found = Counter()
        sys.setprofile(lambda frame, event, of: found.update([event]))
        try:
            hidden_sides(boxes)
        finally:
            sys.setprofile(None)
        return found["call"]

    assert calls(80) < 2.5 * calls(40)
