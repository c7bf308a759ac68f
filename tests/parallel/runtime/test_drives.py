# SPDX-License-Identifier: GPL-2.0-only
"""Scenes with objects that are driven, or pushed by forces and hands, give the same bits in all forms of the distribution,
resumed, and by plain LAMMPS."""

import numpy as np
import pytest
from distribution_lab import RESUMED, TEAMS, THREADS, forms_in, lammps_makes_the_same, matrix, same_frames
from mdanim_lammps.results.ledger import Ledger

pytestmark = pytest.mark.mpi

SCENE = """
gravity (0, 0, -9.81) m/s^2
object table { shape box (24, 24, 8) cm  position (0, 0, 0) cm    density 1000  elasticity 1 MPa  hold all
  drive oscillation (0, 0, 1) cm frequency 12 Hz  drive turn (0, 0, 3) rad/s }
object rider { shape box (8, 8, 8) cm    position (2, 1, 8.5) cm  density 700   elasticity 300 kPa }
object arm   { shape box (8, 8, 24) cm   position (60, 0, 0) cm   density 800   elasticity 500 kPa  hold face -z
  key 0.1 s at (62, 0, 0) cm axis (0, 0, 1) angle 20 deg }
object flag  { shape box (8, 8, 8) cm    position (65, 20, 8) cm  density 300   elasticity 200 kPa  velocity (0, -2, 0) m/s }
object club  { shape box (8, 30, 8) cm   position (0, -50, 0) cm  density 1000  elasticity 1 MPa  hold all
  drive velocity (0, 0, 1) m/s  drive turn (20, 0, 0) rad/s }
object ball  { shape sphere 6 cm         position (0, -50, 12) cm density 900   elasticity 300 kPa }
control { time 0.08 s  frames 100 fps  resolution 4 cm  friction 0.4 }
"""
RIGID = """
gravity (0, 0, -9.81) m/s^2
ground z -0.2 m
object table { shape box (24, 24, 8) cm  position (0, 0, 0) cm    density 1000  elasticity rigid  hold all
  drive oscillation (0, 0, 1) cm frequency 12 Hz  drive turn (0, 0, 3) rad/s }
object rider { shape box (8, 8, 8) cm    position (2, 1, 8.005) cm  density 700   elasticity rigid }
object flag  { shape sphere 4 cm         position (25, 2, 0) cm   density 300   elasticity rigid  velocity (-2, 0, 1) m/s }
object club  { shape box (8, 30, 8) cm   position (0, -50, 0) cm  density 1000  elasticity rigid  hold all
  drive velocity (0, 0, 1) m/s  drive turn (20, 0, 0) rad/s }
object ball  { shape sphere 6 cm         position (0, -50, 12) cm density 900   elasticity rigid }
object rest  { shape box (8, 8, 8) cm    position (40, -60, 20) cm density 900   elasticity rigid }
control { time 0.08 s  frames 100 fps  friction 0.4 }
"""
WET = """
gravity (0, 0, -9.81) m/s^2
liquid water { basin from (-30, -20, 0) cm to (30, 20, 40) cm density 1000 kg/m^3 level 20 cm }
object blade { shape box (8, 24, 20) cm position (0, 0, 14) cm density 1000 elasticity 1 MPa hold all
  drive oscillation (6, 0, 0) cm frequency 3 Hz  drive turn (0, 0, 2) rad/s }
object duck { shape box (8, 8, 8) cm position (-20, 0, 21) cm density 500 elasticity 300 kPa }
object far { shape box (8, 8, 8) cm position (20, 0, 50) cm density 500 elasticity 300 kPa }
object cork { shape box (8, 8, 8) cm position (20, 10, 16) cm density 300 elasticity 300 kPa hold all release 0.034 s }
object club  { shape box (8, 20, 8) cm   position (0, 0, 60) cm  density 1000  elasticity 1 MPa  hold all
  drive turn (20, 0, 0) rad/s }
control { time 0.08 s  frames 100 fps  resolution 4 cm }
"""
PUSHED = """
gravity (0, 0, -9.81) m/s^2
ground z -0.2 m
object sled  { shape box (16, 8, 8) cm   position (0, 0, -16) cm   density 1000  elasticity 500 kPa
  force (30, 0, 0) N from 0.013 s to 0.0561 s  torque (0, 0, 0.3) N*m }
object box   { shape box (8, 8, 8) cm    position (14, 0, -16) cm  density 700   elasticity 300 kPa }
object top   { shape cylinder 8 cm 8 cm  position (60, 0, 0) cm    density 800   elasticity rigid
  torque (0, 0, 0.4) N*m from 0.02 s  force (0, 0, 12) N to 0.031 s }
object stone { shape box (8, 8, 8) cm    position (60, 13, 0) cm   density 300   elasticity rigid  force (0, -4, 0) N }
object pole  { shape box (8, 8, 24) cm   position (0, 60, 0) cm    density 800   elasticity 500 kPa  hold face -z
  force (5, 0, 0) N to 0.04 s }
object far   { shape sphere 6 cm         position (90, 60, 10) cm  density 900   elasticity 300 kPa }
hand far     { at (93, 60, 10) cm  key 0.01 s at (93, 60, 10) cm  key 0.0333 s at (93, 66, 14) cm  key 0.06 s at (94, 66, 18) cm }
hand stone   { at (64, 13, 4) cm   key 0.02 s at (64, 13, 3) cm   key 0.08 s at (60, 11, 8) cm }
control { time 0.08 s  frames 100 fps  resolution 4 cm  friction 0.4 }
"""
RELEASED = """
gravity (0, 0, -9.81) m/s^2
ground z -0.2 m
object table { shape box (24, 24, 8) cm  position (0, 0, 0) cm    density 1000  elasticity 1 MPa  hold all  release 0.035 s
  drive oscillation (0, 0, 1) cm frequency 12 Hz  drive turn (0, 0, 3) rad/s }
object rider { shape box (8, 8, 8) cm    position (2, 1, 8.5) cm  density 700   elasticity 300 kPa }
object brick { shape box (8, 8, 24) cm   position (60, 0, 0) cm   density 800   elasticity rigid  hold all  release 0.04 s
  drive velocity (0, 0.3, 1) m/s  drive turn (9, 0, 3) rad/s }
object ball  { shape sphere 6 cm         position (60, 3, 18.2) cm density 900  elasticity rigid }
object flag  { shape box (24, 8, 8) cm   position (0, 60, 0) cm   density 300   elasticity 200 kPa
  hold face -x  release 0.011 s }
object stone { shape box (8, 8, 8) cm    position (30, 60, 8) cm  density 900   elasticity rigid  hold all  release 0.03 s }
control { time 0.08 s  frames 100 fps  resolution 4 cm  friction 0.4 }
"""
SHAKEN = """
gravity (0, 0, -9.81) m/s^2
walls from (-40, -40, 0) cm to (40, 40, 40) cm
walls drive oscillation (3, 0, 0) cm frequency 4 Hz
walls key 0.05 s by (0, 0, 2) cm
object belt  { shape box (60, 8, 8) cm   position (0, 30, 10) cm   density 1000  elasticity 1 MPa  hold all
  drive surface (1, 0, 0) m/s }
object rider { shape box (8, 8, 8) cm    position (-20, 30, 18.01) cm  density 700  elasticity 300 kPa }
object stone { shape box (8, 8, 8) cm    position (0, 30, 18.005) cm  density 700  elasticity rigid }
object cube  { shape box (8, 8, 8) cm    position (-35, 0, 4.01) cm  density 900   elasticity 300 kPa }
object brick { shape box (8, 8, 8) cm    position (20, -20, 4.005) cm  density 900  elasticity rigid }
object rope  { shape rope from (-20, -20, 1) cm to (10, -20, 1) cm thickness 2 cm density 900 elasticity 1 MPa }
object ball  { shape sphere 6 cm         position (33, 10, 12) cm  density 900   elasticity rigid }
control { time 0.08 s  frames 100 fps  resolution 4 cm  friction 0.4 }
"""
SLOSHED = """
gravity (0, 0, -9.81) m/s^2
liquid water { basin from (-30, -20, 0) cm to (30, 20, 40) cm density 1000 kg/m^3 level 20 cm
  drive oscillation (3, 0, 0) cm frequency 3 Hz  key 0.05 s by (0, 2, 0) cm }
object duck { shape box (8, 8, 8) cm position (-20, 0, 21) cm density 500 elasticity 300 kPa }
object cork { shape box (8, 8, 8) cm position (25, 10, 20) cm density 300 elasticity rigid }
object post { shape box (8, 8, 40) cm position (0, 0, 10) cm density 300 elasticity 300 kPa hold all }
object sunk { shape box (8, 8, 8) cm position (15, -10, 4.005) cm density 3000 elasticity rigid }
object far { shape box (8, 8, 8) cm position (20, 0, 50) cm density 500 elasticity 300 kPa }
control { time 0.08 s  frames 100 fps  resolution 4 cm  friction 0.4 }
"""
SCENES = {
    "elastic": SCENE, "rigid": RIGID, "wet": WET, "pushed": PUSHED, "released": RELEASED, "shaken": SHAKEN,
    "sloshed": SLOSHED,
}  # fmt: skip
FEW = matrix((3,), ["peers"], name="all move ", rotate=True) | TEAMS | {way: RESUMED[way] for way in RESUMED if "alone" in way}
"""Forms of every scene: objects that change their executors, teams of ranks, a run that goes on with executors."""
CASES = FEW | matrix((2,), ["central"], name="all move ", rotate=True) | THREADS | RESUMED
"""Forms of scenes in which what is held is let go and the liquid is driven; of all scenes with `make soak`."""
WHOLE = ("released", "sloshed")
ALL = ", all forms"


@pytest.fixture(
    scope="module", params=[*SCENES, *(pytest.param(name + ALL, marks=pytest.mark.soak) for name in SCENES if name not in WHOLE)]
)
def scene(request):
    return request.param


def text_of(scene: str) -> str:
    return SCENES[scene.removesuffix(ALL)]


@pytest.fixture(scope="module")
def found(tmp_path_factory, scene):
    """The folder of each form, all made in one start of MPI."""
    cases = CASES if scene in WHOLE or scene.endswith(ALL) else FEW
    return forms_in(tmp_path_factory.mktemp("drives"), text_of(scene), cases, timeout=200.0)


def test_all_forms_give_the_same(found, scene):
    """Frames, the state, and the work but for rounding of its sums."""
    for way in found.keys() - {"sequential"}:
        alone, other = same_frames(found, way)
        for name in "xvf":
            assert np.array_equal(getattr(alone, name), getattr(other, name)), (way, name)
        assert alone.records.keys() == other.records.keys(), way
        for fix, records in alone.records.items():
            if not (fix == "liquid" and way.startswith("teams")):  # its ledger is a sum over ranks
                assert records == other.records[fix], (way, fix)
        assert other.carried["work"] == pytest.approx(alone.carried["work"], rel=1e-12), way


def test_the_ledger_closes(found):
    """With the work that drives have brought in, in all forms."""
    for folder in found.values():
        ledger = Ledger.read(folder / "ledger.csv")
        assert np.abs(ledger.array("residual")).max() < 1e-3 and np.abs(ledger.array("work")).max() > 0.1


def test_plain_lammps_gives_the_same(found, tmp_path, scene):
    """The script and data of the scene, with two ranks."""
    lammps_makes_the_same(found, tmp_path, text_of(scene))
