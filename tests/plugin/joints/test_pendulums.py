# SPDX-License-Identifier: GPL-2.0-only
"""Pendulums on joints against closed forms. Joints have a frequency of 2000/s, the time step is 0.35 of 1/frequency."""

import joint_lab as lab
import numpy as np
import pytest
import rigid_lab
from scipy.integrate import solve_ivp
from scipy.special import ellipk

G, FREQUENCY = 9.81, 2000.0
DT = 0.35 / FREQUENCY


def rod(length, thickness, angle, mass=1.0, top=(0.0, 0.0, 0.0), spin=(0, 0, 0)):
    """A rigid rod that hangs from its top, turned by an angle towards x."""
    q = rigid_lab.about((0, 1, 0), -angle)
    down = rigid_lab.matrix(q) @ [0, 0, -0.5 * length]
    at = np.asarray(top, float) + down
    return lab.box((thickness, thickness, length), mass, at, q, np.cross(spin, down), spin)


def angles(world, body, periods, period):
    """Times and angles of a body's centre below the origin, some 40 a period."""
    every = max(1, round(period / 40.0 / world.dt))
    found = []
    for n in range(1, round(periods * 40) + 1):
        world.run(every)
        x, _, z = world.centre(body)
        found.append((n * every * world.dt, np.arctan2(x, -z)))
    return np.array(found).T


def period_of(t, angle):
    """From crossings of zero by cubics through four angles."""
    (at,) = np.nonzero(angle[:-1] * angle[1:] < 0)
    crossings = []
    for n in at[(at > 0) & (at < len(t) - 2)]:
        near = slice(n - 1, n + 3)
        crossings.append(np.polyval(np.polyfit(angle[near], t[near] - t[n], 3), 0.0) + t[n])
    return 2.0 * np.diff(crossings).mean()


@pytest.mark.parametrize("joint", ["hinge 1 world at 0 0 0 axis 0 1 0", "ball 1 world at 0 0 0"], ids=["hinge", "ball"])
@pytest.mark.parametrize("degrees", [5, 120])
@pytest.mark.parametrize(("length", "thickness"), [(1.0, 0.02), (0.2, 0.05)])
def test_a_rigid_rod_swings(tmp_path, joint, degrees, length, thickness):
    """4 K(sin(angle/2)) sqrt(I/(m g L/2)) with I of its box, 2 pi sqrt(2L/3g) for a thin one at a small angle."""
    angle = np.radians(degrees)
    moment = length**2 / 3.0 + thickness**2 / 12.0
    period = 4.0 * ellipk(np.sin(0.5 * angle) ** 2) * np.sqrt(moment / (0.5 * G * length))
    with lab.World(tmp_path, [rod(length, thickness, angle)], [f"{joint} frequency {FREQUENCY}"], DT) as world:
        start = world.energy()
        found = period_of(*angles(world, 1, 1.6, period))
        # Crossings by cubics are good to 1e-4; softness adds (g/L)/frequency^2, below 2e-5.
        assert found == pytest.approx(period, rel=3e-4)
        assert world.energy() == pytest.approx(start, abs=1e-5 * G * length)
        assert world.told("gap") < 1e-4 * length
        if joint.startswith("hinge"):  # axis y: a positive angle takes -z to -x
            x, _, z = world.centre(1)
            assert world.told("way") == pytest.approx(angle - np.arctan2(x, -z), abs=1e-4)


@pytest.mark.parametrize(("degrees", "modulus"), [(5, 2e7), (120, 2e7)])
def test_an_elastic_rod_swings(tmp_path, degrees, modulus):
    """A bar of 2 x 2 x 12 cells on a hinge through its end; it hangs down by some mm when it turns, which gravity tells."""
    h, angle, density = 0.05, np.radians(degrees), 1000.0
    q = rigid_lab.matrix(rigid_lab.about((0, 1, 0), -angle))
    bar = lab.elastic((2, 2, 12), h, density, modulus, (-h, -h, -12 * h), lambda x: x @ q.T)
    mass, arm = bar.mass.sum(), (bar.mass @ bar.x) / bar.mass.sum()
    moment = (bar.mass * (bar.x[:, 0] ** 2 + bar.x[:, 2] ** 2)).sum()
    period = 4.0 * ellipk(np.sin(0.5 * angle) ** 2) * np.sqrt(moment / (mass * G * np.linalg.norm(arm)))
    stiffness = 0.5 * modulus * h
    joint = f"hinge 1 world at 0 0 0 axis 0 1 0 patch {1.9 * h} all stiffness {stiffness}"
    dt = 0.3 * h * np.sqrt(density / modulus)
    with lab.World(tmp_path, [bar], [joint], dt, elastic=(1,)) as world:
        start = world.energy()
        found = period_of(*angles(world, 1, 1.1, period))
        assert found == pytest.approx(period, rel=5e-3)
        assert world.energy() == pytest.approx(start, abs=1e-4 * mass * G * 12 * h)


def test_a_conical_pendulum_keeps_its_height(tmp_path):
    """A rod that goes round at an angle: w^2 = m g L/2 / ((I_across - I_along) cos(angle))."""
    length, thickness, angle = 0.5, 0.02, np.radians(40)
    rate = np.sqrt(0.5 * G * length / ((length**2 / 3.0 - thickness**2 / 12.0) * np.cos(angle)))
    body = rod(length, thickness, angle, spin=(0, 0, rate))
    with lab.World(tmp_path, [body], [f"ball 1 world at 0 0 0 frequency {FREQUENCY}"], DT) as world:
        height, way = world.centre(1)[2], 0.0
        before = world.centre(1)
        for _ in range(60):
            world.run(round(2 * np.pi / rate / 40 / DT))
            now = world.centre(1)
            way += np.arctan2(before[0] * now[1] - before[1] * now[0], before[:2] @ now[:2])
            before = now
            # The pull comes at once, so the joint swings by twice F/K = 1e-6 at first.
            assert now[2] == pytest.approx(height, abs=1e-4 * length)
        assert way == pytest.approx(rate * 60 * round(2 * np.pi / rate / 40 / DT) * DT, rel=1e-4)


def double(t, y, length):
    """Derivatives of two thin rods on each other, angles from below and their rates."""
    a, b, u, v = y
    c, s = np.cos(a - b), np.sin(a - b)
    matrix = np.array([[4.0 / 3.0, 0.5 * c], [0.5 * c, 1.0 / 3.0]])
    push = np.array([-0.5 * s * v * v - 1.5 * G / length * np.sin(a), 0.5 * s * u * u - 0.5 * G / length * np.sin(b)])
    return [u, v, *np.linalg.solve(matrix, push)]


def two_rods(folder, frequency, commands=()):
    """A double pendulum of two thin rods, both turned by 120 degrees."""
    length, angle = 0.5, np.radians(120)
    end = length * np.array([np.sin(angle), 0, -np.cos(angle)])
    rods = [rod(length, 0.005, angle), rod(length, 0.005, angle, top=end)]
    place = " ".join(repr(float(x)) for x in end)
    joints = [
        f"hinge 1 world at 0 0 0 axis 0 1 0 frequency {frequency}",
        f"hinge 2 1 at {place} axis 0 1 0 frequency {frequency}",
    ]
    return lab.World(folder, rods, joints, 0.2 / frequency, commands=commands), length, angle


def test_a_double_pendulum_follows_its_equations(tmp_path):
    """For a second, after which chaos takes over."""
    world, length, angle = two_rods(tmp_path, 4000.0)
    with world:
        world.run(round(1.0 / world.dt))
        x, _, z = world.centre(1)
        found = solve_ivp(double, (0, 1.0), [angle, angle, 0, 0], args=(length,), rtol=1e-10, atol=1e-10).y[:2, -1]
        assert np.angle(np.exp(1j * (np.arctan2(x, -z) - found[0]))) == pytest.approx(0.0, abs=2e-3)


def test_a_double_pendulum_keeps_its_energy(tmp_path):
    """To 1e-4 of what falls, for ten seconds."""
    world, length, _ = two_rods(tmp_path, 4000.0)
    with world:
        start, scale = world.energy(), 2.0 * G * length
        for _ in range(20):
            world.run(round(0.5 / world.dt))
            assert world.energy() == pytest.approx(start, abs=1e-4 * scale)
