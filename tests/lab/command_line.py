# SPDX-License-Identifier: GPL-2.0-only
"""The command line, run as a user runs it, and a scene that it accepts."""

from __future__ import annotations

import gc
import io
import os
import signal
import subprocess
import sys
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path

GOOD = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object cube {
  shape box (10, 10, 10) cm
  position (0, 0, 6) cm
  density 1000 kg/m^3
  elasticity 100 kPa
}
control {
  time 0.1 s
  resolution 5 cm
}
"""


def run(*arguments, cwd=None):
    """Run the program as a user would."""
    return subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=200
    )


@contextmanager
def inside(folder: str | Path | None):
    """Work in a folder for a while."""
    before = Path.cwd()
    os.chdir(folder or before)
    try:
        yield
    finally:
        os.chdir(before)


def call(*arguments, cwd=None, main=None) -> subprocess.CompletedProcess[str]:
    """Call `run` without the second that a process takes to start: for tests of messages and files of commands. ``main`` is
    that of another program."""
    from mdanim_lammps import cli

    words, said, complained, code = [str(word) for word in arguments], io.StringIO(), io.StringIO(), 0
    threshold, handler = gc.get_threshold(), signal.getsignal(signal.SIGTERM)
    try:
        with inside(cwd), redirect_stdout(said), redirect_stderr(complained):
            (main or cli.main)(words)
    except SystemExit as end:
        code = int(end.code or 0)
    finally:
        gc.set_threshold(*threshold)
        gc.unfreeze()
        signal.signal(signal.SIGTERM, handler)
    return subprocess.CompletedProcess(words, code, said.getvalue(), complained.getvalue())
