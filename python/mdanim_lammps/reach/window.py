# SPDX-License-Identifier: GPL-2.0-only
"""How far objects get until they are looked at again: pure arithmetic, the same in every process."""

from __future__ import annotations

import numpy as np


def window(speed: np.ndarray, seconds: float, acceleration: float, margin: float, safety: float = 1.3) -> np.ndarray:
    """The margin by which boxes are widened, d of Wcislo 1999, eq. (6.17), read as the reach of the fastest particle in a window
    [m], shape (M,).

    d = s v T + a/2 T² + margin. The guard of a window finds out where it was too small, so nothing about ``speed`` has to be
    proven.

    Args:
        speed: of the fastest particle of each object [m/s], shape (M,).
        seconds: length of the window T [s].
        acceleration: magnitude a [m/s²].
        margin: on top [m].
        safety: s [-], for the speed that forces add meanwhile.
    """
    return safety * speed * seconds + (0.5 * acceleration * seconds * seconds + margin)
