# SPDX-License-Identifier: GPL-2.0-only
"""Instances on several ranks: what one rank sees, to the last bit; and many instances one after the other."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import plugin_path
import pytest
from mpi.follow import follow
from test_engine import MEETING, SPLASH

FOLLOW = Path(__file__).parent / "mpi" / "follow.py"
NEARER = MEETING.replace("44) cm", "42.6) cm").replace("-4, 5) cm", "-4, 3.5) cm")
SCENES = {"solids": NEARER.replace("drag 0.8", "drag 0.8\n  damping 0.05"), "liquid": SPLASH,
          "pressure": SPLASH.replace("volume 45 l", "volume 45 l model pressure")}
ACCOUNTS = np.s_[80:96]
"""Bytes of a liquid's state that only tell energies, StateHead in fix_mdanim_liquid.cpp."""


def on_ranks(program: Path, ranks: int, *arguments: object) -> None:
    """Run a Python program on several ranks; ``-m mpi4py`` ends all of them when one raises."""
    done = subprocess.run(
        [plugin_path.BIN / "mpiexec", "-n", str(ranks), sys.executable, "-m", "mpi4py", program, *map(str, arguments)],
        capture_output=True, text=True, timeout=240, env={**plugin_path.environment(), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))})
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.mpi
@pytest.mark.parametrize(("name", "ranks"), [("solids", 2), ("solids", 3), ("solids", 4), ("liquid", 2), ("liquid", 4), ("pressure", 3)])
def test_ranks_see_what_one_sees(tmp_path, name, ranks):
    """Follow contact, dashpots, drag, held particles and liquid, take back steps, move all particles: the same bits on all ranks."""
    path = tmp_path / "small.txt"
    path.write_text(SCENES[name])
    alone = follow(path)
    on_ranks(FOLLOW, ranks, "together", path, tmp_path / "film.npz")
    film = np.load(tmp_path / "film.npz")
    same(film, alone)
    for what in ("x", "v", "f"):
        assert np.array_equal(film[f"again {what}"], film[f"end {what}"]) and np.array_equal(film[f"new {what}"], film[f"end {what}"])
    assert (film["end x"] != film["start x"]).any()
    assert np.abs(film["end energies"]).min() > 0.0 if name == "solids" else (film["end cells"] != film["start cells"]).any()


@pytest.mark.mpi
def test_instances_on_parts_of_the_ranks(tmp_path):
    """Run one instance on rank 0 and another on ranks 1 and 2 at the same time."""
    path = tmp_path / "small.txt"
    path.write_text(SCENES["solids"])
    on_ranks(FOLLOW, 3, "apart", path, tmp_path / "film")
    alone = follow(path)
    for k in (0, 1):
        same(np.load(tmp_path / f"film{k}.npz"), alone)


def same(film, alone) -> None:
    """Compare every bit of what moves, and energies but for rounding."""
    assert set(film) == set(alone)
    for key, value in alone.items():
        if key.endswith(("energies", "depths")):
            np.testing.assert_allclose(film[key], value, rtol=1e-3, atol=1e-9, err_msg=key)  # dashpots, loss.h
        elif key.endswith("liquid"):
            assert np.array_equal(np.delete(film[key], ACCOUNTS), np.delete(value, ACCOUNTS)), key
        else:
            assert np.array_equal(film[key], value, equal_nan=True), key


def residue() -> tuple[int, int]:
    """Resident memory [bytes] and open files of this process."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE"), len(os.listdir("/proc/self/fd"))


def cycles(prepared, count: int) -> tuple[int, int]:
    """By how much memory and open files grow over so many instances, made, put, run and closed one after the other."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.engine.part import Parts

    parts = Parts(prepared(MEETING).plan)
    with Instance(parts.whole) as instance:
        instance.setup()
        whole = instance.state()
    first = parts.whole.system.first

    def one(k: int) -> None:
        a, b = ((1, 1), (2, 2), (1, 2))[k % 3]
        rows = slice(first[a], first[b + 1])
        with Instance(parts.part(range(a, b + 1), False)) as instance:
            instance.put(0, type(whole)(whole.x[rows], whole.v[rows], whole.f[rows]))
            instance.run(2)

    for k in range(450):  # LAMMPS and MPI fill their own stores at first
        one(k)
    before = residue()
    for k in range(count):
        one(k)
    after = residue()
    return after[0] - before[0], after[1] - before[1]


def test_instances_leave_nothing_behind(prepared):
    """Make and close 300: no file stays open, and no memory is lost beyond what an allocator keeps."""
    memory, files = cycles(prepared, 300)
    assert files == 0
    assert memory < 300 * 4e3, f"{memory / 300:.0f} bytes an instance"


@pytest.mark.soak
def test_thousands_of_instances_leave_nothing_behind(prepared):
    """Make and close 6000: more than MPI has context identifiers, if they were not given back."""
    memory, files = cycles(prepared, 6000)
    assert files == 0
    assert memory < 6000 * 4e2, f"{memory / 6000:.0f} bytes an instance"
