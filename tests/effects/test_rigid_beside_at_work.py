# SPDX-License-Identifier: GPL-2.0-only
"""A rigid rod rests on two held boxes, whatever the gap between them, and beside one that an effect moves."""

import numpy as np
import pytest
from mdanim_lammps import features
from mdanim_lammps.effects import Effect, Verdict
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.rigid import touching
from mdanim_lammps.reach import Drive

BOX = "object {} {{ shape box (10, 10, 10) cm  position ({}, 0, 0) mm  density 600  elasticity rigid  {}  hold all }}\n"
ROD = """gravity (0, 0, -9.81) m/s^2
object rod {{ shape box (40, 2, 2) cm  position ({}, {}, 61) mm  density 600  elasticity rigid
  orientation axis (0, 0, 1) angle {} deg }}
control {{ time 0.2 s  friction 0.5 }}
"""
DEEP = 2e-4
"""Depth to which it sinks in [m]: 1 % of its thickness; `check` warns of a load at rest above 0.5 %, and it falls 1 mm."""


def heights(ready):
    """Height of the centre of the rod over its place at rest, 50 times [m]."""
    first, last = ready.system.first[-2:]
    mass, found = ready.system.mass[first:last], []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(50):
            instance.run(ready.certificate.steps // 50)
            found.append(float(mass @ instance.array("x")[first:last, 2] / mass.sum()) - 0.06)
    return np.array(found)


@pytest.mark.parametrize(
    ("gap", "more"),
    [
        *((gap, "") for gap in (0.0, 0.15, 0.5, 0.9, 3.0)),
        (0.15, "resolution 5 mm"),
        (0.9, "resolution 10 cm"),
        (1.5, "resolution 10 cm"),
    ],
)
def test_a_rod_rests_on_boxes_beside_each_other(prepared, gap, more):
    """It lies on one, and across both. What features were made for, and what touches by features, was decided with two gaps: with
    0.15 to 0.9 mm the rod fell through."""
    boxes = BOX.format("left", 0, more) + BOX.format("right", 100 + gap, more)
    for x, y, angle in ((0, 0, 90), (50, 15, 0)):
        z = heights(prepared(boxes + ROD.format(x, y, angle)))
        assert z.min() > -DEEP and z.max() < 1.1e-3


class Drives(Effect):
    """Moves the box up and down by nothing that shows."""

    name = "motor"

    def called_for(self, scene, reach):
        return Verdict(self.name, True, "asked for")

    def drives(self, scene):
        return {0: Drive((0.0, 0.0, 0.0), (0.0, 0.0, 1e-3), 0.01)}


def test_a_rod_rests_on_what_an_effect_moves(prepared, monkeypatch):
    """Its motion is of no fix that knows features, so both touch at points of their surfaces, which are there."""
    text = BOX.format("left", 0, "") + ROD.format(25, 0, 90)
    assert np.diff(prepared(text).system.first).tolist() == [8, 8]
    usual = features.effects()
    monkeypatch.setattr(features, "effects", lambda: (*usual, Drives()))
    ready = prepared(text)
    assert not touching.meets_objects(ready.context)[0]
    z = heights(ready)
    assert z.min() > -DEEP and z.max() < 1.1e-3
