# SPDX-License-Identifier: GPL-2.0-only
"""Room for liquid beside solids, against what the plugin finds; liquid without room is refused at its line."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.liquid.basin import plan_grid
from mdanim_lammps.features.liquid.frames import NOW
from mdanim_lammps.features.liquid.occupied import filled, room
from mdanim_lammps.model.spacing import choose_spacing
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

CUP = """
gravity (0, 0, -9.81) m/s^2
liquid water {{ basin from (-0.6, -0.6, 0) m to (0.6, 0.6, 0.8) m  density 1000 kg/m^3  model {model}
  fill from (-0.24, -0.24, 0.11) m to (0.24, 0.24, 0.45) m  {amount} }}
{boxes}
control {{ time 1 s  frames 5 fps  resolution 5 cm }}
"""


def cup(amount, at=(0.0, 0.0), turn=0.0, bottom=0.1, model="waves") -> str:
    """A scene of five held boxes, walls of 10 cm, and liquid between them."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    boxes = [(0.6, 0.6, 0.1, 0.0, 0.0, bottom)]
    boxes += [(0.1, 0.6, 0.6, x, 0.0, bottom + 0.35) for x in (-0.25, 0.25)]
    boxes += [(0.4, 0.1, 0.6, 0.0, y, bottom + 0.35) for y in (-0.25, 0.25)]
    return CUP.format(
        model=model,
        amount=amount,
        boxes="\n".join(
            f"object b{n} {{ shape box ({a}, {b}, {h}) m  position ({x * c - y * s + at[0]}, {x * s + y * c + at[1]}, {z}) m  "
            f"orientation euler (0, 0, {turn}) deg  density 1000  elasticity 1 MPa  hold all }}"
            for n, (a, b, h, x, y, z) in enumerate(boxes)
        ),
    )


def poured(text: str) -> tuple[float, float]:
    """Cells of liquid that the plugin pours, and the room that is told."""
    ready = prepare(parse_scene(text))
    liquid = ready.scene.liquid
    with Instance(ready.plan) as instance:
        instance.setup()
        cells = instance.fix_value("liquid", NOW)
    return cells, room(ready.plan.grid, ready.models, liquid.model, *liquid.fill, liquid.level)


@pytest.mark.parametrize(
    "way", [dict(), dict(at=(0.013, 0.02)), dict(turn=20.0), dict(at=(0.02, 0.01), turn=45.0, bottom=0.117)], ids=str
)
@pytest.mark.parametrize("model", ["waves", "surface"])
def test_room_is_what_the_plugin_fills(way, model):
    """Up to a level: waves to a cell, as what is open of shut cells at the ends of spans is theirs; the automaton to half a cell
    in each layer."""
    cells, told = poured(cup("level 0.33 m", model=model, **way))
    assert cells == pytest.approx(told, abs=1.0 if model == "waves" else 4.0)
    assert told > 50


@pytest.mark.parametrize("way", [dict(at=(0.013, 0.02)), dict(turn=20.0), dict(at=(0.004, 0.022), bottom=0.083)], ids=str)
def test_a_level_at_the_brim_is_as_much_as_there_is_room_for(way):
    """The nearest whole number of cells may be more than that."""
    cells, told = poured(cup("level 0.45 m", **way))
    assert told - 1.0 < cells < told + 1.0


@pytest.mark.parametrize("way", [dict(), dict(at=(0.013, 0.02)), dict(turn=20.0), dict(at=(0.004, 0.022), bottom=0.083)], ids=str)
@pytest.mark.parametrize("model", ["waves", "surface"])
def test_a_cup_without_room_for_its_liquid_is_refused_at_its_line(way, model):
    """A cell more than there is room for; as much as that runs."""
    scene = parse_scene(cup("level 0.45 m", model=model, **way))
    models = prepare(scene).models
    most = int(room(plan_grid(scene.liquid, choose_spacing(scene)[0]), models, scene.liquid.model, *scene.liquid.fill) + 1e-6)
    assert poured(cup(f"volume {most * 0.125} l", model=model, **way))[0] == most
    with pytest.raises(
        SceneError, match=r"scene:4:68: error: .* of liquid: the part that is filled has room for [\d.]+ l beside"
    ):
        prepare(parse_scene(cup(f"volume {(most + 1) * 0.125} l", model=model, **way)))


def test_a_level_without_room_is_refused_at_its_line():
    """There is nothing but the bottom of a cup up to there."""
    with pytest.raises(SceneError, match=r"a level of 15 cm of liquid: the part that is filled has room for .* beside"):
        prepare(parse_scene(cup("level 15 cm", bottom=0.13)))


def test_a_basin_that_is_full_of_bodies_is_found_quickly():
    """Shares of cells sum to the volume of what is inside, wherever it lies."""
    ready = prepare(parse_scene(cup("level 0.33 m", at=(0.02, 0.01), turn=31.0)))
    for spread in (True, False):
        assert filled(ready.plan.grid, ready.models, spread).sum() * 0.05**3 == pytest.approx(0.156, rel=1e-6)
