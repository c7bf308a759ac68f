# SPDX-License-Identifier: GPL-2.0-only
"""Runs in one process that are killed at random moments again and again, and go on to the bits of a run that was not."""

import random
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from campaign import rounds
from mdanim_lammps.results.compare import compare
from ranks_lab import command, environment

LIQUID = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
liquid water { basin from (-30, -30, 0) cm to (30, 30, 50) cm  density 1000 kg/m^3  level 20 cm }
object cork { shape box (12, 12, 12) cm  position (-12, -12, 40) cm  density 300 kg/m^3  elasticity 100 kPa }
object box { shape box (12, 12, 12) cm  position (12, 12, 40) cm  density 300 kg/m^3  elasticity 100 kPa  damping 0.1 }
control { time 0.4 s  frames 200 fps  resolution 4 cm  friction 0.4 }
"""
LINKS = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object line { shape rope from (0, 0, 1) m to (0.4, 0, 1) m thickness 1 cm length 0.5 m  density 900 kg/m^3  elasticity 2 MPa
  friction 0.4  hold start }
object weight { shape sphere 4 cm  position (0.44, 0, 1) m  density 2000 kg/m^3  elasticity rigid }
joint ball line weight { at (0.4, 0, 1) m }
object wheel { shape cylinder 10 cm 4 cm  position (1, 0, 0.6) m  density 700 kg/m^3  elasticity rigid }
object arm { shape box (30, 3, 3) cm  position (1.15, 0.2, 0.6) m  density 700 kg/m^3  elasticity 2 MPa  resolution 3 cm }
joint hinge wheel world { axis (0, 0, 1)  motor speed 60 rpm torque 0.3 N*m  friction 0.01 N*m }
joint hinge arm world { at (1.02, 0.2, 0.6) m  axis (0, 1, 0)  limits -40 deg to 20 deg }
object drop { shape sphere 5 cm  position (2, 0, 1) m  density 1000 kg/m^3  elasticity rigid }
joint ball drop world { at (2, 0, 1.04) m  breaks 4 N }
control { time 0.2 s  frames 200 fps  friction 0.3 }
"""
EAGER = "from mdanim_lammps.run import loop\nloop.CHECKPOINT_SECONDS = 0.0\n"
"""Put into the start of every Python: a checkpoint after every frame."""
COMPLETE = "is complete"


@pytest.fixture(scope="module", params=[LIQUID, LINKS], ids=["liquid", "links"])
def whole(tmp_path_factory, request) -> tuple[Path, float]:
    """The folder of a run that nothing disturbs, and what it took [s]."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "film.txt").write_text(request.param)
    start = time.monotonic()
    subprocess.run(command(folder / "film.txt", "--no-movie", "-q"), env=environment(), check=True)
    return folder / "film.out", time.monotonic() - start


def killed_until_complete(place: Path, whole: tuple[Path, float], chance: random.Random, most: int) -> int:
    """Kill a run and what resumes it, at most so many times, then let it go on; how many kills there were."""
    place.mkdir()
    shutil.copy(whole[0].with_suffix(".txt"), place)
    (place / "sitecustomize.py").write_text(EAGER)
    out, kills, log = place / "film.out", 0, place / "log"
    while True:
        begun = (out / "checkpoint").exists()
        words = ["resume", out] if begun else [place / "film.txt", "-o", out, "--force"]
        with log.open("a") as said:
            process = subprocess.Popen(
                command(*words, "--no-movie", "-q"), env=environment(place), stdout=said, stderr=said, start_new_session=True
            )
        if kills == most:
            process.wait(timeout=300.0)
            break
        try:
            process.wait(timeout=chance.uniform(0.3, 1.0) * whole[1])
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            kills += 1
        else:
            break
    text = log.read_text()
    assert process.returncode == 0 or COMPLETE in text, text
    assert "Traceback" not in text, text
    assert compare(whole[0], out).equal
    assert not [p.name for p in out.iterdir() if p.name.endswith(".part") or p.name == "stop"]
    return kills


def test_a_run_that_is_killed_once(tmp_path, whole):
    """For every day."""
    assert killed_until_complete(tmp_path / "one", whole, random.Random(5), 1) <= 1


@pytest.mark.soak
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("part", range(4))
def test_two_hundred_kills(tmp_path, whole, part):
    """Fifty a part, whatever file is being written."""
    chance, kills, k = random.Random(part), 0, 0
    while kills < rounds(50):
        kills += killed_until_complete(tmp_path / f"{k}", whole, chance, chance.randrange(1, 8))
        k += 1
