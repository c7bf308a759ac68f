# SPDX-License-Identifier: GPL-2.0-only
"""How plots look."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

ROOM = 0.08
"""Room above and below curves, in parts of their span."""
LEAST = 0.01
"""Span of an axis over the largest value at it, at least: what varies less is as good as constant."""


@contextmanager
def own_style() -> Iterator[None]:
    """Draw plots with matplotlib's defaults; also a decorator. matplotlib takes settings from a file ``matplotlibrc`` in the
    current folder, which may have it run TeX on a title."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        yield


def span_of(series: Sequence[np.ndarray], unit: str) -> tuple[float, float]:
    """The ends of an axis for values of a unit: those of places are around the values, all others have 0 between them."""
    values = np.concatenate(series)
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    if unit != "m":
        low, high = min(low, 0.0), max(high, 0.0)
    least = LEAST * max(abs(low), abs(high)) or 1.0
    more = 0.5 * max(0.0, least - (high - low))
    room = ROOM * max(high - low, least)
    return low - more - room, high + more + room
