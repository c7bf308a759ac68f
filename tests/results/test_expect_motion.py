# SPDX-License-Identifier: GPL-2.0-only
"""Expect lines on how objects move, and on the height of a liquid at a place, against motions made by hand."""

from __future__ import annotations

from types import MappingProxyType, SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps.effects.measured import Glance, Measured
from mdanim_lammps.features.liquid.measure import height_at
from mdanim_lammps.features.motion.measure import MEASURES
from mdanim_lammps.model.grid import Grid
from mdanim_lammps.results.expect import evaluate
from mdanim_lammps.scene.scene import Expect

TIMES = np.array([0.0, 0.5, 1.0])


def found(quantity, time, argument=None):
    """Value of a line for `a`, thrown from (1, 2, 3) with (3, 0, 4) under gravity; `b[1]` flies from 0 with (0, 2, 0)."""
    t = TIMES[:, None]
    velocity = np.stack([[3.0, 0.0, 4.0] - t * [0.0, 0.0, 9.81], np.tile([0.0, 2.0, 0.0], (3, 1))], axis=1)
    place = np.stack([[1.0, 2.0, 3.0] + t * [3.0, 0.0, 4.0] - 0.5 * t**2 * [0.0, 0.0, 9.81], t * [0.0, 2.0, 0.0]], axis=1)
    run = Measured(None, ("a", "b[1]"), None, TIMES, place, velocity, 0.0, None, None)
    return evaluate((Expect("a", quantity, 0.0, time=time, argument=argument),), run)[0].found


@pytest.mark.parametrize("time", [0.0, 0.3, 0.5, 0.85, 1.0])
def test_speed_and_distance_of_a_throw(time):
    """A parabola between frames, too: the cubic through both ends is exact for it."""
    assert found("speed", time) == pytest.approx(np.hypot(3.0, 4.0 - 9.81 * time), rel=1e-12)
    way = np.array([1.0 + 3.0 * time, 2.0 - 2.0 * time, 3.0 + 4.0 * time - 4.905 * time**2])
    assert found("distance", time, "b[1]") == pytest.approx(np.linalg.norm(way), rel=1e-12)
    assert found("position.z", time) == pytest.approx(way[2], rel=1e-12)


@pytest.mark.parametrize("sizes", [(1.0, 1.0, 1.0), (3.0, 0.5, 0.2)], ids=["cube", "plank"])
def test_spin_of_a_rigid_motion(sizes):
    """Particles that go round an axis have the spin of that axis, whatever their shape, their flight and what else there is."""
    rng, omega = np.random.default_rng(5), np.array([0.3, -1.2, 2.0])
    x = np.array([4.0, -1.0, 2.0]) + rng.uniform(-1.0, 1.0, (60, 3)) * sizes
    mass = rng.uniform(0.1, 2.0, 60)
    v = np.array([5.0, 6.0, 7.0]) + np.cross(omega, x)
    everything = lambda own, other: np.concatenate([np.full_like(own[:7], other), own])
    system = SimpleNamespace(first=np.array([0, 7, 67]), mass=everything(mass, 3.0))
    glance = Glance(SimpleNamespace(system=system), 1, None, everything(x, 1.0), everything(v, np.nan), MappingProxyType({}))
    assert MEASURES["NAME", "spin"].look(glance) == pytest.approx(np.linalg.norm(omega), rel=1e-9)
    assert [MEASURES["NAME", f"spin.{axis}"].look(glance) for axis in "xyz"] == pytest.approx(omega, rel=1e-9)


@pytest.mark.parametrize("shape", [(20, 40, 30), (7, 3, 5), (1, 1, 1)])
def test_height_at_a_place(shape):
    """Exact on a slope between the middles of columns; at the edge that of the outermost middle."""
    grid = Grid((-1.0, -2.0, 0.0), (1.0, 2.0, 3.0), shape)
    x, y = (low + (np.arange(n) + 0.5) * (-2 * low / n) for low, n in zip((-1.0, -2.0), shape))
    heights = (1.0 + 0.5 * x[None, :] - 0.25 * y[:, None]).astype(np.float32)
    for place in ((0.13, -0.4), (-0.7, 1.1), (x[0], y[-1]), (-1.0, 2.0), (1.0, -2.0)):
        a, b = np.clip(place[0], x[0], x[-1]), np.clip(place[1], y[0], y[-1])
        assert height_at(place, grid, heights) == pytest.approx(1.0 + 0.5 * a - 0.25 * b, abs=3e-7)  # float32
