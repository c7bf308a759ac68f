# SPDX-License-Identifier: GPL-2.0-only
"""Where space is cut for the ranks of an instance."""

from __future__ import annotations

import numpy as np

ROWS_SHORTER = 0.1
"""Part of their length by which objects count as shorter along the rows of their lattices when space is cut for ranks; a
`fix balance` that finds more than 10 % of imbalance in the course of a run cuts anew without it."""


def shorter_along_rows(position: np.ndarray) -> np.ndarray:
    """Places in which space is cut for ranks [m], shape (N, 3): all of it is shorter along the rows of lattices, where tags
    follow each other.

    A cut across rows leaves a ghost and hence an idle lane in each of them, so that a direction which is about as good is better.
    """
    along = np.median(np.abs(np.diff(position, axis=0)), axis=0) if len(position) > 1 else np.zeros(3)
    middle = 0.5 * (position.min(0) + position.max(0))
    return middle + (1.0 - ROWS_SHORTER * along / max(np.linalg.norm(along), np.finfo(float).tiny)) * (position - middle)


def box_to_cut(places: np.ndarray, spacing: float) -> np.ndarray:
    """Bounds of the box that is cut for ranks [m], shape (2, 3): LAMMPS cuts its box around all particles. If it were another
    when they are inserted, each would begin on another rank, perhaps one that is not beside its own, and LAMMPS would lose it."""
    margin = 1e-3 * spacing
    return np.array([places.min(0) - margin, places.max(0) + margin])
