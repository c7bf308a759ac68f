# SPDX-License-Identifier: GPL-2.0-only
"""One scene run in many ways, sequential and on executors, in one start of MPI."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import plugin_library
import plugin_path
import pytest
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.dump import read_dump
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.loop import write_inputs
from mdanim_lammps.run.prepare import Prepared, prepare
from mdanim_lammps.scene.parse import load_scene
from paths import LAB, MPI
from ranks_lab import on_ranks

MATRIX = MPI / "matrix.py"


SEQUENTIAL = {"control": None, "executors": 1}


BOTH = ("central", "peers")


WINDOWS = {"worth": 0, "finest": 8}
"""Windows shorter than a frame wherever loads are not in balance."""


def ways(scene: Path, cases: dict[str, dict], ranks: int = 5, timeout: float = 60.0, *, features: str = "") -> dict[str, Path]:
    """Run a scene in all of these ways, the sequential one first; returns the folder of each. ``features``: a folder of
    tests/lab/features whose features there are, too."""
    folder = scene.parent
    cases = {"sequential": SEQUENTIAL} | cases
    work = [{"folder": str(folder / case.get("in", name)), **case} for name, case in cases.items()]
    (folder / "cases.json").write_text(json.dumps({"scene": str(scene), "cases": work}))
    more = of_features(features) if features else {}
    on_ranks(MATRIX, ranks, folder / "cases.json", timeout, timeout=timeout, more=more)
    return {name: folder / case.get("in", name) for name, case in cases.items()}


def forms_in(folder: Path, text: str, cases: dict[str, dict], timeout: float = 120.0, **more) -> dict[str, Path]:
    """The folder of each form of a scene, all made in one start of MPI."""
    path = folder / "scene.txt"
    path.write_text(text)
    return ways(path, cases, timeout=timeout, **more)


def of_features(folder: str) -> dict[str, str]:
    """Variables with which a program finds the features of a folder of tests/lab/features, and the styles of the tests."""
    styles = os.pathsep.join([plugin_path.folder(), str(plugin_library.build().parent)])
    return {"MDANIM_FEATURES": str(LAB / "features" / folder), "LAMMPS_PLUGIN_PATH": styles}


EXACT = ("time", "gravity", "liquid_cells", "strain.", "draft.", "immersed.")
"""Columns of the ledger that no sum over executors is in: their bits are those of the sequential program."""
MEASURED = "".join(f"expect {what} = 0 +- 10\n" for what in ("raft.draft", "above.draft", "stone.immersed", "buoy.strain.max"))
"""Measured of objects of the scene POOL."""


def same_file(one: Path, other: Path) -> None:
    """Every byte of the trajectory, its checksums among them, and what the ledger tells of single objects."""
    assert (one / "trajectory.h5").read_bytes() == (other / "trajectory.h5").read_bytes()
    ledgers = [Ledger.read(folder / "ledger.csv") for folder in (one, other)]
    for column in ledgers[0].columns:
        if column.startswith(EXACT):
            assert ledgers[0].array(column).tobytes() == ledgers[1].array(column).tobytes(), column


def same_frames(found: dict[str, Path], way: str) -> tuple[Checkpoint, Checkpoint]:
    """The last states of the sequential run and of another form, whose frames are asserted to be the same."""
    assert compare(found["sequential"], found[way]).equal
    return Checkpoint.read(found["sequential"] / "checkpoint"), Checkpoint.read(found[way] / "checkpoint")


def readied(place: Path, text: str) -> tuple[Prepared, Path]:
    """A scene that is ready to run, and its output folder with all that LAMMPS reads."""
    (place / "film.txt").write_text(text)
    (place / "film.out").mkdir()
    ready = prepare(load_scene(place / "film.txt"))
    write_inputs(ready, place / "film.out")
    return ready, place / "film.out"


def film_of_lammps(folder: Path, particles: int, *, name: str = "film", ranks: int = 2, more: dict | None = None) -> np.ndarray:
    """Positions [m] in the frames that plain `lmp` makes on ranks by the script of a folder, in.NAME, shape (F, N, 3)."""
    command = [plugin_path.BIN / "mpiexec", "-n", str(ranks), plugin_path.BIN / "lmp", "-in", f"in.{name}"]
    env = plugin_path.environment() | (more or {})
    done = subprocess.run([*command, "-log", "none", "-nocite"], cwd=folder, env=env, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return np.array([x for _, x, _ in read_dump(folder / f"{name}.lammpstrj", particles)])


def film_of(folder: Path) -> np.ndarray:
    """Positions [m] in the frames of an output folder, shape (F, N, 3)."""
    with Trajectory(folder) as trajectory:
        return np.array([trajectory.position(n) for n in range(len(trajectory))])


def lammps_makes_the_same(found: dict[str, Path], place: Path, text: str, ranks: int = 2) -> None:
    """Plain `lmp` makes the frames of the sequential run by the script and the data that `build` writes."""
    _, folder = readied(place, text)
    film = film_of(found["sequential"])
    assert np.array_equal(film_of_lammps(folder, film.shape[1], ranks=ranks), film)


def matrix(executors=(1, 2, 3, 4), controls=BOTH, name="", **more) -> dict[str, dict]:
    """Cases for every number of executors under each control."""
    return {f"{name}{control}{k}": {"executors": k, "control": control, **more} for control in controls for k in executors}


TEAMS = matrix((2,), ["peers"], name="teams ", settings={"least": 30, "by_threads": False})
"""Ranks share the particles of an object."""
THREADS = matrix((2,), ["central"], name="threads ", settings={"least": 30, "by_threads": True})
"""Threads share them."""
FORMS = matrix((2,), ["central"], name="all move ", rotate=True) | matrix((3,), ["peers"]) | TEAMS
"""Executors between which all objects move at each frame, executors that agree among themselves, and teams of ranks."""
RESUMED = {
    "stopped": {"executors": 3, "control": "central", "stop": 3},
    "stopped and gone on with": {"executors": 2, "control": "peers", "resume": True, "in": "stopped"},
    "alone": SEQUENTIAL | {"stop": 4},
    "alone and gone on with": {"executors": 4, "control": "central", "resume": True, "in": "alone"},
}
"""Runs that are stopped, and go on with other executors."""


def gone_on_after(frames: int) -> dict[str, dict]:
    """A run of one process that is stopped after so many frames, and goes on with two executors."""
    return {
        "stopped": SEQUENTIAL | {"stop": frames},
        "stopped and gone on with": {"executors": 2, "control": "central", "resume": True, "in": "stopped"},
    }


@pytest.fixture
def scene(tmp_path):
    """Write a scene file."""

    def write(text: str) -> Path:
        path = tmp_path / "scene.txt"
        path.write_text(text)
        return path

    return write
