# SPDX-License-Identifier: GPL-2.0-only
"""The wind in pictures: an arrow above the first object, on a pole that is a line."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.picture.drawn import Drawn

RED, BLUE, LENGTH, POLE = (0.9, 0.05, 0.05), (0.05, 0.1, 0.9), 0.5, 0.5
"""Colours; sizes [m]."""
CORNERS = np.array([(0, -0.15, -0.15), (0, 0.15, -0.15), (0, 0.15, 0.15), (0, -0.15, 0.15), (LENGTH, 0, 0)])
FACES = np.array([(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])


def drawn(trajectory):
    if trajectory.wind is None:
        return
    foot = lambda frame: trajectory.centers[frame, 0]
    arrow = CORNERS[FACES].reshape(-1, 3) + (0.0, 0.0, POLE)
    yield Drawn("arrow", lambda frame: foot(frame) + arrow, np.arange(18).reshape(-1, 3), color=RED)
    yield Drawn("pole", lambda frame: foot(frame) + [(0, 0, 0), (0, 0, POLE)], line=np.array([(0, 1)]), color=BLUE)
