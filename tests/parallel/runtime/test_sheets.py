# SPDX-License-Identifier: GPL-2.0-only
"""Sheets give the same bits in all forms of the distribution, and by plain `lmp`."""

import numpy as np
import pytest
from distribution_lab import FORMS, THREADS, forms_in, gone_on_after, lammps_makes_the_same, same_frames
from mdanim_lammps.results.trajectory import Trajectory

pytestmark = pytest.mark.mpi

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object ball { shape sphere 12 cm  position (0, 0, 0.2) m  density 1000  elasticity 2 MPa  hold all  friction 0.3 }
repeat i in 1 .. 2 {
  object cloth[i] {
    shape sheet (0.5, 0.4) m thickness 3 mm  position (0.05, 0.02, 0.33 + 0.06*i) m  resolution 4 cm
    density 500  elasticity 500 kPa  damping 0.1  friction 0.3  drag 0.1
  }
}
object flag {
  shape sheet (0.4, 0.3) m thickness 4 mm bending 2  position (-0.6, 0, 0.5) m  orientation axis (1, 0, 0) angle 60 deg
  density 500  elasticity 500 kPa  hold face -x  resolution 4 cm
}
object crate { shape box (10, 10, 10) cm  position (0.25, 0, 0.06) m  density 300  elasticity 200 kPa  friction 0.4 }
object stone { shape sphere 6 cm  position (-0.3, 0, 0.07) m  density 300  elasticity rigid  friction 0.4 }
control { time 0.4 s }
"""

CASES = FORMS | THREADS | gone_on_after(4)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("sheets"), SCENE, CASES)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames and the state, with the anchors of friction."""
    alone, other = same_frames(found, way)
    assert alone.records == other.records and np.array_equal(alone.x, other.x)


def test_something_happens(found):
    """A cloth lies on the ball, and its sides hang down."""
    with Trajectory(found["sequential"]) as trajectory:
        first, last = trajectory.position(0), trajectory.position(len(trajectory) - 1)
        rows = trajectory.metadata.object_of == 1
    assert np.abs(last - first)[rows].max() > 0.1


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.soak), 2])
def test_lammps_alone_makes_the_same_frames(found, tmp_path, ranks):
    """The script that `build` writes, with its file of bodies."""
    lammps_makes_the_same(found, tmp_path, SCENE, ranks)
