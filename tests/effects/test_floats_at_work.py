# SPDX-License-Identifier: GPL-2.0-only
"""Hulls that float dry, are swamped, sink and stay; what rolls over; floats on and beside each
other. Elastic bodies in waves, from scene text to LAMMPS; cells of 2.5 cm."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.liquid import frames as liquid
from mdanim_lammps.features.liquid.measure import immersed_depth, immersed_share
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

CELL = 0.025
LAKE = (
    "gravity (0, 0, -9.81)\n"
    "liquid lake {{ basin from (-40, -{half}, 0) cm to (40, {half}, {top}) cm  density 1000  level {level} cm  {more} }}\n"
    "control {{ time 20 s  resolution 2.5 cm }}\n"
)
PLANK = 5.0
"""Thickness of hulls [cm]: two cells."""


def open_box(x: float, y: float, z: float) -> str:
    """An open hull as an OBJ file, its middle at the origin [cm]; its planks are all of one thickness."""
    outer = np.array([(-x, -y), (x, -y), (x, y), (-x, y)]) / 2
    inner = outer - PLANK * np.sign(outer)
    rings = [(outer, -z / 2), (outer, z / 2), (inner, z / 2), (inner, PLANK - z / 2)]
    points = [(*corner, height) for ring, height in rings for corner in ring]
    sides = [(4 * r + k, 4 * r + (k + 1) % 4, 4 * r + 4 + (k + 1) % 4, 4 * r + 4 + k) for r in range(3) for k in range(4)]
    faces = [(0, 3, 2, 1), *sides, (12, 13, 14, 15)]
    lines = [f"v {a} {b} {c}" for a, b, c in points]
    lines += [f"f {a + 1} {b + 1} {c + 1}\nf {a + 1} {c + 1} {d + 1}" for a, b, c, d in faces]
    return "\n".join(lines) + "\n"


class Afloat:
    """A scene that runs, and what is seen of it."""

    def __init__(self, folder, objects: str, hull=(40, 30, 20), **lake):
        (folder / "hull.obj").write_text(open_box(*hull))
        (folder / "scene.txt").write_text(LAKE.format(**dict(half=25, top=60, level=30, more="") | lake) + objects)
        self.ready = prepare(load_scene(folder / "scene.txt"))
        self.system, self.grid, self.time = self.ready.system, self.ready.plan.grid, 0.0

    def __enter__(self):
        self.instance = Instance(self.ready.plan)
        self.instance.setup()
        return self

    def __exit__(self, *_):
        self.instance.close()

    def until(self, time: float):
        """Run until then [s]; no unit of liquid may be missing."""
        self.instance.run(round((time - self.time) / self.ready.certificate.timestep))
        self.time = time
        assert self.instance.fix_value("liquid", 0) == self.instance.fix_value("liquid", 1)
        return self

    def particles(self, name: str) -> slice:
        """Rows of an object."""
        n = self.system.names.index(name)
        return slice(self.system.first[n], self.system.first[n + 1])

    def draft(self, name: str) -> float:
        """[m]"""
        return immersed_depth(
            self.instance.array("x")[self.particles(name)], self.ready.plan.grid, liquid.heights(self.instance)[0]
        )

    def immersed(self, name: str) -> float:
        """Share below the surface [-]."""
        own, corner = self.particles(name), self.system.hexahedron
        corner = corner[(corner[:, 0] >= own.start) & (corner[:, 0] < own.stop)]
        return immersed_share(self.instance.array("x")[corner], self.grid, liquid.heights(self.instance)[0])

    def lowest(self, name: str) -> float:
        """Height of its lowest particle [m]."""
        return self.instance.array("x")[self.particles(name), 2].min()

    def middle(self, name: str) -> float:
        """Height of the mean of its particles [m]."""
        return self.instance.array("x")[self.particles(name), 2].mean()

    def fastest(self) -> float:
        """Largest component of a velocity [m/s]."""
        return np.abs(self.instance.array("v")).max()

    def held_inside(self, name: str, inner=(30, 20)) -> float:
        """Liquid over the inside of a hull and above its bottom [m^3]: whole cells that are wet."""
        grid, x = self.grid, self.instance.array("x")[self.particles(name)]
        middle, half = x[:, :2].mean(axis=0), np.array(inner) / 200
        columns = [grid.low[d] + (np.arange(grid.shape[d]) + 0.5) * grid.cell[d] for d in range(3)]
        within = [np.abs(c - m) < h - CELL / 2 for c, m, h in zip(columns, middle, half)]
        wet = liquid.cells(self.instance) == 1
        above = columns[2] > x[:, 2].min() + PLANK / 100
        return np.count_nonzero(wet[np.ix_(above, within[1], within[0])]) * CELL**3


SOFT = "elasticity 100 kPa  damping 0.1"
HULL = f'object hull {{{{ shape mesh "hull.obj" scale 0.01  position (0, 0, {{z}}) cm  density {{density}}  {SOFT} }}}}\n'
LOAD = f"object load {{{{ shape box (10, 10, 10) cm  position (0, 0, 36.5) cm  density {{density}}  {SOFT} }}}}\n"
FILL = "fill from (-40, -25, 0) cm to (40, 25, 50) cm"
WIDE = "fill from (-40, -60, 0) cm to (40, 60, 50) cm"
SETTLE = "calm 0.5 s  drag 10 1/s"


def test_a_hull_with_a_light_load_floats_dry(tmp_path):
    """As deep as Archimedes says of hull and load, 10 cm: to 2 % of its length, as its soft bottom sags."""
    objects = HULL.format(z=35.2, density=700) + LOAD.format(density=1500)
    with Afloat(tmp_path, objects, more=SETTLE) as scene:
        scene.until(2.0)
        assert scene.held_inside("hull") == 0.0
        assert scene.draft("hull") == pytest.approx(0.10, abs=0.008)
        assert scene.fastest() < 0.05


@pytest.mark.parametrize(
    ("z", "more", "full"),
    [
        pytest.param(30.0, "", False, id="rim above the level"),
        pytest.param(18.0, "", True, id="rim below it"),
        pytest.param(30.0, "hold all", True, id="held"),
        pytest.param(30.0, "fill", True, id="asked for"),
    ],
)
def test_a_hull_is_dry_at_the_start_where_its_rim_is_above_the_level(tmp_path, z, more, full):
    """Held objects are part of the basin. Room that liquid could flow into, and that of `fill`, is full up to the level, too."""
    fill, more = (FILL, "") if more == "fill" else ("", more)
    with Afloat(tmp_path, HULL.replace("elasticity", more + " elasticity").format(z=z, density=700), more=fill) as scene:
        assert (scene.held_inside("hull") > 0.001) == full


def test_a_hull_that_begins_afloat_floats_on(tmp_path):
    """Dry, and as deep as in the test above; a hull of full height would have sunk."""
    objects = HULL.format(z=30.0, density=700) + LOAD.format(density=1500).replace("36.5", "31.3")
    with Afloat(tmp_path, objects, more=SETTLE) as scene:
        scene.until(2.0)
        assert scene.held_inside("hull") == 0.0
        assert scene.draft("hull") == pytest.approx(0.10, abs=0.008)


def test_a_hull_with_a_heavy_load_sinks_and_stays_on_the_floor(tmp_path):
    """The load presses its rim under: it fills, sinks, and lies there full of liquid."""
    objects = HULL.format(z=35.2, density=700) + LOAD.format(density=14000)
    with Afloat(tmp_path, objects, more=SETTLE) as scene:
        scene.until(1.5)
        for time in (2.0, 2.5):
            scene.until(time)
            assert scene.lowest("hull") < CELL / 2 and scene.immersed("hull") == scene.immersed("load") == 1.0
        assert scene.held_inside("hull") > 0.004  # of 9 litres, less what the load fills and where it leans
        assert scene.fastest() < 0.1


@pytest.mark.parametrize("swell", [False, True])
def test_waves_over_the_rim_sink_a_laden_hull(tmp_path, swell):
    """Four centimetres of freeboard do in still water. Waves of 10 cm go over them."""
    waves = "wave -x amplitude 10 cm period 0.9 s" if swell else ""
    with Afloat(tmp_path, HULL.format(z=35.2, density=1250), more=f"{SETTLE} {waves}") as scene:
        scene.until(7.0 if swell else 2.0)
        if swell:
            assert scene.lowest("hull") < CELL / 2 and scene.immersed("hull") > 0.95 and scene.held_inside("hull") > 0.006
        else:
            assert scene.draft("hull") == pytest.approx(0.15625, abs=0.01) and scene.held_inside("hull") == 0.0


def test_a_hull_that_stands_full_on_the_floor_stays(tmp_path):
    """It is taller than the lake is deep; empty it would float on 15 cm."""
    objects = HULL.format(z=12.55, density=1100).replace("100 kPa", "400 kPa")
    with Afloat(tmp_path, objects, hull=(40, 40, 25), level=20, top=50, half=25, more=f"{SETTLE} {FILL}") as scene:
        for time in (1.0, 1.5):
            scene.until(time)
            assert scene.held_inside("hull", (30, 30)) > 0.008 and scene.lowest("hull") < 0.4 * CELL


def test_a_hull_that_a_drain_empties_lifts_off_the_floor(tmp_path):
    """It stands there full; empty it bobs for a while, then floats as deep as Archimedes says, 15.1 cm, to a tenth of a cell.

    The depth is that of the middle of its bottom: it rocks by a degree, by which a corner is up to 7 mm deeper. Single units of
    16 ml come and go while it bobs, 0 to 8 of them in 2 to 8 s.
    """
    objects = HULL.format(z=12.55, density=1100).replace("100 kPa", "400 kPa")
    drain = "drain from (-12, -12, 5.5) cm to (12, 12, 10) cm  rate 8 l/s"
    with Afloat(tmp_path, objects, hull=(40, 40, 25), level=16, top=50, half=60, more=f"{SETTLE} {WIDE} {drain}") as scene:
        assert scene.until(0.3).lowest("hull") < 0.001 and scene.held_inside("hull", (30, 30)) > 0.002
        above_bottom = scene.middle("hull") - scene.lowest("hull")
        scene.until(5.0)
        bottom = scene.middle("hull") - above_bottom
        assert bottom > 0.008 and scene.lowest("hull") > 0.002 and scene.held_inside("hull", (30, 30)) < 0.0002
        assert scene.draft("hull") + scene.lowest("hull") - bottom == pytest.approx(0.151, abs=0.0025)


PLATE = (
    "object plate {{ shape box (45, 20, 10) cm  position (0, 0, 40) cm  orientation euler (0, {lean}, 0) deg  density 500  "
    "elasticity 100 kPa  damping 0.1 }}\n"
)


@pytest.mark.parametrize("lean", [3, 87])
def test_a_plate_floats_flat_however_it_starts(tmp_path, lean):
    """Half as thick as broad, of half the density: on end it rolls over, flat it stays flat, to 3 degrees."""
    with Afloat(tmp_path, PLATE.format(lean=lean), level=40, top=80, more="calm 0.5 s") as scene:
        own = scene.particles("plate")
        across = lambda: np.linalg.svd(scene.instance.array("x")[own] - scene.instance.array("x")[own].mean(axis=0))[2][2]
        assert abs(across()[2]) == pytest.approx(np.cos(np.radians(lean)), abs=0.01)
        scene.until(3.0)
        assert abs(across()[2]) > np.cos(np.radians(3.0))
        assert scene.immersed("plate") == pytest.approx(0.5, abs=0.02)
        assert scene.draft("plate") == pytest.approx(0.05, abs=0.015)


BOX = (
    "object {name} {{ shape box ({side}, {side}, 10) cm  position ({place}) cm  velocity ({v}, 0, 0) m/s  density {density}  "
    "elasticity 100 kPa  damping 0.1  friction 0.3 }}\n"
)


def test_one_float_carries_another(tmp_path):
    """As deep as Archimedes says of both: 6 kg on 0.16 m^2 are 3.75 cm, to 1 mm."""
    raft = BOX.format(name="raft", side=40, place="0, 0, 21.5", v=0, density=300)
    crate = BOX.format(name="crate", side=20, place="0, 0, 31.6", v=0, density=300)
    with Afloat(tmp_path, raft + crate, level=20, top=50, half=30, more="calm 0.5 s") as scene:
        scene.until(1.0)
        assert scene.draft("raft") == pytest.approx(0.0375, abs=0.001)
        assert scene.immersed("crate") == 0.0 and scene.lowest("crate") == pytest.approx(scene.lowest("raft") + 0.1, abs=0.002)
        assert scene.fastest() < 0.02


def test_floats_that_run_into_each_other_part_and_come_to_rest(tmp_path):
    """Beside the middle of their faces, so they turn and rub; each then floats as deep as alone, and none is in the other."""
    left = BOX.format(name="left", side=15, place="-11, 1, 22", v=0.8, density=400)
    right = BOX.format(name="right", side=15, place="11, -1, 22", v=-0.8, density=400)
    with Afloat(tmp_path, left + right, level=20, top=50, half=30, more="calm 0.5 s") as scene:
        x = lambda name: scene.instance.array("x")[scene.particles(name), 0]
        nearest = 1.0
        for time in np.arange(0.05, 1.0, 0.05):
            nearest = min(nearest, x("right").min() - x("left").max())
            scene.until(time)
        assert nearest < 0.1 * CELL, "they were to meet"
        scene.until(3.0)
        assert scene.fastest() < 0.04
        assert scene.immersed("left") == pytest.approx(0.4, abs=0.02) == scene.immersed("right")
        assert x("right").mean() - x("left").mean() > 0.145
