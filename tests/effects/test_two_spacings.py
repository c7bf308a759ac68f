# SPDX-License-Identifier: GPL-2.0-only
"""Objects with spacings of their own meet: energy holds, and impulses are those of equal spacings."""

import pytest
from mdanim_lammps import Scene

PLATE = "object plate {{ shape box (20, 20, 3) cm position (0, 0, 0) m density 1000 elasticity 200 kPa {plate} }}\n"
BALL = (
    "object ball {{ shape {shape} position (0.4, 0.4, {z}) cm density 1000 elasticity 200 kPa "
    "velocity (0, 0, -0.5) m/s {ball} }}\ncontrol {{ time 30 ms frames 200 fps }}"
)


def blow(folder, shape: str, z: float, plate: str, ball: str):
    """Speed of the ball at the end over that before, share of the plate's momentum, and the residual of energy."""
    run = Scene.from_text(PLATE.format(plate=plate) + BALL.format(shape=shape, z=z, ball=ball)).run(folder)
    upper, lower = (run.trajectory.objects[name] for name in ("ball", "plate"))
    taken = lower.mass * lower.velocity[-1, 2] / (upper.mass * (upper.velocity[0, 2] - upper.velocity[-1, 2]))
    return upper.velocity[-1, 2] / 0.5, taken, run.ledger.residual


@pytest.mark.parametrize(
    ("shape", "z", "close"),
    [
        # python bench/modelling.py spacings, over a larger plate: 1.376 and 1.394 for the ball (both coarse 1.375), 1.42 and 1.45
        # for the corner (1.56).
        pytest.param("sphere 3 cm", 4.6, 0.02, id="ball: 1.3 %"),
        pytest.param("box (5, 5, 5) cm orientation axis (1, 1, 0) angle 54.7 deg", 5.95, 0.03, id="corner of a cube: 1.8 %"),
    ],
)
def test_a_fine_body_hits_a_coarse_plate_as_a_fine_one(tmp_path, shape, z, close):
    """The impulse over that of the ball's momentum is that of two fine bodies; momentum goes to the plate, energy holds."""
    fine, coarse = "resolution 7.5 mm", "resolution 15 mm"
    both, _, _ = blow(tmp_path / "both", shape, z, fine, fine)
    mixed, taken, residual = blow(tmp_path / "mixed", shape, z, coarse, fine)
    assert 1.0 + mixed == pytest.approx(1.0 + both, rel=close)
    assert taken == pytest.approx(1.0, abs=1e-9)
    assert residual < 1e-5


def test_a_marble_smaller_than_a_cell_of_what_never_moves_bounces_back(tmp_path):
    """A true elastic ball comes back at its speed, less what rings in it: 1.2 cm over cells of 1.5 cm."""
    speed, _, residual = blow(tmp_path / "run", "sphere 6 mm", 2.3, "resolution 15 mm hold all", "resolution 3 mm")
    assert 0.95 < speed <= 1.0
    assert residual < 1e-4


def test_a_fine_body_beside_a_far_coarser_one_has_a_time_step():
    """The barrier of the coarse one reaches over five spacings of the fine one: its share in the bound is that of all of them."""
    text = PLATE.format(plate="resolution 2 mm hold face -z") + BALL.format(
        shape="box (20, 20, 20) cm", z=12, ball="resolution 10 cm"
    )
    bound = Scene.from_text(text).certificate.bound
    coarse = Scene.from_text(text.replace("resolution 2 mm", "resolution 15 mm")).certificate.bound
    assert 0.0 < bound < coarse
