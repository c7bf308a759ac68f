# SPDX-License-Identifier: GPL-2.0-only
"""Solids that yield, against closed forms: what stays of a push, what it takes; the bound; what is refused."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.export.csv import elastic, grown_in, system_of
from mdanim_lammps.features.springs.effect import spring_norm
from mdanim_lammps.features.yielding.effect import turned
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.scene.parse import parse_scene

PRESS = """ground z 0 m
object bar {{
  shape box ({wide}, {wide}, 20) cm  position (0, 0, 0.1) m  density 1800  elasticity {young} kPa  damping 0.5  yield-strain {e}
  {more}
}}
object plate {{
  shape box (20, 20, 4) cm  position (0, 0, 0.22) m  density 1800  elasticity rigid  hold all
  key 0.3 s at (0, 0, {low}) m  key 0.6 s at (0, 0, 0.23) m
}}
control {{ time 0.7 s frames 20 fps }}
expect bar.yielded > 0
"""


@pytest.mark.parametrize(
    ("wide", "young", "e", "down", "more"),
    [
        (8, 1000, 0.02, 0.0135, ""),
        pytest.param(6, 2000, 0.01, 0.0075, "", marks=pytest.mark.soak),
        (8, 1000, 0.02, 0.0135, "resolution 2 cm"),
        pytest.param(8, 500, 0.03, 0.02, "", marks=pytest.mark.soak),
    ],
)
def test_what_stays_of_a_push(prepared, tmp_path, wide, young, e, down, more):
    """A bar that is pushed together by s > e stays shorter by s - e, within 2 % of s, and takes E A e for each length of it; but
    for 5 %, as its ends, at which it gives way, are shorter than the whole."""
    ready = prepared(PRESS.format(wide=wide, young=young, e=e, low=0.22 - down, more=more))
    done = simulate(ready, tmp_path)
    assert [one.met for one in done.outcomes] == [True]
    with Trajectory(tmp_path / "trajectory.h5") as trajectory:
        first = trajectory.metadata.first
        z = np.array([trajectory.position(f)[first[0] : first[1], 2] for f in range(len(trajectory))])
        low, high = z[0] < z[0].min() + 1e-9, z[0] > z[0].max() - 1e-9
        long = z[:, high].mean(1) - z[:, low].mean(1)
        system = system_of(trajectory)
        last = len(trajectory) - 1
        told = elastic(system, trajectory.position(last), trajectory.gone(last), grown_in(trajectory, last))
    strain = long / long[0] - 1.0
    most, stays = -strain.min(), -strain[-1]
    assert most > 2.0 * e
    assert stays == pytest.approx(most - e, abs=0.02 * most)
    ledger = Ledger.read(tmp_path / "ledger.csv")
    assert ledger.array("yielding")[-1] == pytest.approx(young * 1e3 * (wide / 100) ** 2 * e * stays * long[0], rel=0.05)
    assert told[0] == pytest.approx(ledger.array("elastic")[-1], abs=1e-6 * ledger.array("yielding")[-1])
    assert np.abs(ledger.array("residual")).max() < 1e-3


def test_a_bar_that_is_pulled_stays_at_twice_the_strain(prepared):
    """A bar that is longer by 3 e and thinner by e/4 all at once, as one is that is pulled along a lattice axis, comes to rest at
    2 e, free of stress."""
    e = 0.02
    text = "object bar { shape box (20, 10, 10) cm  position (0, 0, 1) m  density 1000  elasticity 1 MPa  damping 1"
    ready = prepared(f"{text}  yield-strain {e} }}\ncontrol {{ time 0.2 s }}\n")
    start = ready.system.position
    x = start.mean(0) + (start - start.mean(0)) * np.array([1.0 + 3.0 * e, 1.0 - 0.25 * e, 1.0 - 0.25 * e])
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.array("x")[:] = x
        instance.run(2)
        instance.run(round(0.2 / ready.certificate.timestep))
        at = instance.array("x").copy()
        told = energies(instance, ready.system.center_of_mass(at))
    size = np.ptp(at, axis=0) / np.ptp(start, axis=0) - 1.0
    assert size[0] == pytest.approx(2.0 * e, rel=0.02)
    assert np.abs(size[1:]).max() < 0.03 * e
    assert told["elastic"] < 1e-3 * told["yielding"]


def test_below_the_strain_nothing_changes(prepared):
    """The motion is that of a body without yield-strain: the bits of its forces are the same."""
    text = "object a {{ shape box (20, 10, 10) cm  position (0, 0, 1) m  density 1000  elasticity 1 MPa  hold face -x {} }}\n"
    found = []
    for word in ("", "yield-strain 0.5"):
        ready = prepared("gravity (0, 0, -9.81) m/s^2\n" + text.format(word) + "control { time 0.1 s  timestep 0.02 ms }\n")
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(2000)
            found.append(instance.array("x").copy())
    assert np.array_equal(*found)


def test_the_bound_holds_for_any_form(prepared):
    """The share in the bound is that of springs along one line: no motion of the particles makes a body stiffer."""
    text = "object a { shape box (12, 10, 8) cm  position (0, 0, 1) m  density 1000  elasticity 1 MPa  yield-strain 0.02 }\n"
    system = (ready := prepared(text + "control { time 0.1 s }\n")).system
    own = 2.0 * spring_norm(system, system.stiffness) / system.mass
    whole = own + turned(ready.plan.context, system.stiffness)
    chance = np.random.default_rng(1)
    i, j = system.spring.T
    for flat in (0.0, 0.3):
        x = system.position * np.array([1.0, 1.0, flat]) + chance.normal(0.0, 0.01, system.position.shape)
        apart = x[i] - x[j]
        r = np.linalg.norm(apart, axis=1)
        n = apart / r[:, None]
        along = n[:, :, None] * n[:, None, :]
        # Springs bear less than 0.1 of their length.
        block = system.stiffness[:, None, None] * (along + 0.1 * (np.eye(3) - along))
        sums = np.zeros((system.particles, 3, 3))
        np.add.at(sums, i, block)
        np.add.at(sums, j, block)
        assert (2.0 * np.linalg.eigvalsh(sums)[:, -1] / system.mass <= whole * (1.0 + 1e-12)).all()


def test_dents_are_told(prepared, tmp_path):
    """Frames have the growth of each spring, `expect` the largest of an object."""
    text = PRESS.format(wide=8, young=1000, e=0.02, low=0.21, more="").replace("> 0\n", "> 0.02\nexpect bar.yielded at 0 s = 0\n")
    done = simulate(prepared(text), tmp_path)
    assert [one.met for one in done.outcomes] == [True, True]
    with Trajectory(tmp_path / "trajectory.h5") as trajectory:
        assert not trajectory.field("grown", 0).any() and trajectory.field("grown", len(trajectory) - 1).min() < -1e-4


SOLID = "object a { shape box (1, 1, 1) m position (0, 0, 1) m density 1 "
MISTAKES = [
    (
        SOLID + "elasticity rigid yield-strain 0.1 }",
        "yield-strain",
        "a is rigid: it has no springs that could yield",
        "elasticity 1 MPa",
    ),
    (SOLID + "elasticity 1 MPa hold all yield-strain 0.1 }", "yield-strain", "a is held as a whole", "hold less"),
    (SOLID + "elasticity 1 MPa yield-strain 0 }", "0 }", "yield-strain must be > 0", ""),
    (SOLID + "elasticity 1 MPa yield-strain -1 }", "-1 }", "yield-strain must be > 0", ""),
    (SOLID + "elasticity 1 MPa yield-stain 0.1 }", "yield-stain", "'yield' cannot follow here", "yield-strain"),
    (SOLID + "elasticity 1 MPa plasticity 0.1 }", "plasticity", "plasticity is not supported", "yield-strain 0.02"),
]


@pytest.mark.parametrize(("text", "at", "words", "way_out"), MISTAKES)
def test_mistakes(text, at, words, way_out):
    """Place, cause and way out."""
    with pytest.raises(SceneError) as error:
        parse_scene(text + "\ncontrol { time 1 s }\n")
    (problem,) = error.value.problems
    assert words in problem.message and way_out in problem.hint, str(problem)
    assert (problem.line, problem.column) in ((1, text.index(at) + 1), (1, text.index(at) + 1 + len("yield-strain "))), str(
        problem
    )
