# SPDX-License-Identifier: GPL-2.0-only
"""Streams that fall from an inflow to the surface."""

import numpy as np
from mdanim_lammps import Scene
from mdanim_lammps.features.liquid.measure import height_at
from mdanim_lammps.features.liquid.picture import streams
from mdanim_lammps.features.liquid.stream import AROUND, RINGS, SLOWEST, half_axes

TEXT = """
gravity (0, 0, -9.81) m/s^2
liquid water {
  basin   from (-0.3, -0.3, 0) m to (0.3, 0.3, 0.6) m
  density 1000 kg/m^3
  level   0.2 m
  inflow  from (-0.15, -0.05, 0.5) m to (-0.05, 0.05, 0.5) m rate 0.001 m^3/s
  inflow  from (0.1, -0.05, 0.1) m to (0.2, 0.05, 0.1) m rate 0.001 m^3/s
}
object post { shape box (5, 5, 5) cm  position (0.25, 0.25, 0.57) m  density 2000  elasticity 1 MPa  hold all }
control { time 0.4 s  frames 10 fps  resolution 5 cm }
"""


def test_stream_falls_to_the_surface(tmp_path):
    """From the middle of the inflow, at first as far as it has fallen, with the section that its rate and speed give; one below
    the surface is not there."""
    trajectory = Scene.from_text(TEXT, "tap").run(tmp_path / "r").trajectory
    falls, below = streams(trajectory)
    rings = lambda frame: falls.points(frame)[: RINGS * AROUND].reshape(RINGS, AROUND, 3)
    surface = height_at((-0.1, 0.0), trajectory.liquid.grid, trajectory.liquid_height(4))
    np.testing.assert_allclose(rings(4)[[0, -1], 0, 2], [0.5, surface])
    np.testing.assert_allclose(rings(1)[-1, 0, 2], 0.5 - SLOWEST * 0.1 - 0.5 * 9.81 * 0.1**2)
    for ring in rings(4):
        speed = np.sqrt(SLOWEST**2 + 2 * 9.81 * (0.5 - ring[0, 2]))
        radius = np.linalg.norm(ring[:, :2] - [-0.1, 0.0], axis=1)
        np.testing.assert_allclose(np.pi * radius**2 * speed, 0.001, rtol=1e-6)
    assert np.ptp(below.points(4), axis=0).max() == 0.0
    corners = rings(4).reshape(-1, 3)
    a, b, c = falls.points(4)[falls.triangle[: 2 * AROUND * (RINGS - 1)]].transpose(1, 0, 2)
    out = np.einsum("nd,nd->n", np.cross(b - a, c - a)[:, :2], (a + b + c)[:, :2] / 3 - [-0.1, 0.0])
    assert (out > 0).all() and len(corners) == RINGS * AROUND


def test_curtain_keeps_its_width():
    """A long inflow has a stream as long as itself, which gets thinner."""
    found = half_axes(np.array([0.01, 0.002]), np.array([0.02, 0.3]))
    np.testing.assert_allclose(found[:, 1], 0.3)
    np.testing.assert_allclose(np.pi * found.prod(axis=1), [0.01, 0.002])
