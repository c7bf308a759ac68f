# SPDX-License-Identifier: GPL-2.0-only
"""Inflated sheets and ballast give the same bits in all forms of the distribution, resumed, and by plain LAMMPS."""

import numpy as np
import pytest
from distribution_lab import FORMS, THREADS, forms_in, gone_on_after, lammps_makes_the_same, same_frames
from mdanim_lammps.results.ledger import Ledger

pytestmark = pytest.mark.mpi

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0
object ball { shape sphere 8 cm sheet thickness 1 mm  position (0, 0, 0.085) m  density 900  elasticity 2 MPa  damping 0.3
  resolution 2.5 cm  inflate 2 kPa  velocity (0.5, 0, -1) m/s }
object twin { shape sphere 8 cm sheet thickness 1 mm  position (0.5, 0, 0.12) m  density 900  elasticity 2 MPa  damping 0.3
  resolution 2.5 cm  inflate 500 Pa outside 0 Pa }
object bag  { shape box (16, 12, 6) cm sheet thickness 1 mm  position (0, 0.4, 0.05) m  density 900  elasticity 2 MPa
  resolution 2.5 cm  inflate 1 kPa  velocity (0, -1, 0) m/s }
object die  { shape box (6, 6, 6) cm  position (0, 0.4, 0.13) m  density 500  elasticity rigid  friction 0.5
  ballast 4000 kg/m^3 within box (-1, 0, 0) m to (1, 1, 0.115) m  spin (0, 3, 0) rad/s }
object cube { shape box (6, 6, 6) cm  position (0.25, 0.4, 0.1) m  density 500  elasticity 300 kPa
  ballast 2000 kg/m^3 within box (-1, 0, 0) m to (1, 1, 0.09) m  velocity (-2, 0, 0) m/s }
control { time 0.06 s  frames 100 fps  resolution 2 cm }
"""
CASES = FORMS | THREADS | gone_on_after(4)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("inflate"), SCENE, CASES, timeout=200.0)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames, pressures among them, and the state."""
    alone, other = same_frames(found, way)
    for name in "xvf":
        assert np.array_equal(getattr(alone, name), getattr(other, name)), name
    ledgers = [Ledger.read(found[name] / "ledger.csv") for name in ("sequential", way)]
    np.testing.assert_allclose(ledgers[0].array("gas"), ledgers[1].array("gas"), rtol=1e-12)


def test_the_ledger_closes(found):
    ledger = Ledger.read(found["sequential"] / "ledger.csv")
    assert np.abs(ledger.array("residual")).max() < 1e-3 and np.ptp(ledger.array("gas")) > 0.01


def test_plain_lammps_gives_the_same(found, tmp_path):
    """The script and data of the scene, with two ranks."""
    lammps_makes_the_same(found, tmp_path, SCENE)
