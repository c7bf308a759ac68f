# SPDX-License-Identifier: GPL-2.0-only
"""Spin of objects by their particles."""

import numpy as np
import pytest
from mdanim_lammps.model.spin import spin


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("far", [np.nan, np.inf, 1e200])
def test_a_damaged_object_has_no_spin_and_others_have_theirs(far):
    """A file may hold any number; no error of the eigenvalues ends an export."""
    place = np.random.default_rng(1).normal(size=(16, 3))
    velocity = np.cross([1.0, 2.0, 3.0], place)
    place[3, 1] = far
    found = spin(np.ones(16), np.array([0, 8]), place, velocity)
    assert np.isnan(found[0]).all()
    np.testing.assert_allclose(found[1], [1.0, 2.0, 3.0], rtol=1e-12)
