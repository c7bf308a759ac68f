# SPDX-License-Identifier: GPL-2.0-only
"""How distributed runs end before their time: killed, stopped, diverged, out of disk; nothing stays behind."""

import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import plugin_path
import pytest
from distribution_lab import readied
from mdanim_lammps.errors import ExecutorLost, OutputError
from mdanim_lammps.parallel.plan.frame_plan import PlannerOptions
from mdanim_lammps.parallel.runtime import launch
from mdanim_lammps.parallel.runtime.launch import simulate_on
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.timeline import Timeline
from mdanim_lammps.results.trajectory import Trajectory
from mpi import scenes as films
from ranks_lab import command, environment, ranks_in

pytestmark = pytest.mark.mpi
EITHER = pytest.mark.parametrize("control", ["central", pytest.param("peers", marks=pytest.mark.soak)])
"""Ends that are of the ranks, not of what they say to each other."""
WHOLE = "time 1000 s"  # longer than any test waits
LONG = films.FLYING.split("expect")[0].replace("time 0.2 s", WHOLE)
EAGER = """
import os, time
from mdanim_lammps.run import loop
loop.CHECKPOINT_SECONDS, check = 0.0, loop.Guard.check
def late(guard, *seen):
    time.sleep(0.03)
    return check(guard, *seen)
loop.Guard.check = late
if os.environ.get("PMI_RANK") == "0":
    from mdanim_lammps.parallel.runtime import supervisor
    supervisor.KEEP_SECONDS = 0.0
"""
"""The sitecustomize.py of runs: frames that take a while, as those of a larger scene, and a checkpoint after each."""


@pytest.fixture
def place(tmp_path):
    """A folder of a test; at its end no rank may run in it, and nothing but results lie there."""
    (tmp_path / "sitecustomize.py").write_text(EAGER)
    yield tmp_path
    deadline = time.monotonic() + 5.0
    while (left := ranks_in(tmp_path)) and time.monotonic() < deadline:
        time.sleep(0.05)
    for process in left:
        os.kill(process, signal.SIGKILL)
    assert not left, "ranks were left behind"
    assert not list(tmp_path.rglob(".ranks-*")) and not list(tmp_path.rglob("stop"))


def begun(place: Path, text: str, *arguments: object, frames: int = 3) -> subprocess.Popen:
    """A run from the command line that has got so far; its processes begin with the folder's sitecustomize.py."""
    (place / "film.txt").write_text(text)
    process = subprocess.Popen(
        command(place / "film.txt", "--no-movie", *arguments),
        env=environment(place),
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    ledger = place / "film.out" / "checkpoint"
    deadline = time.monotonic() + 30.0
    while not ledger.exists() and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.3)
    return process


def ended(process: subprocess.Popen, seconds: float) -> tuple[int, str]:
    """Exit code and what was said, within so many seconds."""
    try:
        _, said = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        raise
    return process.returncode, said


def written(folder: Path) -> int:
    """Frames that a film has by now; none where it is just being made."""
    try:
        with Trajectory(folder) as film:
            return len(film)
    except OutputError:
        return 0


def goes_on(place: Path, frame: int, *arguments: object) -> None:
    """Resume up to some frames later, and compare with the sequential film from the start."""
    folder = place / "film.out"
    frame = max(frame, 1, written(folder))  # a film of one frame has no time
    process = subprocess.Popen(
        command("resume", folder, "--no-movie", *arguments),
        env=environment(place),
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    deadline = time.monotonic() + 30.0
    while (frames := written(folder)) <= frame and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    code, said = ended(process, 20.0)
    assert code == 130, said
    frames = written(folder)
    assert frames > frame
    (place / "whole.txt").write_text((place / "film.txt").read_text().replace(WHOLE, f"time {(frames - 1) / 100:g} s"))
    subprocess.run(command(place / "whole.txt", "--no-movie", "-q"), env=environment(), check=True)
    assert compare(place / "whole.out", folder).equal


@pytest.mark.parametrize(
    ("control", "victim"), [("central", 2), pytest.param("peers", 1, marks=pytest.mark.soak), ("central", 0)]
)
def test_a_killed_rank_ends_the_run_within_seconds(place, control, victim):
    """One message, how to go on, and it does so; all other ranks end too."""
    process = begun(place, LONG, "-n", 2, "--control", control)
    ranks = ranks_in(place)
    assert sorted(ranks.values()) == [-1, 0, 1, 2]
    os.kill(next(p for p, rank in ranks.items() if rank == victim), signal.SIGKILL)
    code, said = ended(process, 8.0)
    assert code == 5 and said.count("error:") == 1, said
    assert "executor was lost" in said and f"mdanim-lammps resume {place / 'film.out'}" in said and "Traceback" not in said
    if victim == 2:
        goes_on(place, 0, "-n", 3)


def test_a_killed_launcher_ends_all_ranks(place):
    """The process by which mpiexec starts ranks: without it they would go on, or hang, unseen; what is told is true."""
    process = begun(place, LONG, "-n", 2)
    rank = next(p for p, number in ranks_in(place).items() if number == 1)
    proxy = int(Path(f"/proc/{rank}/stat").read_text().rsplit(")", 1)[1].split()[1])
    assert "hydra" in Path(f"/proc/{proxy}/cmdline").read_text()
    os.kill(proxy, signal.SIGKILL)
    code, said = ended(process, 20.0)
    assert code == 5 and "all others were stopped" in said and f"mdanim-lammps resume {place / 'film.out'}" in said, said
    assert 0 < Checkpoint.read(place / "film.out" / "checkpoint").frame < written(place / "film.out")


def test_a_run_that_is_complete_is_told_as_such(tmp_path):
    """Where its launcher was lost at the end."""
    (tmp_path / "checkpoint").touch()
    (tmp_path / "summary.json").touch()
    assert re.search(r"run is complete; draw it with: mdanim-lammps render", str(launch.lost("exit code 255", tmp_path)))


@pytest.mark.parametrize("control", ["central", "peers"])
def test_ctrl_c_keeps_a_checkpoint(place, control):
    """End with 130 after the frames that were under way, and go on in the sequential program, or with executors:
    the log has both."""
    process = begun(place, LONG, "-n", 2, "--control", control)
    process.send_signal(signal.SIGINT)
    code, said = ended(process, 10.0)
    assert code == 130 and "mdanim-lammps resume" in said and "Traceback" not in said, said
    with Trajectory(place / "film.out") as film:
        frames = len(film)
    goes_on(place, frames, *(("-n", 2) if control == "central" else ()))
    log = Timeline.read(place / "film.out").frames
    assert log == list(range(len(log))) and (len(log) > frames if control == "central" else len(log) == frames)


def test_ctrl_c_before_the_first_frame_is_not_forgotten(place):
    """Ask for an end while ranks are starting: the run takes it up as soon as it can."""
    (place / "film.txt").write_text(LONG)
    process = subprocess.Popen(
        command(place / "film.txt", "--no-movie", "-n", 2),
        env=environment(),
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    deadline = time.monotonic() + 20.0
    while not ranks_in(place) and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    code, said = ended(process, 60.0)
    assert code == 130, said


def test_ctrl_c_twice_ends_at_once(place):
    """The second one does not wait for the frame."""
    process = begun(place, LONG, "-n", 2)
    for _ in range(2):
        process.send_signal(signal.SIGINT)
    code, said = ended(process, 5.0)
    assert code in (5, 130) and "Traceback" not in said, said


@EITHER
def test_a_run_that_diverges_names_the_object(place, control):
    """The guard's message, once; the last good frame is kept."""
    text = films.MIXED.replace("frames 100 fps", "frames 100 fps  timestep 2 ms").replace("time 0.12 s", "time 1 s")
    process = begun(place, text, "-n", 2, "--control", control, "--allow-unstable")
    code, said = ended(process, 60.0)
    assert code == 6, said
    assert re.search(r"step \d+, t = .* s: (ball|plate|falling|feather|sheet|shelf|onto|skimming): ", said), said
    assert said.count("cause:") == 1 and "last good frame" in said and "Traceback" not in said


FAULT = """
import os
if os.environ.get("PMI_RANK") == "{rank}":
    from mdanim_lammps.{module} import {kind}
    whole, times = {kind}.{method}, []
    def fail(self, *arguments):
        times.append(1)
        if len(times) == {time}:
            {what}
        return whole(self, *arguments)
    {kind}.{method} = fail
"""


def faulty(place: Path, monkeypatch, rank: int, module: str, method: str, time: int, what: str) -> None:
    """Make a ``KIND.METHOD`` of a rank fail at one of its calls, in all runs to come."""
    kind, method = method.split(".")
    fault = FAULT.format(rank=rank, module=module, kind=kind, method=method, time=time, what=what)
    (place / "sitecustomize.py").write_text(fault)
    monkeypatch.setenv("PYTHONPATH", environment(place)["PYTHONPATH"])


@EITHER
def test_a_full_disk_ends_all_ranks(place, monkeypatch, control):
    """The error of the writer comes up here, whole."""
    ready, folder = readied(place, LONG)
    faulty(
        place,
        monkeypatch,
        0,
        "results.trajectory_writer",
        "TrajectoryWriter.add",
        3,
        "from mdanim_lammps.errors import OutputError; raise OutputError('no room: make room and resume')",
    )
    with pytest.raises(OutputError, match="no room"):
        simulate_on(2, control, ready, folder)


@pytest.mark.parametrize(
    ("settings", "text"),
    [pytest.param({}, LONG, id="alone"), pytest.param({"least": 50, "by_threads": False}, films.HEAVY, id="in a team")],
)
def test_an_executor_that_raises_is_told(place, monkeypatch, capfd, settings, text):
    """Whatever it is, it comes up here, and others that wait for it in LAMMPS are ended."""
    ready, folder = readied(place, text)
    faulty(place, monkeypatch, 2, "parallel.runtime.bundle", "Bundle.run", 3, "raise ValueError('out of the blue')")
    begin = time.monotonic()
    with pytest.raises(ExecutorLost, match="executor 1: ValueError: out of the blue"):
        simulate_on(2, "peers", ready, folder, settings=PlannerOptions(**settings))
    assert time.monotonic() - begin < 60.0
    assert "out of the blue" in capfd.readouterr().err


@pytest.mark.parametrize("heard", [True, False])
def test_a_planner_that_raises_is_told(place, monkeypatch, heard):
    """Under central control it runs beside the supervisor's own work; also where nothing that is said on stderr arrives."""
    ready, folder = readied(place, LONG)
    if not heard:
        monkeypatch.setenv("MDANIM_MPIEXEC", f"sh -c '{plugin_path.BIN / 'mpiexec'} \"$@\" 2>/dev/null' sh")
    faulty(place, monkeypatch, 0, "parallel.plan.planner", "Planner.decide", 3, "raise ValueError('no plan')")
    begin = time.monotonic()
    with pytest.raises(ExecutorLost, match="no plan"):
        simulate_on(2, "central", ready, folder)
    assert time.monotonic() - begin < 60.0


@pytest.mark.parametrize(
    ("rank", "module", "kind", "method"),
    [
        (2, "runtime.bundle", "Bundle", "run"),
        (2, "runtime.executor", "Executor", "__init__"),
        (0, "runtime.supervisor", "Distributed", "_grant"),
    ],
)
def test_a_fault_of_mpi_is_told(place, monkeypatch, rank, module, kind, method):
    """An exception of MPI in one living rank ends all ranks as any other does: the others would wait for it for ever."""
    ready, folder = readied(place, LONG)
    what = "from mpi4py import MPI; raise MPI.Exception(MPI.ERR_TRUNCATE)"
    faulty(place, monkeypatch, rank, f"parallel.{module}", f"{kind}.{method}", 1, what)
    begin = time.monotonic()
    with pytest.raises(ExecutorLost, match="Message truncated"):
        simulate_on(2, "central", ready, folder)
    assert time.monotonic() - begin < 60.0


@EITHER
def test_a_folder_that_is_deleted_ends_the_run(place, control):
    """One message, as soon as something is to be written under its name: the next checkpoint, of which one is due each second
    here."""
    (place / "sitecustomize.py").write_text(
        'import os\nif os.environ.get("PMI_RANK") == "0":\n'
        "    from mdanim_lammps.run import loop\n    loop.CHECKPOINT_SECONDS = 1.0\n"
    )
    process = begun(place, LONG, "-n", 2, "--control", control)
    shutil.rmtree(place / "film.out", ignore_errors=True)
    shutil.rmtree(place / "film.out", ignore_errors=True)  # a rank may just have written
    code, said = ended(process, 40.0)
    assert code == 7 and said.count("error:") == 1 and "film.out" in said and "Traceback" not in said, said


def test_a_folder_that_is_deleted_before_ranks_begin_is_told(place, monkeypatch):
    """They find no job, and the cause is not that one of them was lost."""
    ready, folder = readied(place, LONG)
    monkeypatch.setenv(launch.MPIEXEC, f"sh -c 'rm -r {folder}; exit 3' sh")
    with pytest.raises(OutputError, match=r"film\.out was deleted while the run wrote to it"):
        simulate_on(2, "central", ready, folder)


@pytest.mark.parametrize("arguments", [(), ("-n", 2)], ids=["alone", "executors"])
def test_a_stop_file_that_is_there_early_is_honoured(place, arguments):
    """Touched as soon as the folder is there, before the first frame, it stops the run."""
    (place / "film.txt").write_text(LONG)
    process = subprocess.Popen(
        command(place / "film.txt", "--no-movie", *arguments),
        env=environment(),
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    deadline = time.monotonic() + 20.0
    while not (place / "film.out" / "scene.lock.txt").exists() and time.monotonic() < deadline:
        time.sleep(0.001)
    (place / "film.out" / "stop").touch()
    code, said = ended(process, 20.0)
    assert code == 130 and "mdanim-lammps resume" in said, said


def test_a_killed_program_leaves_nothing_behind(place):
    """Killed alone, its ranks end; what it had put into the folder for them is cleared by the next run."""
    process = begun(place, LONG, "-n", 2)
    process.kill()
    process.wait()
    deadline = time.monotonic() + 10.0
    while ranks_in(place) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not ranks_in(place)
    (place / "film.out" / ".ranks-old").touch()
    goes_on(place, 0, "-n", 2)


@pytest.mark.parametrize("executors", [1, 2])
def test_a_second_run_into_the_same_folder_is_refused(place, executors):
    """Neither --force nor resume disturbs a run that is under way."""
    process = begun(place, LONG, "-n", executors)
    for again in ((place / "film.txt", "--force"), ("resume", place / "film.out")):
        done = subprocess.run(command(*again, "--no-movie", "-q"), env=environment(), capture_output=True, text=True)
        assert done.returncode == 7 and "another run is writing into this folder" in done.stderr, done.stderr
    process.send_signal(signal.SIGINT)
    code, said = ended(process, 20.0)
    assert code == 130 and "mdanim-lammps resume" in said, said
    with Trajectory(place / "film.out") as film:
        assert len(film) > 1


def test_a_folder_is_in_use_until_the_last_process_of_a_killed_run_has_ended(place, monkeypatch):
    """Ranks whose program was killed may write on for a while: a resume does not write beside them."""
    process = begun(place, LONG, "-n", 2)
    processes = list(ranks_in(place))
    for p in processes:
        os.kill(p, signal.SIGSTOP)
    process.kill()
    process.wait()
    done = subprocess.run(command("resume", place / "film.out", "-q"), env=environment(), capture_output=True, text=True)
    for p in processes:
        os.kill(p, signal.SIGCONT)
    assert done.returncode == 7 and "another run is writing into this folder" in done.stderr, done.stderr
    goes_on(place, 0)


def test_only_its_owner_can_read_or_change_a_job(place, monkeypatch):
    """Whatever mask the process has: it would be unpickled."""
    ready, folder = readied(place, LONG)
    monkeypatch.setenv(launch.MPIEXEC, f"sh -c 'stat -c %a {folder}/{launch.JOB}* > {place}/mode; exit 3' sh")
    former = os.umask(0)
    try:
        with pytest.raises(ExecutorLost, match="exit code 3"):
            simulate_on(2, "central", ready, folder)
    finally:
        os.umask(former)
    assert (place / "mode").read_text() == "600\n"


def test_a_job_is_not_written_into_a_file_that_is_there(place, monkeypatch):
    """Also where the name was guessed: it could be open elsewhere, or lead elsewhere."""
    ready, folder = readied(place, LONG)

    def guessed(_):
        (folder / f"{launch.JOB}1").symlink_to(place / "elsewhere")
        return "1"

    monkeypatch.setattr(launch.secrets, "token_hex", guessed)
    with pytest.raises(OutputError, match="File exists"):
        simulate_on(2, "central", ready, folder)
    assert not (place / "elsewhere").exists()


def test_a_rank_that_cannot_begin_is_told(place, monkeypatch):
    """Before the first frame too."""
    ready, folder = readied(place, LONG)
    faulty(place, monkeypatch, 1, "parallel.runtime.executor", "Executor._first_report", 1, "raise MemoryError('too large')")
    with pytest.raises(ExecutorLost, match="MemoryError: too large"):
        simulate_on(2, "central", ready, folder)


def test_most_of_the_wall_time_is_accounted_for(place):
    """The parts of the cost of a run of two executors add up to the wall time."""
    ready, folder = readied(place, films.FLYING)
    result = simulate_on(2, "central", ready, folder)
    assert 0.95 <= result.cost.covered <= 1.02, json.dumps(result.cost.to_json(), indent=1)
    assert all(result.cost.parts[name] > 0.0 for name in ("springs", "contact", "gravity", "leap-frog", "waiting", "moving"))
