# SPDX-License-Identifier: GPL-2.0-only
"""Two runs are compared frame by frame where their frames are at the same times."""

from __future__ import annotations

import pytest
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.compare import compare
from picture_samples import falling, slab_scene, write


def test_times_may_differ_by_rounding(tmp_path):
    """The same frames with other time steps have times whose last digits differ; another rate is another run."""
    scene, models = slab_scene()
    frames = list(falling(models, 4))
    a = write(tmp_path / "a.h5", scene, models, frames)
    rounded = [(step, time * (1 + 2e-16), x, v) for step, time, x, v in frames]
    assert any(r[1] != f[1] for r, f in zip(rounded, frames))
    assert compare(a, write(tmp_path / "b.h5", scene, models, rounded)).equal
    slower = [(step, time * 1.001, x, v) for step, time, x, v in frames]
    with pytest.raises(OutputError, match="times differ: run both scenes with the same control block"):
        compare(a, write(tmp_path / "c.h5", scene, models, slower))
