# SPDX-License-Identifier: GPL-2.0-only
"""Momentum of a liquid in the ledger, from scene text to its columns: what it gains solids, walls and floor lose."""

import numpy as np
import pytest
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.features.liquid.ledger import BASIN_IMPULSE, LIQUID_MOMENTUM, MOMENTUM_RESIDUAL, SOLID_IMPULSE

LAKE = "gravity (0, 0, -9.81)\nliquid lake {{ basin from (-2, -1.5, 0) m to (2, 1.5, 0.8) m  density 1000  level 0.4 m {} }}\n"
HULL = (
    "object hull {{ shape {shape}  position (0, 0, 0.4) m  velocity ({v}) m/s  density 500  elasticity 400 kPa }}\n"
    "control {{ time {time} s  resolution 5 cm  frames 40 fps }}\n"
)
SLENDER, BLUNT = "ellipsoid (50, 16, 16) cm", "box (40, 40, 30) cm"


def run(folder, text):
    """Momenta at each frame [N s], each of shape (F, 2): of the liquid, its basin, its solids, the residual, and of the hull."""
    path = folder / "scene.txt"
    path.write_text(text)
    result = Scene.load(path).run(folder / "out", movie=False)
    columns = (LIQUID_MOMENTUM, BASIN_IMPULSE, SOLID_IMPULSE, MOMENTUM_RESIDUAL)
    told = [np.stack([result.ledger.array(name) for name in names], axis=-1) for names in columns]
    with Trajectory(result.folder) as t:
        hull = t.objects["hull"]
        return *told, hull.mass * np.asarray(hull.velocity)[:, :2]


def test_a_hull_that_glides_and_the_walls_that_its_waves_reach(tmp_path):
    """The hull loses what push and drag take, to 2 % of its first momentum: push is that of the last update. Waves
    come back from the walls; the account is open by 8 % of the most that it holds."""
    liquid, basin, solids, residual, hull = run(tmp_path, LAKE.format("") + HULL.format(shape=SLENDER, v="1.5, 0, 0", time=1.5))
    lost = hull - hull[0]
    np.testing.assert_allclose(solids, lost, atol=0.02 * hull[0, 0])
    np.testing.assert_allclose(residual, liquid + basin + solids, atol=1e-12)
    assert basin[-1, 0] > 1.5 * hull[0, 0] > -1.5 * lost[-1, 0] > 0.5 * hull[0, 0]
    assert np.abs(residual).max() < 0.08 * np.abs(basin).max()


def test_drag_along_and_across_still_water(tmp_path):
    """Mostly by drag, which the liquid takes up whole: what solids have lost is counted at updates, so up to 3 % late. Across,
    the start of a blunt side opens the account for a while: 0.060 are left, up and down
    by 0.005 (0.055 with masses by cells)."""
    _, _, solids, residual, hull = run(
        tmp_path, LAKE.format("drag 2 1/s") + HULL.format(shape=SLENDER, v="0.1, 0.1, 0", time=0.5)
    )
    lost = hull - hull[0]
    assert (lost[-1] < -0.4 * hull[0, 0]).all()
    np.testing.assert_allclose(solids, lost, atol=0.03 * hull[0, 0])
    assert np.abs(residual).max() < 0.2 * hull[0, 0] and np.abs(residual[-1]).max() < 0.065 * hull[0, 0]


def test_a_blunt_face_gives_the_liquid_more_than_it_loses(tmp_path):
    """Known limit of docs/physics-liquid.md: a box that starts with its face to the flow. The ledger shows it."""
    liquid, basin, solids, residual, hull = run(tmp_path, LAKE.format("") + HULL.format(shape=BLUNT, v="1.5, 0, 0", time=0.3))
    np.testing.assert_allclose(solids, hull - hull[0], atol=0.02 * hull[0, 0])
    assert residual[-1, 0] > 0.5 * -solids[-1, 0]
    assert residual[-1, 0] == pytest.approx((liquid + basin + solids)[-1, 0])


def test_what_comes_with_an_inflow_is_no_residual(tmp_path):
    """A jet along x: all that the liquid has it has brought."""
    jet = "inflow from (-1.8, -0.5, 0.2) m to (-1.5, 0.5, 0.3) m rate 0.2 m^3/s velocity (2, 0, 0) m/s"
    liquid, basin, solids, residual, _ = run(tmp_path, LAKE.format(jet) + HULL.format(shape=SLENDER, v="0, 0, 0", time=0.4))
    brought = 1000 * 0.2 * 2 * 0.4
    assert (liquid + basin + solids)[-1, 0] == pytest.approx(brought, rel=0.1)
    assert np.abs(residual).max() < 0.1 * brought


def test_what_a_liquid_at_rest_pushes_it_gets_from_its_basin(tmp_path):
    """A gate with water on one side, which is at rest for most of half a second. The gate goes on being pushed, and the walls as
    much the other way, also in the time that the liquid sleeps: the account is open by a tenth of it, else by nearly all."""
    text = (
        "gravity (0, 0, -9.81)\n"
        "liquid water { basin from (0, 0, 0) m to (1, 0.3, 0.6) m  density 1000  fill from (0, 0, 0) m to (0.45, 0.3, 0.6) m  "
        "level 0.3 m  calm 0.02 s }\n"
        "object gate { shape box (0.1, 0.3, 0.6) m  position (0.5, 0.15, 0.3) m  density 2000  elasticity 30 MPa  damping 1  "
        "hold face -z }\n"
        "control { time 0.6 s  resolution 5 cm  frames 40 fps }\n"
    )
    path = tmp_path / "scene.txt"
    path.write_text(text)
    result = Scene.load(path).run(tmp_path / "out", movie=False)
    basin, solids, residual = (np.array(result.ledger.array(n[0])) for n in (BASIN_IMPULSE, SOLID_IMPULSE, MOMENTUM_RESIDUAL))
    assert np.count_nonzero(solids[1:] == solids[:-1]) > 8, "it was to sleep"
    assert solids[-1] > 30.0 and basin[-1] == pytest.approx(-solids[-1], rel=0.15)
    assert np.abs(residual).max() < 0.15 * solids[-1]
