# SPDX-License-Identifier: GPL-2.0-only
"""A liquid without any object: it runs, alone and on executors, and is drawn and exported."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import SceneError, UsageError
from mdanim_lammps.export import export
from mdanim_lammps.picture.movie import render_still
from mdanim_lammps.scene.render import Render

RATE, WAY = 2 * np.pi * 1.5, 0.02
TANK = """
gravity (0, 0, -9.81) m/s^2
liquid water {
  basin from (0, 0, 0) m to (60, 20, 40) cm
  density 1000 kg/m^3
  level 20 cm
  drive oscillation (2, 0, 0) cm frequency 1.5 Hz
}
control { time 0.2 s  frames 100 fps  resolution 4 cm }
record energy.work
record liquid.height(0.01 m, 0.1 m)
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return Scene.from_text(TANK, "tank").run(tmp_path_factory.mktemp("alone") / "r")


def test_the_work_of_a_basin_is_that_of_its_acceleration(run):
    """-a p, integrated; the basin slows down, and the liquid leaves its rear."""
    p, t = run.ledger.array("liquid_momentum.x"), run.records["time"]
    power = WAY * RATE**2 * np.sin(RATE * t) * p
    assert run.records["energy.work"][-1] == pytest.approx(np.trapezoid(power, t), rel=0.05)
    assert run.records["liquid.height(0.01 m, 0.1 m)"][-1] < 0.19


def test_it_is_drawn_and_exported(run, tmp_path):
    render_still(run.folder, 5, tmp_path / "tank.png", Render(size=(64, 36)))
    assert export(run.folder, "gltf", tmp_path / "tank.glb").frames == 21
    with pytest.raises(UsageError, match="a liquid and no object"):
        export(run.folder, "csv", tmp_path / "tank.csv")


def test_a_picture_of_objects_is_refused():
    with pytest.raises(SceneError, match="arrows needs an object, and the scene has none"):
        Scene.from_text(TANK + "render { arrows velocity }", "tank").check()
