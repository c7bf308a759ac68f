# SPDX-License-Identifier: GPL-2.0-only
"""Free flight of an elastic body: exact parabola, the leap-frog's own spin, momentum and angular momentum."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from twin import world

SCENE = """
{gravity}
object body {{
  shape box (4, 3, 2) cm
  position (0.1, -0.2, 0.3) m
  orientation axis (1, 2, 3) angle 40 deg
  density 1000
  elasticity 100 kPa
  velocity (1, -2, 3)
  spin (4, {spin}, 7)
}}
control {{
  time 1 s
  resolution 1 cm
}}
"""


def fly(ready, steps):
    """Positions and velocities after so many steps."""
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(steps)
        return instance.array("x").copy(), instance.array("v").copy()


def test_centre_of_mass_flies_on_the_parabola(prepared):
    """Meet x + v t + g t^2/2 and v + g t to 1e-10: the leap-frog is exact for a constant force."""
    ready = prepared(SCENE.format(gravity="gravity (0.5, 0, -9.81)", spin=60))
    s, steps = ready.system, 1500
    x, v = fly(ready, steps)
    t, g, v0 = steps * ready.certificate.timestep, np.array([0.5, 0.0, -9.81]), np.array([1.0, -2.0, 3.0])
    np.testing.assert_allclose(s.center_of_mass(x)[0], np.array([0.1, -0.2, 0.3]) + v0 * t + 0.5 * g * t * t, rtol=1e-10)
    np.testing.assert_allclose(s.center_of_mass(v)[0], v0 + g * t, rtol=1e-10)


def test_spin_is_that_of_the_naive_leap_frog(prepared):
    """Follow eq. (3.12), written out in NumPy, for 500 steps of a fast spin to 1e-10 of the body's size and speed."""
    ready = prepared(SCENE.format(gravity="gravity (0, 0, -9.81)", spin=60))
    s = ready.system

    def force(x):
        return world.spring_forces(x, s.spring, s.stiffness, s.rest)[0] + s.mass[:, None] * [0, 0, -9.81]

    x, v = fly(ready, 500)
    twin = world.leapfrog(s.position, s.velocity, force, s.mass, np.zeros(s.particles), ready.certificate.timestep, 500, ~s.held)
    np.testing.assert_allclose(x, twin[0], rtol=0, atol=1e-10 * 0.04)
    np.testing.assert_allclose(v, twin[1], rtol=0, atol=1e-10 * 60 * 0.02)


@pytest.mark.parametrize("spin", [10, 100])
def test_momenta_of_a_free_body_are_conserved(prepared, spin):
    """Keep momentum and angular momentum to 1e-12 over 3000 steps: forces are exactly opposite along the line of centres."""
    ready = prepared(SCENE.format(gravity="", spin=spin))
    s = ready.system
    x, v = fly(ready, 3000)

    def momenta(x, v):
        return s.mass @ v, s.mass @ np.cross(x - s.center_of_mass(x), v - s.center_of_mass(v))

    for before, after in zip(momenta(s.position, s.velocity), momenta(x, v)):
        assert np.linalg.norm(after - before) <= 1e-12 * np.linalg.norm(before)
    moved = np.linalg.norm(x - s.center_of_mass(x) - (s.position - s.center_of_mass(s.position)), axis=1).max()
    assert moved > 0.005, "the body must have turned, otherwise this test shows nothing"
