# SPDX-License-Identifier: GPL-2.0-only
"""Drops of a scene, from its text to frames: a stone throws liquid up, and every unit of it is accounted for."""

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from mdanim_lammps.features.liquid.kept import DROPS, HEIGHT
from mdanim_lammps.features.liquid.ledger import CELLS, DUE
from mdanim_lammps.run.frame_source import Sequential
from mdanim_lammps.run.loop import trajectory_writer
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

STONE = """
gravity (0, 0, -10) m/s^2
control { resolution 2.5 cm  time 1 s  frames 100 fps }
liquid water {
  basin from (0, 0, 0) m to (0.5, 0.5, 0.8) m
  density 1000 kg/m^3
  level 0.2 m
  model waves
  drops 1
}
object stone { shape sphere 7 cm  position (0.25, 0.25, 0.5) m  density 2500 kg/m^3  elasticity 2 MPa  velocity (0, 0, -3) m/s }
"""


@dataclass(frozen=True)
class Liquid:
    """Fields of a liquid in a frame."""

    cells: float
    start: float
    """Cells that there should be."""
    height: np.ndarray
    drops: np.ndarray | None


def frames(drops: float, seconds: float) -> list:
    """Liquids of all frames of a fall into the pool."""
    scene = parse_scene(STONE)
    ready = prepare(replace(scene, liquid=replace(scene.liquid, drops=drops)))
    each = ready.certificate.steps_per_frame
    with TemporaryDirectory() as folder, Sequential(ready.plan) as source:
        out = trajectory_writer(ready, Path(folder), round(100 * seconds) + 1)
        found = [source.begin(None, out.rows)]
        found += [source.advance(n, each) for n in range(1, round(100 * seconds) + 1)]
        out.close(finished=False)
        return [Liquid(*(f.fields.get(name) for name in (CELLS, DUE, HEIGHT.name, DROPS.name))) for f in found]


@pytest.fixture(scope="module")
def splash() -> list:
    """With all drops."""
    return frames(1.0, 0.5)


def test_a_stone_throws_drops_up(splash):
    """None before it comes, then many, above the level and within the walls, each smaller than a cell."""
    assert not any(len(liquid.drops) for liquid in splash[:5])
    assert max(len(liquid.drops) for liquid in splash) > 30
    flown = np.concatenate([liquid.drops for liquid in splash])
    assert flown[:, 2].max() > 0.3
    assert (flown[:, :2] >= 0.0).all() and (flown[:, :2] <= 0.5).all()
    assert (flown[:, 3] > 0.0).all() and flown[:, 3].max() < 0.025


def test_liquid_and_drops_are_the_same_sum_in_each_frame(splash):
    """To the unit; drops hold a share of it that can be seen, and not much of it."""
    assert all(liquid.cells == liquid.start == splash[0].cells for liquid in splash)
    # Neither the stone nor its cavity is in the pool before it comes, so heights alone hold the volume there.
    shown = splash[0].height.mean() * 0.25
    assert shown == pytest.approx(splash[0].cells * 0.025**3, rel=1e-2)
    flying = [4.0 / 3.0 * np.pi * (liquid.drops[:, 3] ** 3).sum() for liquid in splash]
    assert 1e-5 < max(flying) < 0.1 * shown


def test_a_liquid_without_the_word_sheds_none():
    """Its frames have no drops at all, and no room for them."""
    assert all(liquid.drops is None for liquid in frames(0.0, 0.15))
