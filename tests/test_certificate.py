# SPDX-License-Identifier: GPL-2.0-only
"""The certified time step: rigorous, not needlessly strict, and it names what binds."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from mdanim_lammps.certificate import fit_steps
from mdanim_lammps.effects.contact import plane_stiffness
from mdanim_lammps.errors import RefusedError, SceneError

BOX = """
object a {{
  shape box ({size}, {size}, {size}) cm
  position (0, 0, 0) m
  density 1000
  elasticity {young} kPa
  {extra}
}}
control {{
  time 1 s
  resolution 1 cm
  {control}
}}
"""


def box(size=4, young=100, extra="", control=""):
    """A scene of one cube."""
    return BOX.format(size=size, young=young, extra=extra, control=control)


def highest_frequency(system) -> float:
    """Exact highest angular frequency of the spring network, from its dense stiffness matrix."""
    n = system.particles
    matrix = np.zeros((n, 3, n, 3))
    for (i, j), k in zip(system.spring, system.stiffness):
        d = system.position[i] - system.position[j]
        block = k * np.outer(d, d) / (d @ d)
        matrix[i, :, i] += block
        matrix[j, :, j] += block
        matrix[i, :, j] -= block
        matrix[j, :, i] -= block
    root = np.repeat(np.sqrt(system.mass), 3)
    return math.sqrt(np.linalg.eigvalsh(matrix.reshape(3 * n, 3 * n) / np.outer(root, root))[-1])


@pytest.mark.parametrize("size", [1, 2, 4])
def test_bound_is_below_the_exact_limit_and_near_it(prepared, size):
    """Stay below 2/omega_max of the network, and within 25 % of it (physics: 1.00 for one cell, 1.24 for larger boxes)."""
    ready = prepared(box(size))
    exact = 2.0 / highest_frequency(ready.system)
    assert exact / 1.25 <= ready.certificate.bound <= exact * (1 + 1e-12)


def test_corner_of_a_cube_sets_the_bound(prepared):
    """Give omega = 2.83 sqrt(E/rho)/h for a cube, whose corner binds."""
    c = prepared(box()).certificate
    assert c.bound == pytest.approx(2.0 / (math.sqrt(8.0) * math.sqrt(1e5 / 1000) / 0.01), rel=1e-12)
    assert (c.object, c.cause) == ("a", "springs")
    assert c.timestep <= 0.5 * c.bound


def test_stiffest_object_binds(prepared):
    """Name the object that is 1000 times stiffer."""
    text = box().replace("control", "object b {\n shape box (4, 4, 4) cm\n position (1, 0, 0) m\n density 1000\n"
                         " elasticity 100 MPa\n}\ncontrol")
    c = prepared(text).certificate
    assert c.object == "b"
    assert c.span.text.strip() == "elasticity 100 MPa"


def test_contact_shortens_the_step(prepared):
    """Include the barrier once there are two objects that may meet."""
    alone = prepared(box()).certificate.bound
    text = box().replace("control", "object b {\n shape box (4, 4, 4) cm\n position (1, 0, 0) m\n density 1000\n"
                         " elasticity 100 kPa\n}\ncontrol")
    together = prepared(text).certificate.bound
    # Corner: 8 E/rho h^2 from springs, 2 * 1.61 * 0.4 * 8 from the barrier (docs/physics-contact.md).
    assert together == pytest.approx(alone * math.sqrt(8.0 / (8.0 + 2 * plane_stiffness(1.6) * 0.4 * 8)), rel=1e-3)


def test_damping_shortens_the_step(prepared):
    """Solve dt^2 a + 2 dt b = 4 with the dashpots' part."""
    bounds = [prepared(box(extra=f"damping {zeta}" if zeta else "")).certificate.bound for zeta in (0, 0.01, 0.1, 1)]
    assert bounds == sorted(bounds, reverse=True) and bounds[3] < 0.5 * bounds[0] < bounds[1]


def test_step_above_the_bound_is_refused(prepared):
    """Refuse, name the object and the way out; insist with allow_unstable."""
    bound = prepared(box()).certificate.bound
    with pytest.raises(RefusedError, match=r"above the certified bound.*set by a \(springs\)"):
        prepared(box(control=f"timestep {1.01 * bound!r} s"))
    assert prepared(box(control=f"timestep {bound!r} s")).certificate.timestep <= bound


def scene(time, frames=30.0):
    """What fit_steps reads of a scene."""
    return SimpleNamespace(control=SimpleNamespace(time=time, frames=frames, spans={}))


@pytest.mark.parametrize(("time", "frames", "longest", "expected"), [
    pytest.param(3.0, 30.0, 1e-3, (34, 90, 0), id="whole frames"),
    pytest.param(3.0, 30.0, 1 / 30, (1, 90, 0), id="step as long as a frame"),
    pytest.param(3.01, 30.0, 1e-3, (40, 90, 12), id="last frame shorter: a multiple of ten steps per frame"),
    pytest.param(0.01, 30.0, 1e-3, (40, 0, 12), id="shorter than one frame"),
    pytest.param(1.0, 30.0, math.inf, (1, 30, 0), id="nothing vibrates"),
])
def test_fit_steps(time, frames, longest, expected):
    """Meet frames and end with one time step."""
    per_frame, whole, last = fit_steps(scene(time, frames), longest)
    assert (per_frame, whole, last) == expected
    dt = 1.0 / (frames * per_frame)
    assert dt <= longest * (1 + 1e-12)
    assert (per_frame * whole + last) * dt == pytest.approx(time, rel=1e-12)


def test_a_time_that_fits_no_step_is_a_problem():
    """Say which duration would do."""
    with pytest.raises(SceneError, match="try 'time 1.73333 s'"):
        fit_steps(scene(math.sqrt(3.0)), 1e-2)


@pytest.mark.parametrize(("young", "height", "warned"), [
    pytest.param("100 kPa", 0.6, True, id="soft ball from 60 cm: 0.29 of the wave speed"),
    pytest.param("1 MPa", 0.6, False, id="stiffer"),
    pytest.param("100 kPa", 0.12, False, id="lower"),
])
def test_a_landing_that_is_too_hard_is_told(prepared, young, height, warned):
    """Warn when a fall ends at more than 0.2 of the wave speed, with an elasticity that will do."""
    text = (f"gravity (0, 0, -9.81)\nground z 0\nobject ball {{\n shape sphere 0.1\n position (0, 0, {height})\n density 1000\n"
            f" elasticity {young}\n}}\ncontrol {{ time 1 s }}")
    found = [w for w in prepared(text).warnings if "crumpled" in w.message]
    assert bool(found) == warned
    if warned:
        assert found[0].span.line == 7 and "write elasticity" in found[0].hint
