# SPDX-License-Identifier: GPL-2.0-only
"""Programs that are run on several ranks, and the processes of a distributed run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import plugin_path


def on_ranks(program: Path, ranks: int, *arguments: object, timeout: float = 900.0) -> str:
    """Output of a Python program on this many ranks; ``-m mpi4py`` ends all of them when one raises."""
    done = subprocess.run(
        [plugin_path.BIN / "mpiexec", "-n", str(ranks), sys.executable, "-m", "mpi4py", program, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=timeout,
        env={**plugin_path.environment(), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def ranks_in(folder: Path) -> dict[int, int]:
    """Processes that are ranks of runs in a folder, or start such: rank (-1 for mpiexec) by process."""
    found = {}
    for process in Path("/proc").iterdir():
        try:
            if not process.name.isdigit():
                continue
            command = (process / "cmdline").read_text()
            if str(folder) in command and "parallel.runtime.ranks" in command:
                rank = re.search(r"PMI_RANK=(\d+)", (process / "environ").read_text())
                found[int(process.name)] = int(rank[1]) if rank else -1
        except OSError:  # it has ended meanwhile
            pass
    return found


def environment(*folders: object) -> dict[str, str]:
    return {**plugin_path.environment(), "PYTHONPATH": os.pathsep.join([*map(str, folders), *filter(None, sys.path)])}


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "mdanim_lammps", *map(str, arguments)]
