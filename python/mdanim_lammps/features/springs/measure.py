# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of springs that ``expect`` can ask for."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Glance, Measured, Recorded
from ...model.system import System
from ..tearing.gone import gone_of
from ..yielding.grown import grown_of


def kept(system: System, solid: int, gone: np.ndarray | None) -> np.ndarray:
    """Numbers of the springs of a solid without those that are ``gone``, bool, in the order of the solid's springs."""
    own = system.springs_of(solid)
    number = np.arange(own.start, own.stop)
    return number if gone is None else number[~gone]


def largest_strain(system: System, solid: int, position: np.ndarray, gone: np.ndarray | None = None) -> float:
    """Largest |r/r0 - 1| of the springs of a solid [-], for particle positions [m], shape (N, 3); r0 is the length in the body
    without load. Those that are ``gone`` do not count."""
    own = kept(system, solid, gone)
    if not len(own):
        return 0.0
    return float(np.abs(_lengths(system, own, position) / system.unloaded[own] - 1.0).max())


def _lengths(system: System, springs: np.ndarray, position: np.ndarray) -> np.ndarray:
    i, j = system.spring[springs].T
    return np.linalg.norm(position[i] - position[j], axis=1)


def _elastic(g: Glance) -> float:
    system = g.context.system
    gone = gone_of(system, g.solid, g.fields)
    own = kept(system, g.solid, gone)
    stretch = _lengths(system, own, g.position) - system.rest[own] - grown_of(system, g.solid, g.fields)[~gone]
    return float((0.5 * system.stiffness[own] * stretch**2 - system.preload_energy[own]).sum())


def _look(g: Glance) -> float:
    return largest_strain(g.context.system, g.solid, g.position, gone_of(g.context.system, g.solid, g.fields))


MEASURES = {
    ("NAME", "strain.max"): Recorded("strain", _look, Measured.largest),
    ("NAME", "elastic"): Recorded("elastic", _elastic),
}
