# SPDX-License-Identifier: GPL-2.0-only
"""Bodies that fold through themselves are told: contact acts between objects only."""

import numpy as np
import pytest
from mdanim_lammps.run.folds import Folds
from mdanim_lammps.run.loop import simulate

BAR = """gravity (0, 0, -9.81) m/s^2
object bar {{ shape {shape}  position (0, 0, 0) m  density 1000  elasticity {young} kPa  damping 0.2
  hold within box (-0.03, -1, -1) to (0.03, 1, 1) }}
control {{ time {time} s  frames 20 fps  resolution 5 cm }}
"""


def bar(young=3.0, time=0.6, shape="box (90, 10, 10) cm"):
    """Held in its middle, arms hanging down."""
    return BAR.format(young=young, time=time, shape=shape)


def test_arms_that_swing_through_each_other_are_told(prepared, tmp_path):
    """Once, at the scene line, with time and place: below the clamp, in the middle. A stiffer bar bends and is not told of."""
    (warning,) = [w for w in simulate(prepared(bar()), tmp_path).warnings if "folds through itself" in w.message]
    assert warning.message.startswith("bar folds through itself, from t = 0.") and warning.line == 2
    assert warning.hint.startswith("write touches-itself yes in it, or")
    (tmp_path / "stiff").mkdir()
    stiff = simulate(prepared(bar(young=200.0)), tmp_path / "stiff")
    assert not [w for w in stiff.warnings if "folds through itself" in w.message]


@pytest.mark.parametrize(("gap", "folds"), [(-0.8, True), (-1.0, True), (-1.3, True), (0.02, False), (0.3, False), (1.0, False)])
def test_a_bar_that_is_bent_back_on_itself(prepared, gap, folds):
    """By half a turn, its halves so many spacings apart: overlapping by about a cell is found, touching is not."""
    ready = prepared(bar())
    system, h = ready.system, 0.05
    x = system.position.copy()
    radius = 0.05 + 0.5 * gap * h  # of the middle line; arms beyond the bend
    arc = np.clip(x[:, 0], -0.5 * np.pi * radius, 0.5 * np.pi * radius)
    angle, left, z = arc / radius, x[:, 0] - arc, x[:, 2]
    x[:, 0] = (radius + z) * np.sin(angle) + left * np.cos(angle)
    x[:, 2] = (radius + z) * np.cos(angle) - left * np.sin(angle)
    count, place = Folds(system).find(np.array([0]), x)
    assert (count[0] > 0) == folds and place.shape == (1, 3)


def test_compact_bodies_are_not_looked_at(prepared):
    """A cube and a ball cannot; nor can what is still."""
    for shape in ("box (20, 20, 20) cm", "sphere 20 cm"):
        assert not Folds(prepared(bar(shape=shape)).system).may.any()
    assert not Folds(prepared(bar().replace("hold within box (-0.03, -1, -1) to (0.03, 1, 1)", "hold all")).system).may.any()
