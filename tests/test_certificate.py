# SPDX-License-Identifier: GPL-2.0-only
"""The certified time step: rigorous, not needlessly strict, and it names what binds."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from mdanim_lammps.certificate import fit_steps
from mdanim_lammps.effects import EFFECTS
from mdanim_lammps.effects.contact import plane_stiffness
from mdanim_lammps.engine.commands import physics
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


POOL = """gravity (0, 0, -9.81)
liquid water {{
  basin from (-0.5, -0.5, 0) m to (0.5, 0.5, 2) m
  density 1000
  level {level} m
  {liquid}
}}
object cube {{
  shape box (20, 20, 20) cm
  position (0, 0, {height})
  density {density}
  elasticity {young} kPa
}}
control {{
  time 1 s
  resolution 5 cm
}}
"""


def pool(density=500, height=0.6, young=100, level=0.5, liquid="", more=""):
    """A scene of one cube above a liquid."""
    return POOL.format(density=density, height=height, young=young, level=level, liquid=liquid) + more


def test_buoyancy_is_a_spring_to_the_surface(prepared):
    """Add (rho_l/rho_s) g over the height of a cell to every particle's rate, and no more: a rigid body bobs more slowly."""
    ready = prepared(pool(density=250))
    found = next(e for e in EFFECTS if e.name == "buoyancy").rate(ready.scene, ready.system)
    np.testing.assert_allclose(found, 4 * 9.81 / 0.05, rtol=1e-12)
    soft, dry = (prepared(pool(density=250, young=0.05, more=more)).certificate for more in ("", "effects { buoyancy off }"))
    # Corner: 8 E / rho h^2 from springs, E / rho h^2 from the floor (a quarter of E h on an eighth of a cell's mass is 2).
    springs = (8 + 2) * 50 / (250 * 0.05**2)
    assert dry.bound == pytest.approx(2.0 / math.sqrt(springs), rel=1e-12)
    assert soft.bound == pytest.approx(2.0 / math.sqrt(springs + 4 * 9.81 / 0.05), rel=1e-12)


@pytest.mark.parametrize(("gamma", "drag", "told"), [
    pytest.param(4, "", "", id="weak"),
    pytest.param(4000, "", "liquid drag is strong", id="liquid"),
    pytest.param(600, "drag 5000", "air drag and liquid drag is strong", id="strong together"),
])
def test_strong_drag_of_the_liquid_is_told(prepared, gamma, drag, told):
    """Count gamma rho_l V_i with the drag of air, and take the exponential form where phi is above 0.5."""
    ready = prepared(pool(liquid=f"drag {gamma}").replace("density 500", f"density 500\n  {drag}"))
    found = [w for w in ready.warnings if "is strong" in w.message]
    assert [w.message.startswith(told) for w in found] == [True] * bool(told)
    assert ("drag exp" in "\n".join(physics(ready.plan))) == bool(told)
    if told:
        most = (gamma * 1000 + (5000 / 0.008 if drag else 0)) / 500 * ready.certificate.timestep / 2
        assert f"phi = {most:.2g}" in found[0].message


@pytest.mark.parametrize(("density", "height", "level", "more", "speed"), [
    pytest.param(500, 1.1, 0.01, "", 4.41, id="light, shallow: to the floor"),
    pytest.param(500, 1.1, 0.5, "", None, id="light, deep: never reaches the floor"),
    pytest.param(2000, 1.6, 0.5, "", 4.95, id="heavy: down to the floor, with half its weight in the liquid"),
    pytest.param(2000, 1.6, 0.5, "effects { buoyancy off }", 5.42, id="no buoyancy: as through air"),
    pytest.param(500, 1.6, 0.2, "object raft { shape box (20, 20, 20) cm position (0.3, 0.3, 0.1) density 900 elasticity 1 MPa }",
                 5.06, id="light, with another floating: to the surface"),
])
def test_a_liquid_breaks_a_fall(prepared, density, height, level, more, speed):
    """Count a fall through air down to the surface, and from there what the liquid leaves of the weight."""
    found = [w for w in prepared(pool(density, height, 20, level, more=more)).warnings if "crumpled" in w.message]
    if speed is None:
        assert not found
    else:
        assert f"may hit at {speed:.2g} m/s" in found[0].message
