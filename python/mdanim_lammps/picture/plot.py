# SPDX-License-Identifier: GPL-2.0-only
"""How plots look."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def own_style() -> Iterator[None]:
    """Draw plots with matplotlib's defaults; also a decorator. matplotlib takes settings from a file ``matplotlibrc`` in the
    current folder, which may have it run TeX on a title."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        yield
