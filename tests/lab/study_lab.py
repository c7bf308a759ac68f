# SPDX-License-Identifier: GPL-2.0-only
"""A scene that runs in hundredths of a second, and tracks made by hand, for the tests of study/."""

import numpy as np

BAR = """
gravity (0, 0, -9.81) m/s^2
object bar {
  shape box (40, 10, 10) cm
  position (0, 0, 1)
  density 1000
  elasticity 2 MPa
  hold face -x
}
control {
  time 0.2 s
  frames 100 fps
}
expect bar.position.y at 0.2 s = 0 +- 1e-6 m
"""
"""Runs in hundredths of a second at 2 to 4 cells."""

TIMES = np.linspace(0.0, 1.0, 41)


def track(amplitude: float = 1.0, phase: float = 0.0) -> np.ndarray:
    """One object that swings, and one that never moves."""
    out = np.zeros((len(TIMES), 2, 3))
    out[:, 0, 2] = amplitude * (1.0 - np.cos(6.0 * TIMES + phase))
    out[:, 0, 2] -= out[0, 0, 2]
    return out
