# SPDX-License-Identifier: GPL-2.0-only
"""Layers on layers give the same bits in all forms of the distribution, and by plain `lmp`."""

import numpy as np
import pytest
from distribution_lab import FORMS, SEQUENTIAL, THREADS, forms_in, gone_on_after, lammps_makes_the_same, matrix, same_frames
from mdanim_lammps.results.trajectory import Trajectory

pytestmark = pytest.mark.mpi

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object lower {
  shape sheet (0.4, 0.4) m thickness 4 mm  position (0, 0, 0.02) m  resolution 4 cm
  density 500  elasticity 500 kPa  damping 0.1  friction 0.3  touches-itself yes
}
object upper {
  shape sheet (0.4, 0.3) m thickness 4 mm  position (0.05, 0.02, 0.05) m  resolution 4 cm  velocity (0.5, 0, 0) m/s
  density 500  elasticity 500 kPa  damping 0.1  friction 0.3
}
object cord {
  shape rope from (-0.2, 0.05, 0.09) m to (0.2, 0.02, 0.1) m thickness 2 cm  density 500  elasticity 200 kPa
  damping 0.1  friction 0.3  touches-itself yes
}
object crate { shape box (10, 10, 10) cm  position (0.8, 0, 0.06) m  density 300  elasticity 200 kPa  friction 0.4 }
control { time 0.3 s }
"""

CASES = FORMS | THREADS | gone_on_after(4)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("folds"), SCENE, CASES)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames and the state, with the forces of friction."""
    alone, other = same_frames(found, way)
    assert alone.records == other.records and np.array_equal(alone.x, other.x)


def test_something_happens(found):
    """The upper sheet lies on the lower one and has lost speed by friction."""
    with Trajectory(found["sequential"]) as trajectory:
        last, rows = trajectory.position(len(trajectory) - 1), trajectory.metadata.object_of
    assert last[rows == 1, 2].mean() > last[rows == 0, 2].mean() + 0.004
    assert last[rows == 1, 0].mean() < 0.05 + 0.5 * 0.3 - 0.02


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.soak), 2])
def test_lammps_alone_makes_the_same_frames(found, tmp_path, ranks):
    """The script that `build` writes, with its table of layers."""
    lammps_makes_the_same(found, tmp_path, SCENE, ranks)


TORN = """
gravity (0, 0, -9.81) m/s^2
object lower {
  shape sheet (0.4, 0.3) m thickness 4 mm  position (0, 0, 0) m  resolution 4 cm
  density 500  elasticity 500 kPa  damping 0.1  friction 0.3  touches-itself yes  hold faces x  tear-strain 0.03
}
object upper {
  shape sheet (0.2, 0.2) m thickness 4 mm  position (0.01, 0.02, 0.02) m  resolution 4 cm  velocity (0, 0, -4) m/s
  density 2000  elasticity 500 kPa  damping 0.1  friction 0.3
}
control { time 0.12 s  frames 50 fps }
"""


@pytest.fixture(scope="module")
def torn(tmp_path_factory):
    """The same of a sheet that tears under another one."""
    return forms_in(tmp_path_factory.mktemp("torn"), TORN, TORN_CASES)


TORN_CASES = matrix((2,), ["central"], rotate=True) | {
    "stopped": SEQUENTIAL | {"stop": 4},
    "gone on with": {"executors": 2, "control": "peers", "resume": True, "in": "stopped"},
}


@pytest.mark.parametrize("way", TORN_CASES)
def test_layers_that_tear_give_the_same(torn, way):
    """Some links are gone before the run is stopped, others later, and the other sheet lies on them."""
    alone, other = same_frames(torn, way)
    assert np.array_equal(alone.x, other.x)


def test_it_tears(torn):
    """Some links before the run is stopped, others later; the other sheet is on it."""
    with Trajectory(torn["sequential"]) as trajectory:
        gone = [len(trajectory.gone(frame)) for frame in range(len(trajectory))]
    assert gone[0] == 0 and 0 < gone[3] < gone[-1]
