# SPDX-License-Identifier: GPL-2.0-only
"""Solids, sheets and ropes that yield, some of which tear too, give the same bits in all forms of the distribution, gone on with,
and by plain `lmp`."""

import numpy as np
import pytest
from distribution_lab import FORMS, forms_in, gone_on_after, lammps_makes_the_same, same_frames
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.trajectory import Trajectory

pytestmark = pytest.mark.mpi

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
repeat i in 1 .. 3 {
  object lump[i] {
    shape box (8, 8, 8) cm  position (0.2*i - 0.6, 0, 0.08 + 0.03*i) m  orientation axis (1, 1, 0) angle 40*i deg  resolution 3 cm
    density 1500  elasticity 2 MPa  damping 0.2  friction 0.4  yield-strain 0.01*i  velocity (0.3, 0, -2) m/s
  }
}
object paper {
  shape sheet (12, 10) cm thickness 2 mm  position (-0.5, 0.4, 0.07) m  orientation axis (0, 1, 0) angle 70 deg  resolution 2 cm
  density 800  elasticity 2 MPa  damping 0.2  yield-strain 0.01  tear-strain 0.3  velocity (0, 0, -4) m/s  spin (0, 20, 0) rad/s
}
object wire {
  shape rope from (-0.4, -0.4, 0.02) m to (-0.1, -0.4, 0.1) m thickness 1 cm  resolution 2 cm
  density 3000  elasticity 2 MPa  damping 0.2  yield-strain 0.005  velocity (0, 0, -3) m/s
}
object beam {
  shape box (30, 6, 6) cm  position (0, 0.3, 0.1) m  resolution 3 cm  density 1000  elasticity 200 kPa  damping 0.1
  hold faces x  yield-strain 0.02  tear-strain 0.25
}
object stone { shape box (8, 8, 8) cm  position (0, 0.3, 0.2) m  velocity (0, 0, -4) m/s  density 2500  elasticity rigid }
object crate { shape box (10, 10, 10) cm  position (0.5, 0.4, 0.06) m  density 300  elasticity 200 kPa  friction 0.4 }
control { time 0.2 s }
"""
YIELDS = 6
"""Objects that may yield, the first ones."""
PAPER = 4
"""The sheet."""

CASES = FORMS | gone_on_after(3)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("yielding"), SCENE, CASES)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames, with the growth in each, the state, and the work but for rounding."""
    alone, other = same_frames(found, way)
    assert "column grown" in alone.records and "column bent" in alone.records
    for column, first in (("column grown", 1), ("column bent", PAPER), ("column torn", PAPER)):  # those before never tear
        state = [of.records.pop(column) for of in (alone, other)]
        changed = [one.where((one.keys[:, 0] >= first) & (one.keys[:, 0] <= YIELDS)) for one in state]  # others may be without
        assert changed[0] == changed[1]
    assert alone.records == other.records and np.array_equal(alone.x, other.x)
    work = [Ledger.read(found[name] / "ledger.csv").array("yielding") for name in ("sequential", way)]
    assert work[0][-1] > 0.0 and work[1] == pytest.approx(work[0], rel=1e-9, abs=1e-12)


def test_all_yield(found):
    """Some before the run was stopped, some after; the beam tears, too."""
    with Trajectory(found["sequential"]) as trajectory:
        grown = [np.abs(trajectory.field("grown", frame)) for frame in range(len(trajectory))]
        torn = trajectory.field("torn", len(trajectory) - 1).sum()
        ends = np.searchsorted(trajectory.metadata.id, trajectory.metadata.bond[grown[-1] > 0.0, 0])
        of = np.searchsorted(trajectory.metadata.first, ends, side="right") - 1
    assert grown[0].sum() == 0.0 and 0.0 < grown[2].sum() < grown[-1].sum()
    assert set(of.tolist()) == set(range(YIELDS)) and torn > 0.0


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.soak), 2])
def test_lammps_alone_makes_the_same_frames(found, tmp_path, ranks):
    """The script that `build` writes."""
    lammps_makes_the_same(found, tmp_path, SCENE, ranks)
