# SPDX-License-Identifier: GPL-2.0-only
"""The distributed program against the sequential one: the same film to the last bit, however objects are dealt out."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import plugin_path
import pytest
from mpi import scenes as films

from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.cost import Cost
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.timeline import KINDS, Timeline

pytestmark = pytest.mark.mpi
MATRIX = Path(__file__).parent / "matrix.py"
TIMES = ("seconds", "carried")
SEQUENTIAL = {"control": None, "executors": 1}
BOTH = ("central", "peers")
WINDOWS = {"worth": 0, "finest": 8}
"""Windows shorter than a frame wherever loads are not in balance."""


def ways(scene: Path, cases: dict[str, dict], ranks: int = 5, timeout: float = 240.0) -> dict[str, Path]:
    """Run a scene in all of these ways, the sequential one first; returns the folder of each."""
    folder = scene.parent
    cases = {"sequential": SEQUENTIAL} | cases
    work = [{"folder": str(folder / case.get("in", name)), **case} for name, case in cases.items()]
    (folder / "cases.json").write_text(json.dumps({"scene": str(scene), "cases": work}))
    done = subprocess.run(
        [plugin_path.BIN / "mpiexec", "-n", str(ranks), sys.executable, "-m", "mpi4py", MATRIX, folder / "cases.json"],
        capture_output=True, text=True, timeout=timeout, env={**plugin_path.environment(), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))})
    assert done.returncode == 0, done.stdout + done.stderr
    return {name: folder / case.get("in", name) for name, case in cases.items()}


def matrix(executors=(1, 2, 3, 4), controls=BOTH, name="", **more) -> dict[str, dict]:
    """Cases for every number of executors under each control."""
    return {f"{name}{control}{k}": {"executors": k, "control": control, **more} for control in controls for k in executors}


def same(alone: Path, together: Path) -> None:
    """All frames to the last bit; energies and all that is measured but for rounding."""
    assert compare(alone, together).equal
    one, two = (Ledger.read(f / "ledger.csv") for f in (alone, together))
    assert (one.terms, one.extras) == (two.terms, two.extras)
    scale = max(np.abs(one.array(t)).max() for t in one.terms)
    for column in one.columns:
        # What dashpots take is summed in another order where a bundle begins anew, and known to second order only there.
        rough = column in ("damping_loss", "residual")
        np.testing.assert_allclose(two.array(column), one.array(column), rtol=2e-3 if rough else 1e-9,
                                   atol=(1e-4 if column == "residual" else 1e-5 * scale if rough else 1e-12 * scale), err_msg=column)
    first, second = (json.loads((f / "summary.json").read_text()) for f in (alone, together))
    for summary in (first, second):
        del summary["seconds"], summary["energy_residual"]
    found = [[e.pop("found") for e in summary["expect"]] for summary in (first, second)]
    np.testing.assert_allclose(*found, rtol=1e-9, atol=1e-4)
    assert first.pop("penetration") == pytest.approx(second.pop("penetration"), rel=1e-12)
    assert first == second


def checked(folder: Path, executors: int) -> Timeline:
    """The timeline of a finished run, found whole; nothing else is left over."""
    timeline = Timeline.read(folder)
    frames = json.loads((folder / "summary.json").read_text())["frames"]
    assert timeline.executors == executors and timeline.frames == list(range(frames))
    assert {kind for _, kind, *_ in timeline.spans} <= set(KINDS)
    assert {e for e, *_ in timeline.spans} == set(range(executors))
    assert all(begin <= end for *_, begin, end in timeline.spans)
    assert not [p for p in folder.iterdir() if p.name.startswith(".") or p.name == "stop"]
    return timeline


@pytest.fixture
def scene(tmp_path):
    """Write a scene file."""
    def write(text: str) -> Path:
        path = tmp_path / "scene.txt"
        path.write_text(text)
        return path
    return write


FILMS = {
    "mixed": (films.MIXED, matrix()),
    "rafts": (films.RAFTS, matrix()),
    "passing": (films.PASSING, matrix((3,), ["central"])),
    "dam": (films.DAM, matrix((2,))),
    "alone": (films.ALONE, matrix((1, 4), ["peers"]) | matrix((3,), ["central"])),
    "resting": (films.RESTING, matrix((2,))),
    "hasty": (films.HASTY, matrix((1, 3))),
    "uneven": (films.UNEVEN, matrix((2,)) | matrix((3,), name="windows ", settings=WINDOWS)),
}


@pytest.mark.parametrize("name", FILMS)
def test_every_frame_is_that_of_the_sequential_program(scene, name):
    """One to four executors under either control give the film of the sequential program, and all that is told of it."""
    text, cases = FILMS[name]
    all_the_same(ways(scene(text), cases), cases)


def all_the_same(found: dict[str, Path], cases: dict[str, dict]) -> dict[str, Timeline]:
    """Every way against the sequential program; returns their timelines."""
    timelines = {}
    for way, case in cases.items():
        same(found["sequential"], found[way])
        timelines[way] = checked(found[way], case["executors"])
        assert timelines[way].control == case["control"]
    return timelines


def test_objects_that_fly_about_change_their_executors(scene):
    """At least 30 migrations, also where reserved boxes are too small at first and where windows are shorter than a frame."""
    cases = (matrix((2, 4), name="plain ") | matrix((3,), name="again ", settings={"safety": 0.3}) |
             matrix((3,), name="windows ", settings=WINDOWS) | matrix((3,), ["peers"], "both ", settings=WINDOWS | {"safety": 0.3}))
    timelines = all_the_same(ways(scene(films.FLYING), cases), cases)
    for way, timeline in timelines.items():
        print(way, sum(timeline.moves), sum(timeline.retries))


@pytest.mark.parametrize(("text", "team"), [
    pytest.param(films.HEAVY, "block", id="solid"), pytest.param(films.RAFTS, "", id="liquid"), pytest.param(films.FLYING, "", id="islands"),
])
def test_a_team_runs_what_is_too_heavy_for_one(scene, text, team):
    """Several executors run one island together."""
    cases = matrix((2, 3), settings={"least": 50}) | matrix((3,), ["peers"], "windows ", settings=WINDOWS | {"least": 50, "safety": 0.5})
    timelines = all_the_same(ways(scene(text), cases), cases)
    for way, timeline in timelines.items():
        print(way, sum(timeline.moves), sum(timeline.retries), [max(r, default=0) for r in [timeline.retries]])
