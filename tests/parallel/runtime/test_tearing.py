# SPDX-License-Identifier: GPL-2.0-only
"""Ropes, sheets and solids that tear give the same bits in all forms of the distribution, gone on with, and by plain `lmp`."""

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
  object line[i] {
    shape rope from (-0.4, 0.05*i - 0.1, 0.6 + 0.02*i) m to (0.4, 0.05*i - 0.1, 0.6 + 0.02*i) m thickness 1 cm
    resolution 2 cm  density 1000  elasticity 500 kPa  damping 0.1  friction 0.3  hold ends  tear-strain 0.05*i
  }
}
object loose {
  shape chain from (-0.6, 0.3, 0.4) m to (-0.2, 0.3, 0.4) m thickness 1 cm  density 1000  elasticity 300 kPa
  velocity (0, 0, 1) m/s  hold start  tear-strain 0.1
}
object paper {
  shape sheet (0.5, 0.3) m thickness 2 mm  position (0, 0, 0.45) m  resolution 5 cm  density 500  elasticity 1 MPa  damping 0.1
  hold faces x  tear-strain 0.05
}
object jelly {
  shape box (30, 20, 10) cm  position (0, 0, 0.1) m  resolution 5 cm  density 1000  elasticity 100 kPa  damping 0.1
  hold faces x  tear-strain 0.1
}
object stone { shape box (12, 20, 10) cm  position (0, 0, 0.74) m  resolution 4 cm
  velocity (0, 0, -4) m/s  density 2500  elasticity rigid }
object balloon {
  shape sphere 8 cm sheet thickness 1 mm  position (-0.5, -0.5, 0.3) m  resolution 2.5 cm  density 900  elasticity 1 MPa
  damping 0.1  velocity (0, 0, -3) m/s  inflate 5 kPa  tear-strain 0.1
}
object thorn { shape cone 3 cm 15 cm  position (-0.5, -0.49, 0.075) m  resolution 2 cm  density 1000  elasticity rigid  hold all }
object crate {
  shape box (10, 10, 10) cm  position (0.5, 0.4, 0.06) m  resolution 5 cm  density 600  elasticity 100 kPa  friction 0.4
}
control { time 0.3 s }
"""

BALLOON = 7
CASES = FORMS | gone_on_after(5)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("tearing"), SCENE, CASES)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames, with what is torn in each, the state, and the energy that is gone but for rounding."""
    alone, other = same_frames(found, way)
    assert "column torn" in alone.records
    torn = [of.records.pop("column torn") for of in (alone, other)]
    tearing = [one.where(one.keys[:, 0] <= 8) for one in torn]  # what never tears may be without
    assert tearing[0] == tearing[1] and alone.records == other.records and np.array_equal(alone.x, other.x)
    torn = [Ledger.read(found[name] / "ledger.csv").array("torn") for name in ("sequential", way)]
    assert torn[0][-1] > 0.0 and torn[1] == pytest.approx(torn[0], rel=1e-9, abs=1e-12)


def test_all_tear(found):
    """Some before the run was stopped, some after; each of the kinds; the gas of the balloon is gone."""
    with Trajectory(found["sequential"]) as trajectory:
        torn = [trajectory.field("torn", frame).sum() for frame in range(len(trajectory))]
        last = np.searchsorted(trajectory.metadata.first, np.unique(trajectory.gone(len(trajectory) - 1)), side="right") - 1
        popped = [trajectory.field("gas_pressure", frame)[BALLOON] for frame in (0, len(trajectory) - 1)]
    assert torn[0] == 0.0 and 0.0 < torn[4] < torn[-1]
    assert {0, 4, 5, BALLOON} <= set(last.tolist()) and popped[0] > 0.0 and popped[1] == 0.0


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.soak), 2])
def test_lammps_alone_makes_the_same_frames(found, tmp_path, ranks):
    """The script that `build` writes."""
    lammps_makes_the_same(found, tmp_path, SCENE, ranks)
