# SPDX-License-Identifier: GPL-2.0-only
"""How ranks are started, and what is said when they are lost."""

import io
import re
import shutil
import subprocess
import sys

import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import ExitCode, SetupError, UsageError
from mdanim_lammps.parallel import limits
from mdanim_lammps.parallel.runtime import launch
from scene_texts import FALL

ABORT_REPORT = """\
Abort(1) on node 0 (rank 0 in comm 0): application called MPI_Abort(MPI_COMM_WORLD, 1) - process 0
===================================================================================
=   BAD TERMINATION OF ONE OF YOUR APPLICATION PROCESSES
=   EXIT CODE: 9
===================================================================================
YOUR APPLICATION TERMINATED WITH THE EXIT STRING: Killed (signal 9)
"""


def test_without_mpiexec_it_says_where_one_comes_from(monkeypatch, tmp_path):
    """Neither beside this Python nor on the path; nothing is left in the folder."""
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.delenv(launch.MPIEXEC, raising=False)
    (tmp_path / "fall.txt").write_text(FALL)
    with pytest.raises(SetupError, match=r"no mpiexec; .*pip install mpich.*MDANIM_MPIEXEC"):
        Scene.load(tmp_path / "fall.txt").run(executors=2)
    assert not list((tmp_path / "fall.out").glob(".ranks-*"))
    assert SetupError("").exit_code == ExitCode.ENVIRONMENT


def test_the_environment_names_the_launcher(monkeypatch):
    """With its own options, split as a shell does."""
    monkeypatch.setenv(launch.MPIEXEC, "srun --mpi 'pmi 2'")
    assert launch.launcher() == ["srun", "--mpi", "pmi 2"]


@pytest.mark.parametrize(
    ("named", "told"),
    [
        pytest.param('"', "No closing quotation.*as a shell", id="an open quote"),
        pytest.param("/nonexistent", "/nonexistent cannot be started: No such file", id="no such program"),
        pytest.param("' '", "cannot be started", id="a blank"),
    ],
)
def test_a_launcher_that_cannot_start_is_told(monkeypatch, tmp_path, named, told):
    """The variable is named, with the exit code of an environment that is not right; nothing stays in the folder."""
    monkeypatch.setenv(launch.MPIEXEC, named)
    (tmp_path / "fall.txt").write_text(FALL)
    with pytest.raises(SetupError, match=f"MDANIM_MPIEXEC={named}: .*{told}|{told}"):
        Scene.load(tmp_path / "fall.txt").run(executors=2)
    assert not list((tmp_path / "fall.out").glob(".ranks-*"))


@pytest.mark.parametrize(
    ("count", "told"),
    [
        pytest.param("1.5", "1.5 is not a whole number", id="a part"),
        pytest.param("999", r"-n 999: this machine has \d+ cores, .* name other machines in MDANIM_MPIEXEC", id="too many"),
    ],
)
def test_a_number_of_executors_that_cannot_be(monkeypatch, tmp_path, count, told):
    """Refused before anything is modelled."""
    monkeypatch.delenv(launch.MPIEXEC, raising=False)
    (tmp_path / "fall.txt").write_text(FALL)
    done = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", str(tmp_path / "fall.txt"), "-n", count], capture_output=True, text=True
    )
    assert done.returncode == ExitCode.USAGE and re.search(told, done.stderr), done.stderr
    assert not (tmp_path / "fall.out").exists()


def test_executors_that_do_not_fit_in_memory(monkeypatch):
    """The number that fits is told; elsewhere there may be more."""
    monkeypatch.delenv(launch.MPIEXEC, raising=False)
    monkeypatch.setattr(limits, "available_memory", lambda: 1e9)
    limits.check_executors(4, 100_000)
    with pytest.raises(UsageError, match=r"executors=4: the processes need 2.7 GB, 1.0 GB are free; write executors=1 or"):
        limits.check_executors(4, 2_000_000)
    monkeypatch.setenv(launch.MPIEXEC, "mpiexec -f hosts")
    limits.check_executors(999, 2_000_000)


def test_what_ranks_say_is_passed_on_but_for_reports_of_an_abort(capsys):
    """A traceback of a rank is seen, mpiexec's own words are not."""
    said = []
    launch._hear(io.StringIO("ValueError: from a rank\n" + ABORT_REPORT), said)
    assert capsys.readouterr().err == "ValueError: from a rank\n" and len(said) == 7


@pytest.mark.parametrize(
    ("words", "checkpoint", "told"),
    [
        pytest.param(ABORT_REPORT, True, r"lost \(EXIT CODE: 9\).*go on with: mdanim-lammps resume", id="killed"),
        pytest.param(
            "RuntimeError: no\nMemoryError: too large\n",
            True,
            r"lost \(MemoryError: too large\)",
            id="the last error is the cause",
        ),
        pytest.param("", False, r"lost \(exit code 7\).*nothing was kept yet", id="without a word"),
    ],
)
def test_lost_ranks_are_told_in_one_message(tmp_path, words, checkpoint, told):
    """Why, and how to go on."""
    if checkpoint:
        (tmp_path / "checkpoint").touch()
    error = launch.lost(launch._cause(7, words.splitlines(keepends=True)), tmp_path)
    assert re.search(told, str(error)) and error.exit_code == ExitCode.ENVIRONMENT


@pytest.mark.parametrize("count", [0, -1])
def test_no_executor_is_too_few(tmp_path, count):
    """A usage error, from the command line and from Python."""
    (tmp_path / "fall.txt").write_text(FALL)
    done = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", str(tmp_path / "fall.txt"), "-n", str(count)], capture_output=True, text=True
    )
    assert done.returncode == ExitCode.USAGE and f"-n {count}: at least one executor" in done.stderr
    assert not (tmp_path / "fall.out").exists()
    with pytest.raises(UsageError, match="at least one"):
        Scene.load(tmp_path / "fall.txt").run(executors=count)


def test_an_error_of_ranks_keeps_what_it_holds(capsys):
    """Problems with their places, the cost of a run that was stopped: it is told as one process tells it."""
    import base64
    import pickle

    from mdanim_lammps.errors import Problem, SceneError, Span
    from mdanim_lammps.parallel.runtime.ranks import _hand_over
    from mdanim_lammps.run.loop import Interrupted

    stopped = Interrupted("at t = 1 s")
    stopped.cost = {"wall": 1.0}
    for error in (SceneError([Problem(Span("a.txt", 3, 4), "wrong")]), stopped):
        _hand_over(error)
        told = pickle.loads(base64.b64decode(capsys.readouterr().out.removeprefix(launch.RESULT_SIGN)))
        assert type(told) is type(error) and str(told) == str(error) and vars(told) == vars(error)
