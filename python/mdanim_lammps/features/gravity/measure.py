# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of gravity."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Measurable, Measured, Of, of_vector
from ...scene.in_time import vector_at


def _weight(m: Measured, of: Of) -> np.ndarray:
    """Mass times gravity [N], shape (F, 3)."""
    path = m.scene.gravity_path or ((0.0, m.scene.gravity),)
    mass = float(m.trajectory.metadata.object_mass[m.solid(of.subject)])
    return mass * np.array([vector_at(path, float(t)) for t in m.times])


def _potential(m: Measured, of: Of) -> np.ndarray:
    """Energy that moving from the start to here takes, with the weight as it is now [J], shape (F,)."""
    place = m.center[:, m.solid(of.subject)]
    return -np.einsum("fd,fd->f", _weight(m, of), place - place[0])


MEASURES = {("NAME", "potential"): Measurable(_potential), **of_vector("NAME", "weight", _weight)}
