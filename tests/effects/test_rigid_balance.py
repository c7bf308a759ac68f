# SPDX-License-Identifier: GPL-2.0-only
"""The books of rigid objects in every step, also in the middle of a blow that takes a few steps."""

import math

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.energy import energies, source_terms

DISC = """object disc {{
  shape cylinder {radius} m {high} m  position (0, 0, 1.5) m  orientation axis (1, 0, 0) angle 90 deg
  density {density}  elasticity rigid  spin (0, {spin}, 0) rad/s
}}
joint hinge disc world {{ axis (0, 1, 0) limits -1 deg to 60 deg }}
control {{ time 0.5 s  frames 200 }}
"""
SPRING = """object mass {{ shape {shape}  density 1000  elasticity rigid  position (0, 0, 0.6) m {more} }}
joint spring mass world {{ from {at}  to (0, 0, 1) m  length 30 cm  stiffness 80 N/m }}
control {{ time 2 s }}
"""

DROP = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object block {{ shape {shape}  density 900  position (0, 0, 0.3) m  orientation axis (1, 2, 0) angle 40 deg
  elasticity rigid  restitution {e} }}
control {{ time 0.35 s  friction {mu} }}
"""


def residual(ready, steps: int, each: int = 1, before: int = 0) -> float:
    """Largest change of all energies together after steps before and at each of further ones, over the largest energy that
    moved."""
    sources, told = source_terms(ready.plan), []
    with Instance(ready.plan) as instance:
        instance.setup()
        for look in range(steps // each + 2):
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            instance.run(each if look else before)
    terms = [name for name in told[0] if name != "contact_bound"]
    total = [sum(e[name] * (-1.0 if name in sources else 1.0) for name in terms) for e in told]
    play = max(max(e[name] for e in told) - min(e[name] for e in told) for name in terms)
    return float(np.abs(np.array(total) - total[0]).max() / play)


@pytest.mark.parametrize(
    ("radius", "high", "density", "spin"), [(0.1, 0.06, 700, 5), (0.02, 0.01, 7800, 60), (1.0, 0.5, 300, 1.5)]
)
def test_a_disc_meets_its_stop(prepared, radius, high, density, spin):
    """The blow takes a few steps of the automatic time step. What is left is of second order in the angle of a step, up to 3
    degrees here, because the torque of a dashpot does its work on a chord."""
    ready = prepared(DISC.format(radius=radius, high=high, density=density, spin=spin))
    arrives = math.radians(60.0) / spin / ready.certificate.timestep
    assert residual(ready, 30, before=int(arrives) - 5) < 1e-3


@pytest.mark.parametrize("more", ["", "drag 0.2", "drag 0.02"])
def test_a_spring_gives_what_the_object_loses(prepared, more):
    """To rounding: leap-frog takes from the velocities half a step before and after what a linear spring gains, drag included."""
    assert residual(prepared(SPRING.format(shape="sphere 5 cm", at="(0, 0, 0.6) m", more=more)), 150) < 1e-12


@pytest.mark.parametrize("shape", ["box (20, 10, 6) cm", "cylinder 6 cm 15 cm", "sphere 8 cm"])
@pytest.mark.parametrize(("e", "mu"), [(0.3, 0.5), (0.8, 0.0)])
def test_a_blow_keeps_its_books_in_each_step(prepared, shape, e, mu):
    """A fall of a few centimetres with a blow, or two of them, at the defaults: 1e-3 is what `balanced` stands for."""
    ready = prepared(DROP.format(shape=shape, e=e, mu=mu))
    assert residual(ready, ready.certificate.steps // 3, 3, before=ready.certificate.steps // 2) < 1e-3


def kept(prepared, gaps, radii, density: float) -> float:
    """Kinetic energy of balls in a row after blows without losses, over that before; the first one comes at 1 m/s."""
    row, at = "", 0.0
    for n, (gap, radius) in enumerate(zip((0.0, *gaps), radii)):
        at += radii[n - 1] + gap + radius if n else 0.0
        row += f"object b[{n}] {{ shape sphere {radius} cm position ({at!r}, 0, 0) cm density {density} elasticity rigid\n"
        row += f"restitution 1  velocity ({1.0 if n == 0 else 0.0}, 0, 0) m/s }}\n"
    ready = prepared(row + "control { time 0.2 s }\n")
    with Instance(ready.plan) as instance:
        instance.setup()
        told = []
        for _ in range(2):
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            instance.run(ready.certificate.steps)
    assert abs(told[1]["contact"]) < 1e-20 and abs(told[1]["let_go"]) < 1e-6 * told[0]["kinetic"]
    return told[1]["kinetic"] / told[0]["kinetic"]


@pytest.mark.parametrize("gap", [0.5, 0.523, 0.571])
@pytest.mark.parametrize("radii", [(5, 5), (5, 2), (3, 6)])
def test_a_blow_of_two_balls_keeps_all(prepared, gap, radii):
    """To rounding, whenever in a step it begins: forces do the work of the spring in its onset and at both ends too."""
    assert kept(prepared, (gap,), radii, 7800) == pytest.approx(1.0, abs=1e-11)


@pytest.mark.parametrize(("gaps", "radii"), [((0.5, 0.1), (5, 5, 5)), ((0.5, 0.02), (5, 5, 5)), ((0.5, 0.1, 0.1, 0.1), (5,) * 5)])
def test_blows_that_overlap_keep_all(prepared, gaps, radii):
    """A ball touches the next one while the one before still presses it; it was 2.4e-3 for three balls, 7e-3 for five."""
    assert kept(prepared, gaps, radii, 7800) == pytest.approx(1.0, abs=1e-4)


def test_a_cradle_on_strings_keeps_its_energy(prepared):
    """Five balls, the first one lifted by 30 degrees, three swings: 1.2e-2 were lost."""
    balls = "".join(
        f"object b[{n}] {{ shape sphere 5 cm position ({x}, 0, {z}) density 7800 elasticity rigid restitution 1 }}\n"
        f"joint spring b[{n}] world {{ to ({10.1 * n}, 20, 100) cm pulls only }}\n"
        f"joint spring b[{n}] world {{ to ({10.1 * n}, -20, 100) cm pulls only }}\n"
        for n, x, z in [
            (0, "-50*sin(30 deg) cm", "100 cm - 50*cos(30 deg) cm"),
            *((n, f"{10.1 * n} cm", "50 cm") for n in range(1, 5)),
        ]
    )
    ready = prepared(f"gravity (0, 0, -9.81) m/s^2\n{balls}control {{ time 3 s }}\n")
    assert residual(ready, ready.certificate.steps, 20) < 1e-3
