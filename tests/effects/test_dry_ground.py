# SPDX-License-Identifier: GPL-2.0-only
"""Held ground that is dry and lower than the liquid beside it."""

import numpy as np
from mdanim_lammps import Scene

DAM = """
gravity (0, 0, -9.81) m/s^2
liquid water {
  basin from (-1, -0.3, 0) m to (1, 0.3, 0.6) m  density 1000 kg/m^3  level 0.4 m
  fill from (-1, -0.3, 0) m to (-0.5, 0.3, 0.5) m
}
object bed { shape box (2, 0.6, 0.1) m  position (0, 0, 0.05) m  hold all }
control { time 0.05 s  frames 20  resolution 5 cm }
"""


def test_a_dry_bed_is_no_lake(tmp_path):
    """The surface is that of the liquid behind the dam, and the ground's before it; a picture draws none there."""
    (tmp_path / "dam.txt").write_text(DAM)
    trajectory = Scene.load(tmp_path / "dam.txt").run(tmp_path / "dam.out").trajectory
    for frame in (0, 1):
        height, raw = trajectory.liquid_height(frame), trajectory.liquid_raw(frame)
        np.testing.assert_allclose(height[:, -10:], 0.1, atol=1e-6)
        assert np.isneginf(raw[:, -10:]).all()
        assert height[:, :5].min() > 0.35 and np.isfinite(raw[:, :5]).all()
