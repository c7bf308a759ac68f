# SPDX-License-Identifier: GPL-2.0-only
"""Waves, currents, inflows and drains of a scene, from its text to LAMMPS: each accounted to the unit."""

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.liquid.frames import AT_START, HIGHEST, NOW, OUTER
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

TANK = """
gravity (0, 0, -10) m/s^2
control { resolution 10 cm  time 10 s  frames 10 fps }
liquid water {
  basin from (0, 0, 0) m to (4, 1, 1.6) m
  density 1000 kg/m^3
  level 0.8 m
  MODEL
  MAKERS
}
object cork { shape box (30 cm, 30 cm, 30 cm)  position (2, 0.5, 0.8) m  density 300 kg/m^3  elasticity 100 kPa }
"""


def tank(*makers, model="model waves"):
    """A tank of 40 x 10 columns, half full, with a cork."""
    return prepare(parse_scene(TANK.replace("MODEL", model).replace("MAKERS", "\n  ".join(makers))))


def run(ready, seconds, looks=10):
    """Cells of liquid, cells that must be there, the crest and the energy from outside at each look, shape (looks, 4)."""
    found = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(looks):
            instance.run(round(seconds / looks / ready.certificate.timestep))
            found.append([instance.fix_value("liquid", n) for n in (NOW, AT_START, HIGHEST, OUTER)])
        return np.array(found)


def test_an_inflow_and_a_drain_run_at_their_rates():
    """2 l/s in and 0.5 l/s out: 1.5 cells a second, to the unit at any time, with the energy of its height."""
    found = run(
        tank(
            "inflow from (3, 0.2, 1) m to (3.5, 0.8, 1) m  rate 0.002 m^3/s  velocity (1, 0, 0) m/s",
            "drain from (0, 0, 0) m to (1, 1, 0.1) m  rate 0.0005 m^3/s",
        ),
        2.0,
    )
    assert (found[:, 0] == found[:, 1]).all()
    assert found[-1, 0] - found[0, 0] == pytest.approx(1.5 * 1.8, rel=0.02)
    lifted = 10.0 * (found[-1, 0] - found[0, 0]) * 0.8
    assert found[-1, 3] - found[0, 3] == pytest.approx(lifted, rel=0.02)


@pytest.mark.parametrize("model", ["model waves", "model surface"])
def test_pools_are_full_to_their_tops(model):
    """Behind a gate the level, before it a wet floor: the volume at the start is that of both."""
    filled = "fill from (0, 0, 0) m to (1, 1, 1.6) m"
    found = run(tank(filled, "pool from (1, 0, 0) m to (4, 1, 0.2) m", model=model), 0.01, 1)
    assert found[0, 0] == 10 * 10 * 8 + 30 * 10 * 2


def test_a_thin_layer_on_ground_is_a_surface():
    """Three tenths of a cell of water on a held slab have the level that they would have over the floor."""
    slab = "object slab { shape box (4.4, 1.4, 0.2) m  position (2, 0.5, 0.1) m  density 2000  elasticity 1 MPa  hold all }"
    water = TANK[: TANK.index("object cork")].replace("MODEL", "").replace("MAKERS", "").replace("level 0.8 m", "level 0.23 m")
    with Instance(prepare(parse_scene(water + slab)).plan) as instance:
        instance.setup()
        assert instance.fix_value("liquid", "level") == pytest.approx(0.23, abs=1e-3)


@pytest.mark.parametrize(("rate", "told"), [("2 l/s", False), ("4 m^3/s", True)])
def test_an_inflow_without_room_is_told(tmp_path, rate, told):
    """3.2 m^3 of room, less the cork: what found none is told at the end, with what came."""
    text = TANK.replace("MODEL", "").replace("MAKERS", f"inflow from (3, 0.2, 1) m to (3.5, 0.8, 1) m  rate {rate}")
    path = tmp_path / "tank.txt"
    path.write_text(text.replace("time 10 s", "time 1 s"))
    done = Scene.load(path).run(tmp_path / "out", movie=False)
    found = [w for w in done.warnings if "came in" in w.message]
    assert len(found) == told
    last = done.ledger.rows[-1]
    assert last["work"] > 0.0 and 0.0 <= last["wave_loss"] < 0.1 * last["work"]
    if told:
        assert "of 4 m^3 came in" in found[0].message and "drain" in found[0].hint


def test_a_wave_runs_through_the_tank():
    """With crests of its amplitude, before it comes back from the other end; and none without it."""
    calm = run(tank(), 3.0, looks=30)
    found = run(tank("wave -x amplitude 5 cm period 1 s"), 3.0, looks=30)
    assert (found[:, 0] == found[:, 1]).all() and (calm[:, 0] == calm[0, 0]).all()
    assert 0.03 < (found[:, 2] - calm[:, 2]).max() < 0.08


def test_a_current_carries_a_cork_and_changes_no_sum():
    """Along with the liquid."""
    ready = tank("current -x speed 0.3 m/s")
    with Instance(ready.plan) as instance:
        instance.setup()
        before = ready.system.center_of_mass(instance.array("x"))[0]
        cells = instance.fix_value("liquid", NOW)
        instance.run(round(4.0 / ready.certificate.timestep))
        after = ready.system.center_of_mass(instance.array("x"))[0]
        assert instance.fix_value("liquid", NOW) == cells == instance.fix_value("liquid", AT_START)
    assert after[0] - before[0] > 0.3 and abs(after[1] - before[1]) < 0.1


@pytest.mark.parametrize(
    ("maker", "model", "message"),
    [
        ("wave -x amplitude 5 cm period 1 s", "model surface", "model surface has no wave"),
        ("wave -x amplitude 0 cm period 1 s", "model waves", "must be > 0"),
        ("wave -z amplitude 5 cm period 1 s", "model waves", "-z"),
        ("current +y speed -1 m/s", "model waves", "must be > 0"),
        ("drain from (5, 0, 0) m to (6, 1, 1) m rate 0.001 m^3/s", "model waves", "is not a part of the basin"),
        ("inflow from (1, 0, 0) m to (0.5, 1, 1) m rate 0.001 m^3/s", "model waves", "is not a part of the basin"),
        ("inflow from (1, 0, 0) m to (2, 1, 1) m rate 0 m^3/s", "model waves", "the rate of the inflow must be > 0"),
    ],
)
def test_makers_that_cannot_be_are_refused(maker, model, message):
    """At their line, with what was found."""
    with pytest.raises(SceneError, match=message.replace("(", r"\(")):
        tank(maker, model=model)
