# SPDX-License-Identifier: GPL-2.0-only
"""The command line, run as a user runs it, and a scene that it accepts."""

from __future__ import annotations

import subprocess
import sys

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
