# SPDX-License-Identifier: GPL-2.0-only
"""Programs that are run on several ranks, and the processes of a distributed run."""

from __future__ import annotations

import atexit
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import plugin_path
from paths import MPI

RANKS = 5
"""Ranks that stand by: as many as a program of the tests needs."""
GRACE = 10.0
"""Seconds that ranks have to tell where they are, or to end."""
STARTS = 2
"""Starts of MPI that are kept: one as the tests have it, and one with features of a test."""


def on_ranks(
    program: Path, ranks: int, *arguments: object, timeout: float = 900.0, own: bool = False, more: Mapping[str, str] = {}
) -> str:
    """Output of a Python program on this many ranks, all of which end when one raises.

    Ranks stand by from one program to the next, as their start takes longer than most programs; ``own`` are those of a
    program that changes or measures its processes. ``more`` is added to the environment. Raises AssertionError with all that
    was said.
    """
    env = {**plugin_path.environment(), "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **more}
    env.pop("PYTEST_CURRENT_TEST", None)
    started = Ranks(ranks, env) if own else _standing_by(env)
    try:
        return started.run(program, ranks, arguments, timeout)
    finally:
        if own:
            started.close()


class Ranks:
    """One start of MPI, whose ranks run programs one after the other."""

    def __init__(self, ranks: int, env: dict[str, str]):
        self.env, self.folder = env, Path(tempfile.mkdtemp(prefix="ranks-"))
        for rank in range(ranks):
            os.mkfifo(self.folder / str(rank))
        # Opened for both directions, a pipe waits for nobody; it ends with this process.
        self._pipes = [os.open(self.folder / str(rank), os.O_RDWR) for rank in range(ranks)]
        self._told = (self.folder / "told").open("w")
        self._process = subprocess.Popen(
            [plugin_path.BIN / "mpiexec", "-n", str(ranks), sys.executable, "-m", "mpi4py", MPI / "stand_by.py", self.folder],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=self._told,
            env=env,
            text=True,
            start_new_session=True,
        )

    def run(self, program: Path, ranks: int, arguments: tuple[object, ...], timeout: float) -> str:
        """Returns all that a program prints. Raises AssertionError, after which there are no ranks."""
        job = {"program": str(program), "arguments": [*map(str, arguments)], "ranks": ranks, "seconds": timeout}
        for pipe in self._pipes:
            os.write(pipe, (json.dumps(job) + "\n").encode())
        late = threading.Timer(timeout + GRACE, self._kill)
        late.start()
        said = []
        try:
            for line in self._process.stdout:
                if line.startswith('"'):
                    return json.loads(line)
                said.append(line)
        finally:
            late.cancel()
        raise AssertionError("".join(said) + self.close())

    def close(self) -> str:
        """Let ranks end, which have then nothing more to read; returns what they have said on stderr."""
        if self.ended:
            return ""
        for pipe in self._pipes:
            os.close(pipe)
        self._pipes = []
        try:
            self._process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._kill()
        self._process.stdout.close()
        self._told.close()
        told = (self.folder / "told").read_text(errors="replace")
        shutil.rmtree(self.folder)
        return told

    @property
    def ended(self) -> bool:
        """Whether they were let end."""
        return not self._pipes

    def _kill(self) -> None:
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGTERM)  # mpiexec ends all ranks
        self._process.wait()


_kept: list[Ranks] = []


def _standing_by(env: dict[str, str]) -> Ranks:
    """Ranks with this environment; those that were not used for longest make room for them."""
    found = next((ranks for ranks in _kept if ranks.env == env and not ranks.ended), None) or Ranks(RANKS, env)
    _kept[:] = [*(ranks for ranks in _kept if ranks is not found and not ranks.ended), found]
    while len(_kept) > STARTS:
        _kept.pop(0).close()
    return found


@atexit.register
def _end() -> None:
    for ranks in _kept:
        ranks.close()


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
