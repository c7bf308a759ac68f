# SPDX-License-Identifier: GPL-2.0-only
"""Objects that break give the same bits in all forms of the distribution, gone on with, and by plain `lmp`."""

import numpy as np
import pytest
from distribution_lab import FORMS, film_of, film_of_lammps, forms_in, gone_on_after, lammps_makes_the_same, readied, same_frames
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.loop import simulate

pytestmark = pytest.mark.mpi

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
repeat i in 1 .. 2 {
  object plate[i] {
    shape box (30, 30, 4) cm  position (0.5*i, 0, 0.2*i) m  orientation axis (1, 0.3, 0) angle 20 deg
    density 2500  elasticity rigid  friction 0.4  pieces 8  strength 5 MPa
  }
}
object stone { shape box (10, 10, 10) cm  position (1, 0, 0.7) m  velocity (0, 0, -3) m/s
  density 2500  elasticity rigid  friction 0.4 }
object ball { shape sphere 5 cm  position (-1, 0, 0.1) m  velocity (1, 0, 0) m/s  density 300  elasticity rigid  friction 0.4 }
control { time 0.3 s }
expect plate.pieces > 2
"""

CASES = FORMS | gone_on_after(6)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("pieces"), SCENE, CASES)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames, with what hangs together in each, the state, and the energy that is lost but for rounding."""
    alone, other = same_frames(found, way)
    assert alone.records == other.records and np.array_equal(alone.x, other.x)
    torn = [Ledger.read(found[name] / "ledger.csv").array("torn") for name in ("sequential", way)]
    assert torn[0][-1] > 0.0 and torn[1] == pytest.approx(torn[0], rel=1e-9, abs=1e-12)


def test_plates_break(found):
    """One before the run was stopped, one after."""
    with Trajectory(found["sequential"]) as trajectory:
        parts = [len(set(trajectory.field("whole", frame).tolist())) for frame in range(len(trajectory))]
    assert parts[0] == 3 and 3 < parts[6] < parts[-1]


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.soak), 2])
def test_lammps_alone_makes_the_same_frames(found, tmp_path, ranks):
    """The script that `build` writes."""
    lammps_makes_the_same(found, tmp_path, SCENE, ranks)


MOVING = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object pot { shape box (10, 10, 10) cm  position (0, 1.8, 0.12) m  velocity (4, 0, -4) m/s  spin (3, -2, 5) rad/s
  density 2500  elasticity rigid  pieces 6  strength 30 kPa }
object ball { shape sphere 3 cm  position (0, 0, 0.64) m  velocity (3, 0, -5) m/s  density 3000  elasticity rigid }
control { time 0.05 s }
"""


def test_lammps_alone_makes_the_same_frames_of_glued_bodies_that_move(tmp_path):
    """Glue changes velocities by roundings as it joins them: the next run must not take this for a change made from outside."""
    ready, folder = readied(tmp_path, MOVING)
    (tmp_path / "whole").mkdir()
    simulate(ready, tmp_path / "whole")
    film = film_of(tmp_path / "whole")
    assert np.array_equal(film_of_lammps(folder, film.shape[1], ranks=1), film)
