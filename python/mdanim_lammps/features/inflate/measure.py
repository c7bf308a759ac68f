# SPDX-License-Identifier: GPL-2.0-only
"""How pressure and volume of what is inflated are measured."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Measurable, Measured, Of
from .effect import PRESSURE, VOLUME


def _of(field: str) -> Measurable:
    def series(m: Measured, of: Of) -> np.ndarray:
        n = list(m.trajectory.names).index(of.subject)
        return np.array([m.trajectory.field(field, frame)[n] for frame in range(len(m.times))])

    return Measurable(series)


MEASURES = {("NAME", "pressure"): _of(PRESSURE), ("NAME", "volume"): _of(VOLUME)}
