# SPDX-License-Identifier: GPL-2.0-only
"""Threads that share the rows of an update of waves: plugin/liquid/waves/waves.h, without LAMMPS."""

import numpy as np
import pytest
import waves_forms as forms
import waves_lab as lab


@pytest.mark.parametrize("threads", [2, 3, 5])
def test_threads_change_no_bit(threads):
    """Rows of columns are shared, in the middle of a splash beside a shelf with liquid above and below it."""
    alone, shared = (lab.Waves((24, 20, 20), bed=0.02) for _ in range(2))
    shared.threads(threads)
    body = forms.Body((5, 5, 5), (10.2, 9.7, 15), 0.6, velocity=(0.1, 0, -2))
    shelf = np.zeros(alone.shape, int)
    shelf[6:8, 2:9, :12] = 4096
    for one in (alone, shared):
        one.solids(shelf)
        one.pour(10)
    for n in range(60):
        body.x[2] -= 0.1 if n < 50 else -0.2
        part = np.maximum(shelf, share := forms.parts(body.share(alone.shape)))
        for one in (alone, shared):
            one.solids(part, share.sum(0) / 4096 * body.density)
            one.update()
        assert (shared.state == alone.state).all() and shared.counts == alone.counts
    assert alone.counts.iterations > 200 and alone.counts.limited
