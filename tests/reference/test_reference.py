# SPDX-License-Identifier: GPL-2.0-only
"""Stored reference runs: today's program gives yesterday's motion."""

import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
from make import film  # noqa: E402


@pytest.mark.parametrize("name", sorted(p.stem for p in HERE.glob("*.txt")))
def test_motion_is_that_of_the_stored_run(name):
    """Follow the stored frames to 1e-10 m and m/s: another libm may turn the first position by one bit,
    nothing may amplify it."""
    stored = np.load(HERE / f"{name}.npz")["film"]
    np.testing.assert_allclose(film(HERE / f"{name}.txt"), stored, rtol=0, atol=1e-10)


def test_the_stored_runs_hold_what_they_are_for():
    """Find motion, impact and deformation in the stored frames, so that comparing with them means something."""
    for path in sorted(HERE.glob("*.npz")):
        film = np.load(path)["film"]
        moved = np.linalg.norm(film[-1, 0] - film[0, 0], axis=1).max()
        assert len(film) == 7 and moved > 0.02, path
        # A rigid flight would keep the fastest particle's speed change below g t.
        assert np.linalg.norm(film[-1, 1] - film[0, 1], axis=1).max() > 1.2 * 9.81 * 0.12, path
