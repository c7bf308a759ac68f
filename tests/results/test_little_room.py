# SPDX-License-Identifier: GPL-2.0-only
"""Every file that a run writes, and every file that is made of a run, on a disk of any size, and below limits of sizes of files:
it is whole, or there is one message, code 7, and nothing of it."""

from __future__ import annotations

import filecmp
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from campaign import rounds
from mdanim_lammps.export import FORMATS
from mdanim_lammps.export.write import export
from mdanim_lammps.results.compare import compare
from mdanim_lammps.view.export import write_report

SCENE = """
gravity (0, 0, -9.81) m/s^2
liquid water { basin from (-30, -30, 0) cm to (30, 30, 50) cm  density 1000 kg/m^3  level 20 cm }
object cork { shape box (12, 12, 12) cm  position (-12, -12, 40) cm  density 300 kg/m^3  elasticity 100 kPa }
control { time 0.4 s  frames 50 fps  resolution 4 cm  friction 0.4 }
expect cork.position.z at 0.4 s = 0.1 m +- 1 m
render { size (64, 48) }
"""
MADE = {name: tuple(f"s{suffix}" for suffix in kind.suffixes) for name, kind in FORMATS.items()} | {"report": ("report.html",)}
"""Files that commands make from a run; ``report`` a page, the others are formats of an export."""
ROOT = pytest.mark.skipif(os.geteuid() != 0, reason="only root may mount a small file system")
PAGE = 4096
"""Bytes that a file system in memory gives."""


def command(*arguments, **options) -> subprocess.CompletedProcess:
    """Run the program."""
    arguments = [sys.executable, "-m", "mdanim_lammps", *map(str, arguments)]
    return subprocess.run(arguments, capture_output=True, text=True, timeout=300, **options)


def make(name: str, folder: Path, **options) -> subprocess.CompletedProcess:
    """Make one of `MADE` of a run."""
    return command(*(("report", folder) if name == "report" else ("export", folder, "--to", name, "-q")), **options)


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """The folder of a run with room; its scene lies beside it."""
    place = tmp_path_factory.mktemp("whole")
    (place / "s.txt").write_text(SCENE)
    ended = command(place / "s.txt", "-q")
    assert ended.returncode == 0, ended.stderr
    return place / "s.out"


@pytest.fixture(scope="module")
def made(whole, tmp_path_factory) -> Path:
    """A copy of it with all that commands make."""
    folder = shutil.copytree(whole, tmp_path_factory.mktemp("made") / "s.out")
    for name in FORMATS:
        export(folder, name)
    write_report(folder, folder / "report.html")
    return folder


@pytest.fixture
def small(tmp_path):
    """Mount a file system in memory of some bytes; the one before is given back."""
    place = tmp_path / "mounted"

    def mount(size: int) -> Path:
        if place.is_mount():
            subprocess.run(["umount", place], check=True)
        place.mkdir(exist_ok=True)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", place], capture_output=True).returncode:
            pytest.skip("no file system in memory can be mounted here")
        return place

    yield mount
    if place.is_mount():
        subprocess.run(["umount", place], check=True)


def one_message(ended: subprocess.CompletedProcess, words: str = "cannot be written") -> None:
    """One line, beside bars that progress has drawn, with code 7; no traceback and no word of a library."""
    said = [line for line in ended.stderr.splitlines() if "%" not in line.split("mdanim-lammps: error: ")[0]]
    assert ended.returncode == 7 and len(said) == 1 and words in said[0] and "make room" in said[0], ended.stderr


def nothing_begun(folder: Path) -> None:
    """No unfinished file is left."""
    assert not list(folder.rglob(".*"))


def run_in(place: Path, whole: Path, tmp_path: Path) -> bool:
    """Run the scene in a place; whether there was room. Else it goes on elsewhere to the same bits, and draws its movie."""
    out = place / "s.out"
    ended = command(whole.with_name("s.txt"), "-o", out, "-q")
    if ended.returncode == 0:
        assert compare(out, whole).equal
        return True
    one_message(ended)
    if not out.exists():
        return False
    nothing_begun(out)
    moved = tmp_path / "moved" / "s.out"
    shutil.rmtree(moved.parent, ignore_errors=True)
    shutil.copytree(out, moved)
    if (out / "summary.json").exists():
        assert "`render` again" in ended.stderr
        again = command("render", moved, "-q")
    elif (out / "checkpoint").exists():
        assert "make room and resume" in ended.stderr
        again = command("resume", moved, "-q")
    else:
        assert "repeat the command, with --force" in ended.stderr
        again = command(whole.with_name("s.txt"), "-o", moved, "-q", *(["--force"] if (moved / "manifest.json").exists() else []))
    assert again.returncode == 0, again.stderr
    assert compare(moved, whole).equal and (moved / "movie.mp4").stat().st_size > 1000
    return False


def size_of(folder: Path, *names: str) -> int:
    """Bytes that files take in pages."""
    files = [path for name in names or ("",) for path in (folder / name, *(folder / name).rglob("*")) if path.is_file()]
    return sum(-(-path.stat().st_size // PAGE) * PAGE for path in files)


def make_in(place: Path, room: int, name: str, made: Path, whole: Path) -> bool:
    """Copy the run to a place, leave so much room there, and make one of `MADE`; whether it is there, and whole."""
    out = shutil.copytree(whole, place / "s.out")
    with (place / "others").open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, max(PAGE, shutil.disk_usage(place).free - room // PAGE * PAGE))
    return told_or_whole(make(name, out), out, name, made)


def told_or_whole(ended: subprocess.CompletedProcess, out: Path, name: str, made: Path) -> bool:
    """Either all files are the same as with room, or none of them is there."""
    nothing_begun(out)
    targets = [out / target for target in MADE[name]]
    if ended.returncode:
        one_message(ended)
        assert "repeat the command" in ended.stderr
        assert not [target for target in targets if target.exists()]
        return False
    for target in targets:
        files = [target] if target.is_file() else list(target.iterdir())
        first = [path for path in files if not filecmp.cmp(path, made / path.relative_to(out), shallow=False)]
        assert not first or name == "report", first  # a page tells when it was made
    return True


@ROOT
def test_a_movie_without_room(whole, small, tmp_path):
    """All else of the run has room; ffmpeg does not say how its movie ends."""
    assert not run_in(small(size_of(whole) - PAGE), whole, tmp_path)


@ROOT
@pytest.mark.parametrize("name", ["usd", "xtc"])
def test_a_library_without_room(whole, made, small, name):
    """Some print their own words, some end with errors of a file that is corrupt, and one says nothing."""
    place = small(64 << 20)
    assert not make_in(place, size_of(made, *MADE[name]) - PAGE, name, made, whole)


def test_a_limit_of_the_size_of_files(whole, made, tmp_path):
    """Which names the limit, in place of the disk."""
    out, limit = shutil.copytree(whole, tmp_path / "s.out"), (made / "s.usdc").stat().st_size // 2
    ended = make("usd", out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    assert not told_or_whole(ended, out, "usd", made) and "ulimit -f" in ended.stderr


@pytest.mark.parametrize("executors", [1, pytest.param(2, marks=pytest.mark.mpi)])
def test_mpi_below_a_limit_of_the_size_of_files(whole, tmp_path, executors):
    """It shares memory by files, and would end the process with words of its own."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4 << 20, 4 << 20))
    out = tmp_path / "s.out"
    ended = command(whole.with_name("s.txt"), "-o", out, "-n", executors, "-q", "--no-movie", preexec_fn=limit)
    assert ended.returncode == 5 and "ulimit -f unlimited" in ended.stderr and ended.stderr.count("\n") == 1, ended.stderr


@ROOT
@pytest.mark.soak
@pytest.mark.timeout(7200)
def test_runs_at_forty_sizes(whole, small, tmp_path):
    """From a page to all that the run and its movie take: manifest, lock, input of LAMMPS, progress, frames, checkpoint, ledger,
    summary, movie."""
    count, most = rounds(40), size_of(whole) + 8 * PAGE
    full = [not run_in(small(PAGE + most * k // count), whole, tmp_path) for k in range(count)]
    assert sum(full) > count // 2


@ROOT
@pytest.mark.soak
@pytest.mark.timeout(7200)
def test_what_is_made_of_a_run_at_forty_sizes(whole, made, small):
    """Exports, and a page, each at five sizes from nothing to all that it takes."""
    names, count = list(MADE), rounds(40)
    full = 0
    for k in range(count):
        name, part = names[k % len(names)], (k + 0.5) / count
        full += not make_in(small(64 << 20), round(part * 1.1 * size_of(made, *MADE[name])), name, made, whole)
    assert full > count // 2


@pytest.mark.soak
@pytest.mark.timeout(7200)
def test_what_is_made_of_a_run_below_forty_limits(whole, made, tmp_path):
    """The same below limits of the size of files."""
    names, count = list(MADE), rounds(40)
    for k in range(count):
        name, out = names[k % len(names)], tmp_path / f"{k}" / "s.out"
        shutil.copytree(whole, out)
        largest = max(path.stat().st_size for target in MADE[name] for path in (made / target, *(made / target).rglob("*")))
        limit = round(largest * (k + 0.5) / count)
        told_or_whole(
            make(name, out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))), out, name, made
        )
