# SPDX-License-Identifier: GPL-2.0-only
"""A feature with all that one may have, tests/lab/features/whole, gives the same bits in all forms of the distribution."""

import numpy as np
import pytest
import whole
from distribution_lab import SEQUENTIAL, WINDOWS, matrix, ways
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare

pytestmark = pytest.mark.mpi

CASES = (
    matrix((2, 3), name="all move ", rotate=True)
    | matrix((3,), ["central"], name="again ", settings=WINDOWS | {"safety": 0.2})
    | matrix((2,), ["peers"], name="teams ", settings={"least": 30, "by_threads": False})
    | matrix((2,), ["central"], name="threads ", settings={"least": 30, "by_threads": True})
    | {
        "stopped": {"executors": 3, "control": "central", "stop": 3},
        "stopped and gone on with": {"executors": 2, "control": "peers", "resume": True, "in": "stopped"},
        "alone": SEQUENTIAL | {"stop": 4},
        "alone and gone on with": {"executors": 4, "control": "central", "resume": True, "in": "alone"},
    }
)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    path = tmp_path_factory.mktemp("whole") / "scene.txt"
    path.write_text(whole.REMEMBERING)
    return ways(path, CASES, timeout=200.0, features="whole")


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames, the state with all columns and records, and the sum of the work but for rounding."""
    assert compare(found["sequential"], found[way]).equal
    alone, other = (Checkpoint.read(found[name] / "checkpoint") for name in ("sequential", way))
    for name in "xvf":
        assert np.array_equal(getattr(alone, name), getattr(other, name)), name
    assert alone.records.keys() == {"contact", "rig", "column way", "column most", "column turns"}
    assert alone.records == other.records
    assert other.carried["work"] == pytest.approx(alone.carried["work"], rel=1e-9)
