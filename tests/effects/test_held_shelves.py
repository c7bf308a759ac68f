# SPDX-License-Identifier: GPL-2.0-only
"""An elastic ball that falls on what is held and thinner than its cells."""

import numpy as np
import pytest
from mdanim_lammps import DivergedError, Scene

SHELF = """gravity (0, 0, -9.81) m/s^2
object shelf {{ shape {shape}  position (0, 0, {z}) m  hold all }}
object ball {{ shape sphere 10 cm  position (0, 0, {at}) m  mass {m} kg  elasticity 300 kPa {own} velocity (0, 0, -{v}) m/s }}
control {{ time {time} s  frames 100 fps }}
record ball.position.z
"""


def shelf(shape, z, at=0.11, m=3, v=2, time=0.1, own=""):
    """A ball, four cells across, that falls on what is held."""
    scene = Scene.from_text(SHELF.format(**locals()))
    assert scene.prepared.system.spacing[1] == pytest.approx(0.05, rel=0.03)
    return scene


def heights(tmp_path, shape, z, **more):
    """Heights of the ball at each frame [m]."""
    return shelf(shape, z, **more).run(tmp_path / f"{shape}{z}", movie=False, progress=False).records["ball.position.z"]


def test_a_ball_bounces_on_a_thin_shelf_as_on_a_thick_one(tmp_path):
    """Cells of the ball are 2.5 times as wide as a plate is thick. A cuboid has an exact depth, and bears them alike; a disc has
    cells of its own for its depth."""
    thick, thin, disc = (
        heights(tmp_path, shape, -t / 2)
        for shape, t in (("box (0.24, 0.24, 0.2) m", 0.2), ("box (0.24, 0.24, 0.02) m", 0.02), ("cylinder 12 cm 2 cm", 0.02))
    )
    assert np.ptp(thick) > 0.05 and np.allclose(thick, thin, rtol=0.0, atol=1e-12)
    assert np.allclose(thick, disc, rtol=0.0, atol=2e-3)


def test_a_ball_stays_on_the_edge_of_a_thin_plate(tmp_path):
    """As thin as its cells allow: it comes down by a third of its radius at most, and leaves again."""
    found = heights(tmp_path, "box (0.02, 0.4, 0.4) m", -0.2)
    assert 0.065 < found.min() < 0.1 and found[-1] > 0.11


def test_a_ball_stays_on_the_tip_of_a_slim_cone(tmp_path):
    """The point of the surface around the tip faces along the axis: those beside it face nothing that comes from above, and the
    ball fell as if there were no cone."""
    cone = heights(tmp_path, "cone 6 cm 20 cm", -0.15, at=0.1005, m=1, v=0.2, time=0.2, own="resolution 5 cm")
    assert 0.07 < cone.min() < 0.09 and cone[10:].max() > cone.min() + 0.01


def test_a_peg_that_goes_through_a_ball_is_told_before_and_in_the_run(tmp_path):
    """It is 5 mm thick, and the ball has asked for cells of 5 cm: no limit was passed, and the ball fell past it."""
    scene = shelf("cylinder 2.5 mm 20 cm", -0.1, m=1, v=1, own="resolution 5 cm")
    (told,) = (m for m in scene.prepared.certificate.margins if m.name == "narrow part")
    assert told.severity == "warning" and told.object == "ball" and told.limit == pytest.approx(0.005)
    assert "write resolution 5 mm in ball" in told.hint
    with pytest.raises(DivergedError, match=r"shelf: it is inside ball(.|\n)*cause: ball may meet shelf with cells"):
        scene.run(tmp_path / "out", movie=False, progress=False)
    wide = shelf("cylinder 3 cm 20 cm", -0.1, own="resolution 5 cm").prepared.certificate.margins
    assert not [m for m in wide if m.name == "narrow part"]


def test_a_tip_that_goes_through_a_ball_is_told_before_and_in_the_run(tmp_path):
    """No cells make it hold: the way out is a blunter one, here of 6 cm, on which the ball above stays."""
    scene = shelf("cone 4 cm 20 cm", -0.15, at=0.1005, m=1, v=2, own="resolution 5 cm")
    (told,) = (m for m in scene.prepared.certificate.margins if m.name == "slim tip")
    assert told.severity == "warning" and told.object == "shelf" and told.value == pytest.approx(5.0)
    assert "write a radius of 6 cm or more" in told.hint
    with pytest.raises(DivergedError, match=r"shelf: it is inside ball(.|\n)*cause: shelf is 5 times as high as its radius"):
        scene.run(tmp_path / "out", movie=False, progress=False)
    (blunt,) = (m for m in shelf("cone 7 cm 20 cm", -0.15).prepared.certificate.margins if m.name == "slim tip")
    assert blunt.severity == "ok"
