# SPDX-License-Identifier: GPL-2.0-only
"""Where the objects of an instance have been."""

from __future__ import annotations

import ctypes

import numpy as np

from .opened_lammps import OpenedLammps


class Trace:
    """Boxes of M objects over all steps since `start`."""

    def __init__(self, lammps: OpenedLammps, objects: int):
        self._lammps, self._objects = lammps, objects

    def start(self) -> None:
        """Take note of where objects are now, and from now on of where every step takes them; forgets what was traced before."""
        self._lammps.call("trace objects", "mdanim_trace_start", ctypes.c_int(self._objects))

    def look_every(self, steps: int) -> None:
        """Look at particles only after every ``steps`` steps, until the trace is started again; a look takes 1/25 of a step.

        Boxes are then wider, by no more than the way of each object's fastest particle in one step less: nothing is ever outside
        of them.
        """
        self._lammps.call("trace objects", "mdanim_trace_every", ctypes.c_int(steps))

    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates of the particles of each object at any step since `start` [m], each of shape (M, 3).

        Coordinates that are NaN are passed over. Raises SetupError when nothing is traced.
        """
        low, high = np.empty((2, self._objects, 3))
        self._lammps.call("tell the trace", "mdanim_trace", ctypes.c_int(len(low)), low, high)
        return low, high

    def top_speeds(self) -> np.ndarray:
        """Speed of the fastest particle of each object now [m/s], shape (M,). Speeds that are NaN are passed over."""
        speed = np.empty(self._objects)
        self._lammps.call("tell speeds", "mdanim_top_speeds", ctypes.c_int(len(speed)), speed)
        return speed
