# SPDX-License-Identifier: GPL-2.0-only
"""Joints give the same bits in all forms of the distribution: executors, teams of ranks, resumed runs, kills, plain LAMMPS."""

import numpy as np
import pytest
from distribution_lab import RESUMED, TEAMS, WINDOWS, film_of, film_of_lammps, forms_in, matrix, readied, same_file, same_frames
from mdanim_lammps.results.trajectory import Trajectory

pytestmark = pytest.mark.mpi

SCENE = """gravity (0, 0, -9.81) m/s^2
ground z 0
let hard = { density 2000 kg/m^3 elasticity rigid }
repeat k in 0 .. 2 {
  repeat i in 1 .. 3 {
    object link[10*k + i] { use hard shape box (8, 5, 5) cm position (0.1*(i - 0.5), 0.6*k, 1) m }
  }
  joint ball link[10*k + 1] world { at (0, 0.6*k, 1) m }
  repeat i in 1 .. 2 { joint hinge link[10*k + i + 1] link[10*k + i] { at (0.1*i, 0.6*k, 1) m axis (0, 1, 0) friction 0.01 N*m } }
}
object post { shape box (10, 10, 40) cm position (1, 0, 0.2) m density 1000 elasticity rigid hold all }
object arm { shape box (40, 6, 6) cm position (1.2, 0, 0.6) m density 800 elasticity 2 MPa resolution 3 cm }
joint hinge arm post { at (1.02, 0, 0.6) m axis (0, 1, 0) limits -20 deg to 60 deg }
object wheel { use hard shape sphere 10 cm position (2, 0, 0.5) m }
joint hinge wheel world { axis (0, 1, 0) motor speed 120 rpm torque 0.5 N*m }
object load { use hard shape sphere 5 cm position (2, 0, 0.2) m }
joint spring load wheel { stiffness 500 N/m length 20 cm damping 1 N*s/m }
object head { use hard shape box (6, 12, 6) cm position (4, 0, 0.3) m spin (0, 3, 1) rad/s }
object drop { use hard shape sphere 5 cm position (3, 0, 1) m }
joint ball drop world { at (3, 0, 1.04) m breaks 30 N }
object hung { use hard shape sphere 8 cm position (3, 0, 0.8) m }
joint spring hung drop { length 2 cm stiffness 200 N/m }
object grip { use hard shape cylinder 1.5 cm 20 cm position (4, 0, 0.42) m spin (0, 3, 1) rad/s velocity (0.36, 0, 0) m/s }
joint weld grip head { at (4, 0, 0.33) m }
expect wheel.joint.angle(world) = 0 rad +- 100 rad
control { time 0.4 s frames 25 fps friction 0.3 accuracy preview }
"""

# Others are between what is welded together, head and grip.
CASES = (
    matrix((2,), ["central"], name="all move ", rotate=True)
    | matrix((3,), ["peers"], name="again ", settings=WINDOWS | {"safety": 0.2})
    | TEAMS
    | RESUMED
)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("joints"), SCENE, CASES, timeout=200.0)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames with all rows of joints, and the state with records of patches, angles, anchors and what has broken."""
    alone, other = same_frames(found, way)
    assert np.array_equal(alone.x, other.x) and np.array_equal(alone.v, other.v)
    assert "joints" in alone.records and alone.records == other.records
    assert other.carried["work"] == pytest.approx(alone.carried["work"], rel=1e-9)
    assert other.carried["joint_heat"] == pytest.approx(alone.carried["joint_heat"], rel=1e-9)


def test_files_are_the_same_to_the_byte(found):
    """Whole trajectories with their checksums."""
    same_file(found["sequential"], found["all move central2"])


def test_frames_have_a_row_for_each_joint(found):
    """In the order of objects; one has broken on the way."""
    with Trajectory(found["again peers3"]) as trajectory:
        first, last = (trajectory.field("joint", n)["value"] for n in (0, len(trajectory) - 1))
    assert sorted(first[:, 0].tolist()) == list(range(len(first))) and len(first) == 15
    assert np.array_equal(first[:, 0], last[:, 0])
    assert first[:, 8].sum() == 0 and last[:, 8].sum() == 1


def test_plain_lammps_gives_the_same(found, tmp_path):
    """The script of the scene for two frames, with two ranks."""
    ready, folder = readied(tmp_path, SCENE)
    script = folder / "in.film"
    text, steps = script.read_text().split("\nrun ")
    script.write_text(f"{text}\nrun {2 * ready.certificate.steps_per_frame}\n")
    assert int(steps) == ready.certificate.steps
    film = film_of(found["sequential"])[:3]
    assert np.array_equal(film_of_lammps(folder, film.shape[1]), film)
