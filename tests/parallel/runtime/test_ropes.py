# SPDX-License-Identifier: GPL-2.0-only
"""Ropes give the same bits in all forms of the distribution, and by plain `lmp`."""

import numpy as np
import pytest
from distribution_lab import FORMS, THREADS, forms_in, gone_on_after, lammps_makes_the_same, same_frames
from mdanim_lammps.results.trajectory import Trajectory

pytestmark = pytest.mark.mpi

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object roller {
  shape cylinder 10 cm 30 cm  orientation axis (1, 0, 0) angle 90 deg  position (0, 0, 0.4) m
  density 1000  elasticity 2 MPa  hold all  friction 0.3
}
repeat i in 1 .. 3 {
  object line[i] {
    shape rope from (-0.35, 0.06*i - 0.1, 0.55) m to (0.45, 0.05*i - 0.1, 0.55) m thickness 2 cm
    density 1000  elasticity 1 MPa  damping 0.1  friction 0.3
  }
}
object rail {
  shape chain from (-0.6, 0, 0.5) m to (-0.2, 0.3, 0.5) m thickness 1 cm length 60 cm
  density 1000  elasticity 300 kPa  hold ends
}
object crate {
  shape box (10, 10, 10) cm  position (0.2, 0, 0.06) m  resolution 5 cm  density 300  elasticity 200 kPa  friction 0.4
}
object stone { shape sphere 6 cm  position (-0.3, 0, 0.07) m  density 300  elasticity rigid  friction 0.4 }
control { time 0.4 s }
"""

CASES = FORMS | THREADS | gone_on_after(4)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("ropes"), SCENE, CASES)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames and the state, with the anchors of friction."""
    alone, other = same_frames(found, way)
    assert alone.records == other.records and np.array_equal(alone.x, other.x)


def test_something_happens(found):
    """Ropes are pressed against the roller, and one against the other objects."""
    with Trajectory(found["sequential"]) as trajectory:
        first, last = trajectory.position(0), trajectory.position(len(trajectory) - 1)
        rows = trajectory.metadata.object_of == 1
    assert np.abs(last - first)[rows].max() > 0.1


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.soak), 2])
def test_lammps_alone_makes_the_same_frames(found, tmp_path, ranks):
    """The script that `build` writes, with its file of bodies."""
    lammps_makes_the_same(found, tmp_path, SCENE, ranks)
