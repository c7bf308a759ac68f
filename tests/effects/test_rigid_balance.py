# SPDX-License-Identifier: GPL-2.0-only
"""The books of rigid objects in every step, also in the middle of a blow that takes a few steps."""

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


def residual(ready, steps: int, each: int = 1) -> float:
    """Largest change of all energies together at any of these steps, over the largest energy that moved."""
    sources, told = source_terms(ready.plan), []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(steps // each + 1):
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            instance.run(each)
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
    assert residual(ready, round(1.4 / spin / ready.certificate.timestep)) < 1e-3


@pytest.mark.parametrize("more", ["", "drag 0.2", "drag 0.02"])
def test_a_spring_gives_what_the_object_loses(prepared, more):
    """To rounding: leap-frog takes from the velocities half a step before and after what a linear spring gains, drag included."""
    assert residual(prepared(SPRING.format(shape="sphere 5 cm", at="(0, 0, 0.6) m", more=more)), 300) < 1e-12
