# SPDX-License-Identifier: GPL-2.0-only
"""Scenes with air give the same bits in all forms of the distribution, resumed, and by plain LAMMPS."""

import numpy as np
import pytest
from distribution_lab import FORMS, THREADS, forms_in, gone_on_after, lammps_makes_the_same, same_frames
from mdanim_lammps.results.ledger import Ledger

pytestmark = pytest.mark.mpi

WIND = """
gravity (0, 0, -9.81) m/s^2
air { wind at 0 s (0, 0, 0) m/s
  wind at 0.04 s (6, 3, 2) m/s }
"""
SCENES = {
    "elastic": WIND + """
object mast  { shape box (8, 8, 24) cm   position (0, 0, 0) cm    density 100  elasticity 300 kPa  hold face -z }
object crate { shape box (8, 8, 8) cm    position (30, 0, 0) cm   density 30   elasticity 200 kPa  velocity (-4, 0, 0) m/s }
object fan   { shape box (8, 24, 8) cm   position (60, 0, 0) cm   density 1000 elasticity 1 MPa    hold all
  drive turn (20, 0, 0) rad/s }
object ball  { shape sphere 6 cm         position (60, -20, 12) cm density 20  elasticity 100 kPa }
object rope  { shape rope from (0, 50, 0) cm to (0, 50, 40) cm thickness 2 cm  density 100 elasticity 300 kPa  hold end }
control { time 0.08 s  frames 100 fps  resolution 4 cm }
""",
    "rigid": WIND + """
ground z -10 cm
object kite  { shape box (20, 20, 5) cm  position (0, 0, 0) cm    density 8    elasticity rigid
  orientation axis (0, 1, 0) angle 30 deg }
object ball  { shape sphere 6 cm         position (30, 2, 0) cm   density 20   elasticity rigid  velocity (-3, 0, 1) m/s }
object can   { shape cylinder 4 cm 10 cm position (0, -50, 12) cm density 30   elasticity rigid  spin (10, 3, 0) rad/s }
object rest  { shape box (8, 8, 8) cm    position (40, -60, -6) cm density 900  elasticity rigid }
control { time 0.08 s  frames 100 fps  friction 0.4 }
""",
}  # fmt: skip
CASES = FORMS | THREADS | gone_on_after(4)


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    return request.param


@pytest.fixture(scope="module")
def found(tmp_path_factory, scene):
    """The folder of each form, all made in one start of MPI."""
    return forms_in(tmp_path_factory.mktemp("air"), SCENES[scene], CASES, timeout=200.0)


@pytest.mark.parametrize("way", CASES)
def test_all_forms_give_the_same(found, way):
    """Frames, the state, and the books but for rounding of their sums."""
    alone, other = same_frames(found, way)
    for name in "xvf":
        assert np.array_equal(getattr(alone, name), getattr(other, name)), name
    for column in ("work", "air_loss"):
        assert other.carried[column] == pytest.approx(alone.carried[column], rel=1e-9)


def test_the_ledger_closes(found):
    """With the work of the wind, in all forms."""
    for way in ("sequential", *CASES):
        ledger = Ledger.read(found[way] / "ledger.csv")
        assert np.abs(ledger.array("residual")).max() < 1e-3 and np.abs(ledger.array("air_loss")).max() > 0.001


def test_plain_lammps_gives_the_same(found, tmp_path, scene):
    """The script and data of the scene, with two ranks."""
    lammps_makes_the_same(found, tmp_path, SCENES[scene])
