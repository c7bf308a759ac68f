# SPDX-License-Identifier: GPL-2.0-only
"""A rigid ball rolls from one held slab on to the next, flush one, as over one slab."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance

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


def test_of_what_catches_at_a_seam_the_surfaces_touch(prepared):
    """Edges of a cuboid would meet the hidden sides: it touches at points, where covered sides do not act."""
    cube = "object cube { shape box (10, 10, 10) cm  position (0.2, 0, 1) m  density 1000  elasticity rigid }\n"
    ready = prepared(text(1.0, TWO) + cube)
    assert np.diff(ready.system.first)[:2].tolist() == [8, 8] and np.diff(ready.system.first)[3] == 27
    assert " held " not in ready.plan.tables["shapes-rigid"] and " held " in prepared(text(1.0, TWO)).plan.tables["shapes-rigid"]
