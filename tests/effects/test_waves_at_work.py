# SPDX-License-Identifier: GPL-2.0-only
"""Elastic bodies in a liquid with momentum, from scene text to LAMMPS, against closed forms.

Units of scenes/lab/cube.txt: spacing 1, liquid of density 1000, elasticity 1000 Pa is a wave speed of about 1.
"""

from dataclasses import replace

import heave
import numpy as np
import pytest
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.liquid import frames as liquid
from mdanim_lammps.features.liquid.frames import WAVES
from mdanim_lammps.features.liquid.ledger import LIQUID_MOMENTUM
from mdanim_lammps.features.liquid.measure import immersed_share
from mdanim_lammps.features.liquid.record import LiquidModel
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene, parse_scene
from paths import SCENES
from twin import in_waves
from waves_forms import swings

CUBE = SCENES / "lab" / "cube.txt"
UNITS, START, UPDATES = 0, 1, 4


def scene(drag=0.02, calm=200.0, model=LiquidModel.WAVES, **lets):
    """A cube of 6^3 cells over a pool of 20 x 20 cells; ``lets`` as in the file."""
    found = load_scene(CUBE, overrides=lets)
    return prepare(replace(found, liquid=replace(found.liquid, drag=drag, calm=calm, model=model)))


def force(ready, instance) -> np.ndarray:
    """Force of the liquid on all that floats, over the weight of the liquid that it could displace, shape (3,)."""
    system, dt = ready.system, ready.certificate.timestep
    before = system.center_of_mass(instance.array("v"))[0]
    instance.run(1)
    gained = (system.center_of_mass(instance.array("v"))[0] - before) / dt - np.array(ready.scene.gravity)
    return system.mass.sum() * gained / (1000.0 * system.volume.sum() * -ready.scene.gravity[2])


@pytest.mark.parametrize("way", [dict(roll=20, pitch=35, yaw=10), dict(z=8.3), dict(z=5.0, roll=45)])
def test_at_rest_lift_is_archimedes_and_nothing_pushes_sideways(way):
    """Under water, in any attitude: the weight of what is displaced within 1 %; straight up to a unit of liquid."""
    ready = scene(density=500, **{"z": 7.5, **way})
    with Instance(ready.plan) as instance:
        instance.setup()
        found = force(ready, instance)
    assert found[2] == pytest.approx(1.0, abs=0.01)
    assert np.abs(found[:2]).max() < 1e-6


@pytest.mark.parametrize("z", [15.5, 12.3, 11.5])
@pytest.mark.parametrize("way", [dict(roll=20, pitch=35, yaw=10), dict(roll=13, pitch=52, yaw=70)])
def test_lift_is_the_weight_of_what_is_below_the_surface(way, z):
    """Lift of a tilted cube of 6 cells, to 0.3 % of its volume; particles alone, with cells half beyond the faces, miss 1 %."""
    ready = scene(density=500, young=1e5, z=z, **way)
    with Instance(ready.plan) as instance:
        instance.setup()
        corner = instance.array("x")[ready.system.hexahedron]
        found = force(ready, instance)[2]
    part = (np.arange(6) + 0.5) / 6
    below = sum(
        (corner[:, 0, 2] + u * (corner[:, 1, 2] - corner[:, 0, 2]) + v * (corner[:, 3, 2] - corner[:, 0, 2])
         + w * (corner[:, 4, 2] - corner[:, 0, 2]) < 14.0).sum()
        for u in part for v in part for w in part
    )  # fmt: skip
    assert found == pytest.approx(below / 6**6, abs=0.003)


@pytest.mark.parametrize("density", [500, 3000])
@pytest.mark.parametrize("z", [15.5, 7.5])
def test_forces_are_those_of_the_twin(z, density):
    """Lift by parts of cells, quadratic drag and what calms solids, of a cube that moves and turns, partly or wholly in."""
    ready = scene(drag=None, density=density, young=1e5, z=z, roll=20, pitch=35, yaw=10)
    system, grid, g = ready.system, ready.plan.grid, -ready.scene.gravity[2]
    away = system.position - system.center_of_mass(system.position)[system.object]
    v = np.array([0.3, -0.2, -0.5]) + np.cross([0.04, 0.06, -0.1], away)
    with Instance(ready.plan) as instance:
        instance.array("v")[:] = v
        instance.setup()
        found = instance.array("f").copy()
    found -= system.mass[:, None] * np.array(ready.scene.gravity)
    columns = ready.plan.columns
    twin = in_waves.forces(
        system.position - grid.low, v, system.hexahedron, system.volume, system.mass, 14.0 - grid.low[2], grid.cell[0], g, 1000.0,
        columns["quadratic"],
    )  # fmt: skip
    # The level rises by what is displaced; columns know velocities in units of 2^-24: both below 2e-3 of the largest lift.
    np.testing.assert_allclose(found, twin, atol=2e-3 * 1000.0 * g)


def test_what_floats_at_rest_stays_at_rest():
    """A cube on its corner creeps for a while: liquid that looks at it again does not kick it, nor wake for good."""
    ready = scene(calm=20.0, drag=0.1, density=500, z=14.0, roll=45, pitch=35.26)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(int(250 / ready.certificate.timestep))
        before, fastest = instance.fix_value("liquid", UPDATES), 0.0
        for _ in range(60):
            instance.run(int(10 / ready.certificate.timestep))
            fastest = max(fastest, np.abs(ready.system.center_of_mass(instance.array("v"))).max())
        assert instance.fix_value("liquid", UPDATES) - before < 60
    assert fastest < 1e-4 * (9 * 0.01) ** 0.5


@pytest.mark.parametrize("draft", [pytest.param(2, marks=pytest.mark.soak), 3])
def test_a_cube_bobs_as_in_a_flow_with_vertical_motion(draft):
    """The first fall and the period are within 10 % of those in linear potential flow."""
    side, depth, width, above = 6, 10, 24, 0.9
    density = 1000 * draft / side
    ready = scene(
        drag=1e-9, calm=1e6, density=density, half=width / 2, level=depth, top=depth + side, z=depth + side / 2 - draft + above
    )
    exact = swings(heave.bobbing(side, draft, width, depth, fine=2, time=20), draft)
    path = []
    with Instance(ready.plan) as instance:
        instance.setup()
        steps = max(1, int(0.25 / ready.certificate.timestep))
        dt = steps * ready.certificate.timestep * 0.1
        for _ in range(int(20 / dt)):
            instance.run(steps)
            path.append(ready.system.center_of_mass(instance.array("x"))[0][2] - (depth + side / 2 - draft))
    found = swings(np.array(path) / above, draft, dt)
    assert found.fall == pytest.approx(exact.fall, rel=0.1)
    assert found.period == pytest.approx(exact.period, rel=0.1)


@pytest.mark.parametrize("density", [1200, 1500])
def test_a_body_on_the_floor_gets_no_energy_from_the_liquid(density):
    """It rocks on an edge for a while, lies down, and stays; the liquid never has given more than it had."""
    ready = scene(density=density, z=8, roll=10, pitch=20)
    potential = 1000 * 216 * 0.01
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(15):
            instance.run(int(40 / ready.certificate.timestep))
            assert instance.fix_value("liquid", WAVES) - instance.fix_scalar("liquid") < 0.1 * potential
        v = instance.array("v")
    assert 0.5 * (ready.system.mass * (v**2).sum(axis=1)).sum() < 0.002 * potential


def test_the_surface_at_a_body_is_that_around_it():
    """A cube falls in; below it the head is that of the pressure there, cells higher, but that is not a surface."""
    ready = scene(density=500, z=18.5)
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(12):
            instance.run(int(2 / ready.certificate.timestep))
            height = liquid.heights(instance)[0]
            at_body = np.zeros(height.shape, bool)
            at_body[7:13, 7:13] = True
            assert height[at_body].max() < height[~at_body].max() + 0.2


def test_energy_goes_from_a_body_to_waves_and_is_accounted():
    """A cube falls in: waves have what it lost, the sum of the ledger stays, and to the unit the liquid does."""
    ready = scene(density=800, z=22, young=3000)
    with Instance(ready.plan) as instance:
        instance.setup()
        gravity = lambda: -(ready.system.mass @ instance.array("x")[:, 2]) * ready.scene.gravity[2]
        start, found = gravity(), []
        for _ in range(30):
            instance.run(int(10 / ready.certificate.timestep))
            assert instance.fix_value("liquid", UNITS) == instance.fix_value("liquid", START)
            found.append((gravity() - start, instance.fix_value("liquid", WAVES), -instance.fix_scalar("liquid")))
        lost, waves, work = np.array(found).T
    potential = 1000 * 216 * 0.01  # weight of as much liquid, times a cell
    # Waves have what the liquid's push has taken from the body; a part of it may come of the impact, docs/physics-liquid.md.
    assert (waves + work < 0.15 * waves.max()).all(), "the liquid has more than it got"
    assert waves.max() > 5 * potential
    assert lost.min() < -5 * potential


def test_momentum_goes_from_a_body_to_the_liquid(tmp_path):
    """A gliding hull loses what the liquid gains, until a wave comes to a wall: to 5 %, because the push is smoothed in time."""
    path = tmp_path / "glide.txt"
    path.write_text(
        "gravity (0, 0, -9.81)\nliquid lake { basin from (-2, -1.5, 0) m to (2, 1.5, 0.8) m  density 1000  level 0.4 m }\n"
        "object hull { shape ellipsoid (50, 16, 16) cm  position (0, 0, 0.4) m  velocity (1.5, 0, 0) m/s  density 500  "
        "elasticity 400 kPa }\ncontrol { time 0.3 s  resolution 5 cm  frames 40 fps }\n"
    )
    result = Scene.load(path).run(tmp_path / "out", movie=False)
    liquid = np.stack([result.ledger.array(name) for name in LIQUID_MOMENTUM], axis=-1)
    hull = Trajectory(result.folder).objects["hull"]
    solid = hull.mass * np.asarray(hull.velocity)[:, :2]
    assert liquid[0] == pytest.approx(0.0) and liquid[-1, 0] > 0.25 * solid[0, 0]
    np.testing.assert_allclose(solid[:, 0] + liquid[:, 0], solid[0, 0], rtol=0.05)
    assert np.abs(solid[:, 1] + liquid[:, 1]).max() < 0.02 * solid[0, 0]


def test_a_shallow_liquid_is_told():
    """Under four cells deep at the start, a dam's part of the basin counted; a deep one is not told."""
    told = [w for w in scene(level=3).warnings if "deep" in w.message]
    assert len(told) == 1 and "3 cells deep" in told[0].message and "resolution" in told[0].hint
    assert not [w for w in scene(level=5).warnings if "deep" in w.message]


def test_what_is_too_light_for_waves_is_told():
    """Below a tenth of the density of the liquid; not where another model lifts it."""
    told = [w for w in scene(density=50).warnings if "as dense as" in w.message]
    assert len(told) == 1 and told[0].message.startswith("cube: 0.05 times as dense as") and "100 kg/m^3" in told[0].hint
    assert not [w for w in scene(density=100).warnings if "as dense as" in w.message]
    assert not [w for w in scene(density=99.9999999999).warnings if "as dense as" in w.message]
    assert not [w for w in scene(density=50, model=LiquidModel.SURFACE).warnings if "as dense as" in w.message]


@pytest.mark.parametrize("density", [300, 500, 700, 900])
@pytest.mark.parametrize("way", [dict(z=3.2), dict(z=6.0, roll=20, pitch=30)], ids=["upright", "tilted"])
def test_a_cube_from_the_bottom_floats_as_deep_as_archimedes_says(way, density):
    """Within 2 % of the side, what a body of 6 cells can do, when it has come to rest."""
    ready = scene(drag=0.1, calm=50.0, density=density, **way)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(int(2000 / ready.certificate.timestep))
        x = instance.array("x")
        found = immersed_share(x[ready.system.hexahedron], ready.plan.grid, liquid.heights(instance)[0])
        assert np.abs(instance.array("v")).max() < 2e-2
    assert found == pytest.approx(density / 1000, abs=0.02)


def test_a_flow_carries_what_floats_along():
    """A dam breaks beside a float: the flow takes it along, and the waves that come back turn it round."""
    found = load_scene(CUBE, overrides=dict(half=16, level=8, top=20, z=9.0, density=300))
    dam = replace(found.liquid, drag=0.05, model=LiquidModel.WAVES, fill=((-16.0, -16.0, 0.0), (4.0, 16.0, 20.0)), level=14.0)
    ready = prepare(replace(found, liquid=dam))
    with Instance(ready.plan) as instance:
        instance.setup()
        way = []
        for _ in range(20):
            instance.run(int(10 / ready.certificate.timestep))
            way.append(ready.system.center_of_mass(instance.array("x"))[0, 0] - 0.3)
        aside = ready.system.center_of_mass(instance.array("x"))[0, 1] + 0.2
    assert max(way) > 3.0
    assert abs(aside) < 1.0


def behind(wall: str, fill: str, side) -> float:
    """Cells of liquid [-] on one side of a wall that is held, after a second; ``side`` takes middles of cells [cells]."""
    ready = prepare(
        parse_scene(
            f"gravity (0, 0, -9.81)\n"
            f"liquid water {{ basin from (0, 0, 0) cm to (50, 40, 60) cm density 1000 {fill} }}\n"
            f"object wall {{ {wall} density 2000 elasticity 10 MPa hold all }}\n"
            "control { time 2 s resolution 2.5 cm }\n"
        )
    )
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(int(1.0 / ready.certificate.timestep))
        wet = liquid.cells(instance) == 1
    z, y, x = np.indices(wet.shape) + 0.5
    assert wet.sum() > 500
    return np.count_nonzero(wet & side(x, y, z))


@pytest.mark.parametrize("x", [25.0, 25.6, 26.25, 26.9])
@pytest.mark.parametrize("turn", [0.0, 30.0])
def test_upright_walls_of_one_cell_hold(x, turn):
    """On the grid and off it, turned about the vertical or not: nothing gets to the other side."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    wall = f"shape box (2.5, 120, 130) cm position ({x}, 20, 30) cm orientation euler (0, 0, {turn}) deg"
    fill = f"level 30 cm fill from (0, 0, 0) cm to ({x - 1.3 / c - 20 * s / c}, 40, 60) cm"
    assert behind(wall, fill, lambda i, j, k: (2.5 * i - x) * c + (2.5 * j - 20.0) * s > 4.0) == 0


@pytest.mark.parametrize(("turn", "shift"), [(10.0, 0.0167), (30.0, 0.0167), (0.0, 0.03)])
def test_a_cup_of_held_boxes_holds(turn, shift):
    """Walls and bottom of one cell, turned about the vertical, off the grid: after a second all of its 24 l are in it."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    sides = [("(0.05, 0.6, 0.45)", x * c, x * s) for x in (-0.275, 0.275)]
    sides += [("(0.6, 0.05, 0.45)", -y * s, y * c) for y in (-0.275, 0.275)]
    boxes = [("(0.6, 0.6, 0.05)", 0.0, 0.0, 0.1), *((size, x, y, 0.35) for size, x, y in sides)]
    held = "\n".join(
        f"object b{n} {{ shape box {size} m  position ({x}, {y}, {z + shift}) m  orientation euler (0, 0, {turn}) deg  "
        f"density 1000  elasticity 1 MPa  hold all }}"
        for n, (size, x, y, z) in enumerate(boxes)
    )
    ready = prepare(
        parse_scene(
            "gravity (0, 0, -9.81)\nliquid water { basin from (-0.6, -0.6, 0) m to (0.6, 0.6, 0.8) m  density 1000  "
            f"fill from (-0.17, -0.17, 0.15) m to (0.17, 0.17, 0.45) m  volume 24 l }}\n{held}\n"
            "control { time 10 s  resolution 5 cm }\n"
        )
    )
    assert not ready.warnings
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(int(1.0 / ready.certificate.timestep))
        wet = liquid.cells(instance) == 1
    z, y, x = np.indices(wet.shape)
    x, y = 0.05 * (x + 0.5) - 0.6, 0.05 * (y + 0.5) - 0.6
    inside = (np.maximum(np.abs(x * c + y * s), np.abs(y * c - x * s)) < 0.3) & (z > 1)
    assert wet.sum() > 150 and not wet[~inside].any()


SHELF = "shape box (90, 90, {t}) cm position (25, 20, {z}) cm orientation euler ({tilt}, 0, 0) deg"


def below_shelf(t: float, z: float, tilt: float) -> float:
    """Cells of liquid below a shelf of thickness t [cm] at height z [cm]."""
    top = z + t / 2 + 7.5 * (tilt > 0.0)
    fill = f"level {top + 10.0} cm fill from (0, 0, {top + 0.1}) cm to (50, 40, 60) cm"
    return behind(SHELF.format(t=t, z=z, tilt=tilt), fill, lambda i, j, k: 2.5 * k < z - 10.0)


@pytest.mark.parametrize("t", [2.5, 5.0])
@pytest.mark.parametrize("z", [20.0, 20.6, 21.25, 21.9])
@pytest.mark.parametrize("tilt", [0.0, 5.0, 20.0])
def test_shelves_hold(t, z, tilt):
    """Shelves of one or two cells, flat and tilted, at any height: nothing drips through."""
    assert below_shelf(t, z, tilt) == 0


@pytest.mark.parametrize(("x", "leaks"), [(25.0, False), (26.25, True)])
def test_a_thin_wall_that_leans_leaks(x, leaks):
    """As `check` warns: hundreds of cells get through a wall of one cell that leans by 20 degrees, by how it stands on the grid.
    At 25 cm its columns are cut as those below a plate, and it holds."""
    wall = f"shape box (2.5, 120, 130) cm position ({x}, 20, 30) cm orientation euler (0, 20, 0) deg"
    x_of_wall = lambda k: x + (2.5 * k - 30.0) * np.tan(np.radians(20.0))
    through = behind(wall, "level 30 cm fill from (0, 0, 0) cm to (12, 40, 60) cm", lambda i, j, k: 2.5 * i > x_of_wall(k) + 5.0)
    assert through > 300 if leaks else through == 0
