# SPDX-License-Identifier: GPL-2.0-only
"""The needs of the program on a machine, examined one after the other, each with a cure."""

from __future__ import annotations

import importlib.metadata as metadata
import platform
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from .. import __version__
from ..children import command, run
from ..engine import plugin
from ..processes import available_memory, cores
from ..records import dataclass
from ..run.manifest import PACKAGES

OK, NOTE, FAIL = 0, 1, 2
LEAST_DISK = 1e9
"""Bytes: a movie and a trajectory of a small scene need a tenth."""


@dataclass(frozen=True, slots=True)
class Finding:
    """The finding on one need."""

    severity: int
    what: str
    found: str
    cure: str = ""


def examine() -> Iterator[Finding]:
    """Findings, the ones on which others rest first; none raises."""
    for what, look, cure in (
        ("python", _python, "take Python 3.10 or newer"),
        ("packages", _packages, "pip install --force-reinstall mdanim-lammps"),
        ("plugin", _plugin, "pip install --force-reinstall mdanim-lammps; for another LAMMPS build it: docs/install.md"),
        ("lmp", _lmp, "use the lmp of this environment, beside its python"),
        ("mpi", _mpi, "pip install --force-reinstall mpich mpi4py; MDANIM_MPIEXEC names another mpiexec"),
        ("opengl", _opengl, "Debian: apt install libegl1 libosmesa6; or run with --no-movie and render elsewhere"),
        ("ffmpeg", _ffmpeg, "pip install --force-reinstall imageio-ffmpeg; or run with --no-movie"),
        ("export", _extras, "pip install 'mdanim-lammps[export]'"),
        ("machine", _machine, ""),
        ("disk", _disk, "make room, or write elsewhere with -o DIR"),
    ):
        try:
            severity, found = look()
            yield Finding(severity, what, found, cure if severity else "")
        except Exception as error:  # whatever a broken installation raises is the finding
            yield Finding(FAIL, what, " ".join(str(error).split()) or type(error).__name__, cure)


def _python() -> tuple[int, str]:
    return (OK if sys.version_info >= (3, 10) else FAIL), f"{platform.python_version()}  {sys.executable}  {platform.platform()}"


def _packages() -> tuple[int, str]:
    missing = [name for name in PACKAGES if not _version(name)]
    if missing:
        return FAIL, f"not installed: {', '.join(missing)}"
    return OK, f"mdanim-lammps {__version__}, " + ", ".join(f"{name} {_version(name)}" for name in PACKAGES)


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _plugin() -> tuple[int, str]:
    lmp, library = plugin.open_lammps()
    try:
        return OK, f"loaded by LAMMPS {lmp.version()}, interface {library.mdanim_abi()}  {plugin.folder()}"
    finally:
        lmp.close()


def _lmp() -> tuple[int, str]:
    beside, found = Path(sys.executable).parent / "lmp", shutil.which("lmp")
    if not beside.exists():
        return NOTE, "there is no lmp beside this Python"
    if found is None:
        return NOTE, f"lmp is not on the PATH; it is {beside}"
    if not Path(found).samefile(beside):
        return NOTE, f"lmp on the PATH is {found}, which does not know the styles; this one does: {beside}"
    return OK, found


def _mpi() -> tuple[int, str]:
    from mpi4py import MPI

    from ..parallel.runtime.launch import launcher

    mpiexec = launcher()
    # A process that ends at once may be gone before mpiexec has spoken to it, and then mpiexec dies of SIGPIPE: this one answers.
    done = run([*mpiexec, "-n", "1", sys.executable, "-I", "-c", "from mpi4py import MPI"], capture_output=True, timeout=30)
    library = MPI.Get_library_version().split("\n")[0].strip(" \0")
    if done.returncode:
        return FAIL, f"{' '.join(mpiexec)} ends with {done.returncode}: {done.stderr.strip()}"
    return OK, f"{library}  {' '.join(mpiexec)}"


def _opengl() -> tuple[int, str]:
    # In a process of its own: a graphics driver may end it.
    done = run(command("mdanim_lammps.picture.window"), capture_output=True, timeout=120)
    if done.returncode:
        return FAIL, (done.stderr.strip().splitlines() or ["ended without a word"])[-1]
    return OK, done.stdout.strip()


def _ffmpeg() -> tuple[int, str]:
    import imageio_ffmpeg

    return OK, f"{imageio_ffmpeg.get_ffmpeg_version()}  {imageio_ffmpeg.get_ffmpeg_exe()}"


def _extras() -> tuple[int, str]:
    missing = [name for name in ("usd-core", "pandas") if not _version(name)]
    return (NOTE, f"not installed: {', '.join(missing)}, for --to usd and tables") if missing else (OK, "usd-core, pandas")


def _machine() -> tuple[int, str]:
    return OK, f"{cores()} cores, {available_memory() / 1e9:.1f} GB of free memory"


def _disk() -> tuple[int, str]:
    with tempfile.NamedTemporaryFile(dir="."):
        free = shutil.disk_usage(".").free
    return (OK if free > LEAST_DISK else NOTE), f"{free / 1e9:.1f} GB free in {Path.cwd()}"
