# SPDX-License-Identifier: GPL-2.0-only
"""Threads of a run: whatever their number, the frames and the ledger are the same; where the number comes from."""

import os

import numpy as np
import pytest
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.engine.threads import THREADS, check_threads, threads_of_instance, with_threads
from mdanim_lammps.errors import UsageError

TEXT = """
gravity (0, 0, -9.81)
ground z 0
object a { shape box (20, 20, 20) cm position (0, 0, 11) cm density 1000 elasticity 0.2 MPa drag 0.3 damping 0.05 spin (1, 2, 0) }
object b { shape box (16, 16, 16) cm position (0.05, 0, 0.4) density 1000 elasticity 0.2 MPa friction 0.5 }
control { time 0.2 s frames 20 fps resolution 1.4 cm }
"""


@pytest.mark.parametrize("executors", [1, 2])
def test_a_run_does_not_depend_on_threads(tmp_path, executors):
    """Frames and ledger of three threads are those of one, in one process and on executors."""
    (tmp_path / "two.txt").write_text(TEXT)
    scene = Scene.load(tmp_path / "two.txt")
    one = scene.run(tmp_path / "one")
    more = scene.run(tmp_path / "more", executors=executors, threads=3)
    with Trajectory(tmp_path / "one") as a, Trajectory(tmp_path / "more") as b:
        assert len(a) == len(b) == 5
        for frame in range(5):
            assert np.array_equal(a.position(frame), b.position(frame)) and np.array_equal(a.velocity(frame), b.velocity(frame))
    if executors == 1:  # sums over objects of several instances have another order
        columns = {c for row in one.ledger.rows for c in row if "second" not in c}
        assert [{c: row[c] for c in columns} for row in one.ledger.rows] == [
            {c: row[c] for c in columns} for row in more.ledger.rows
        ]


def test_the_environment_tells_the_number(monkeypatch):
    """One where it says nothing; inside of with_threads what that says, and after it what was there before."""
    monkeypatch.delenv(THREADS, raising=False)
    assert threads_of_instance() == 1
    with with_threads(3):
        assert threads_of_instance() == 3
        with with_threads(None):
            assert threads_of_instance() == 3
    assert THREADS not in os.environ
    monkeypatch.setenv(THREADS, "2")
    with with_threads(5):
        assert os.environ[THREADS] == "5"
    assert threads_of_instance() == 2


@pytest.mark.parametrize("number", [0, -1, 33, "many", "1.5"])
def test_a_number_that_cannot_be_is_refused(number):
    """Tell what can be."""
    with pytest.raises(UsageError, match=f"a whole number from 1 to 32, not {number}"):
        check_threads(number)
