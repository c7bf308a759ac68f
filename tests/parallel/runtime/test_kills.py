# SPDX-License-Identifier: GPL-2.0-only
"""Runs that are killed at random moments, alone, rank by rank or as a whole, go on to the bits of a run that was not."""

import os
import random
import shutil
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import pytest
from mdanim_lammps.results.compare import compare
from mpi import scenes as films
from ranks_lab import command, environment, ranks_in

pytestmark = [pytest.mark.mpi, pytest.mark.soak]
TEXT = films.FLYING.split("expect")[0].replace("time 0.2 s", "time 0.5 s") + "render { size (160, 90) }\n"
KILLS = 60
EAGER = """
import os
from mdanim_lammps.run import loop
loop.CHECKPOINT_SECONDS = 0.0
if os.environ.get("PMI_RANK") == "0":
    from mdanim_lammps.parallel.runtime import supervisor
    supervisor.KEEP_SECONDS = 0.0
"""
"""Put into the start of every Python: a checkpoint after every frame."""
LASTS = 3.0
"""Seconds that a run takes at least."""
MOMENTS = ("anywhere", "checkpoint", "movie")
COMPLETE = "is complete"


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """The folder of a run in one process that nothing disturbs."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "film.txt").write_text(TEXT)
    subprocess.run(command(folder / "film.txt", "--no-movie", "-q"), env=environment(), check=True)
    return folder / "film.out"


def start(folder: Path, eager: bool, *arguments: object) -> subprocess.Popen:
    """A run in a session of its own, so that all of it can be killed at once."""
    if eager:
        (folder / "sitecustomize.py").write_text(EAGER)
    log = (folder / "log").open("a")
    return subprocess.Popen(
        command(*arguments, "-q"), env=environment(*([folder] if eager else [])), stdout=log, stderr=log, start_new_session=True
    )


def wait_for(moment: str, out: Path, process: subprocess.Popen, chance: random.Random) -> None:
    """Until the moment at which to kill, or the end of the process."""
    delay = time.monotonic() + chance.uniform(0.0, LASTS)
    while time.monotonic() < delay and process.poll() is None and moment != "movie":
        time.sleep(0.005)
    names = {"checkpoint": "*checkpoint*part*", "movie": "summary.json"}
    deadline = time.monotonic() + 60.0
    while moment in names and not list(out.glob(names[moment])) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.0005)
    if moment == "movie":
        time.sleep(chance.uniform(0.0, 2.0))


def kill(process: subprocess.Popen, folder: Path, chance: random.Random) -> None:
    """All of it, its ranks too; or the program alone; or one rank."""
    ranks = ranks_in(folder)
    victims = chance.choice(["all", "program", *(["rank"] if ranks else [])])
    picked = list(ranks) if victims == "all" else [chance.choice(list(ranks))] if victims == "rank" else []
    if victims == "all":
        with suppress(ProcessLookupError):  # on a quick machine it may have ended by now
            os.killpg(process.pid, signal.SIGKILL)
    elif victims == "program":
        process.kill()
    for rank in picked:
        with suppress(ProcessLookupError):
            os.kill(rank, signal.SIGKILL)
    process.wait(timeout=30.0)
    deadline = time.monotonic() + 20.0
    while ranks_in(folder) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not ranks_in(folder), f"ranks are left after killing {victims}"


def spread(chance: random.Random) -> list[object]:
    """One process, or some executors under either control."""
    executors = chance.randrange(1, 5)
    return [] if executors == 1 else ["-n", executors, "--control", chance.choice(["central", "peers"])]


@pytest.mark.timeout(600)
@pytest.mark.parametrize("seed", range(KILLS))
def test_a_killed_run_goes_on_to_the_same_bits(tmp_path, whole, seed):
    """Kill it once or twice, then let it go on, each time on another number of executors."""
    chance, moment = random.Random(seed), MOMENTS[seed % len(MOMENTS)]
    scene, out = tmp_path / "film.txt", tmp_path / "film.out"
    scene.write_text(TEXT)
    movie = [] if moment == "movie" else ["--no-movie"]
    process = start(tmp_path, moment == "checkpoint", scene, *movie, *spread(chance))
    for _ in range(chance.randrange(1, 3)):
        wait_for(moment, out, process, chance)
        kill(process, tmp_path, chance)
        if not (out / "checkpoint").exists():
            shutil.rmtree(out, ignore_errors=True)
            process = start(tmp_path, False, scene, *movie, *spread(chance))
        else:
            process = start(tmp_path, moment == "checkpoint", "resume", out, *movie, *spread(chance))
    code = process.wait(timeout=120.0)
    log = (tmp_path / "log").read_text()
    assert code == 0 or COMPLETE in log, log
    assert "Traceback" not in log, log
    assert compare(whole, out).equal
    if moment == "movie":
        subprocess.run(command("render", out, "-q"), env=environment(), check=True)
        assert (out / "movie.mp4").stat().st_size > 1000
    assert not [p.name for p in out.iterdir() if p.name.startswith(".ranks-") or p.name == "stop"]
