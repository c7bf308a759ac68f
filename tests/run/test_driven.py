# SPDX-License-Identifier: GPL-2.0-only
"""Held particles that an effect drives: what follows before a run begins, and what is refused."""

import numpy as np
import pytest
from mdanim_lammps import features
from mdanim_lammps.effects import Effect, Verdict
from mdanim_lammps.engine.commands import physics
from mdanim_lammps.errors import SceneError
from mdanim_lammps.model.build import build_models
from mdanim_lammps.reach import Drive
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

FAR, SPEED = (0.0, 0.1, 0.3), 2.0
TEXT = """
object table {{ shape box (20, 20, 10) cm position (0, 0, 0) cm  density 1000 elasticity 1 MPa {table} }}
object post  {{ shape box (20, 20, 10) cm position (20, 0, 0) cm density 1000 elasticity 1 MPa hold all }}
object ball  {{ shape box (10, 10, 10) cm position (0, 0, 60) cm density 1000 elasticity 1 MPa }}
control {{ time 0.1 s resolution 5 cm friction 0.3 }}
{more}
"""


class Drives(Effect):
    """Drives the first object."""

    def __init__(self, name):
        super().__init__()
        self.name = name

    def called_for(self, scene, reach):
        return Verdict(self.name, True, "a test wants it")

    def drives(self, scene):
        return {0: Drive((0.0, -0.1, 0.0), FAR, SPEED)}


@pytest.fixture
def driven(monkeypatch):
    """A scene whose first object is driven by some effects, prepared."""
    usual = features.effects()

    def make(*names, table="hold all", more=""):
        monkeypatch.setattr(features, "effects", lambda: (*usual, *map(Drives, names)))
        return prepare(parse_scene(TEXT.format(table=table, more=more)))

    return make


def test_what_is_driven_moves(driven):
    """It is not still, its box has all of its way, its speed counts, and forces count on it."""
    stands, moves = driven(), driven("motor")
    assert stands.system.still.tolist() == [True, True, False] and moves.system.still.tolist() == [False, True, False]
    for one, more in (("low", (0.0, -0.1, 0.0)), ("high", FAR)):
        grown = getattr(moves.context.reach.region, one) - getattr(stands.context.reach.region, one)
        np.testing.assert_allclose(grown, [more, (0, 0, 0), (0, 0, 0)], atol=1e-12)
    assert not stands.resolved.on("contact") and moves.resolved.on("contact")
    np.testing.assert_allclose(moves.context.reach.speed, [SPEED, 0.0, 0.0])
    np.testing.assert_allclose(moves.context.reach.closing(moves.context.reach.fall), [SPEED, 0.0, SPEED])
    assert np.array_equal(moves.plan.columns["driven"], (moves.system.object == 0).astype(float))
    lines = physics(moves.plan)
    assert "group moving union mobile driven" in lines and any("fix contact moving mdanim/contact" in line for line in lines)
    assert "driven" not in stands.plan.columns and not any("moving" in line for line in physics(stands.plan))


class Joins(Drives):
    """Joins the post to the ball."""

    def joins(self, scene):
        return [(1, 2)]

    def drives(self, scene):
        return {}


def test_what_is_joined_may_be_pulled_anywhere(monkeypatch):
    """The ball would stay where it is; what is joined to it may pull it, slower than waves."""
    usual, text = features.effects(), TEXT.format(table="hold all", more="")
    alone = prepare(parse_scene(text)).context.reach
    monkeypatch.setattr(features, "effects", lambda: (*usual, Joins("rope")))
    joined = prepare(parse_scene(text))
    reach, time = joined.context.reach, 0.1
    grown = alone.region.low[2] - reach.region.low[2]
    assert (grown >= 0.99 * reach.wave[2] * time).all()  # the estimate of the wave speed before models are made
    assert np.array_equal(alone.region.low[0], reach.region.low[0]) and joined.resolved.on("contact")


def test_what_is_driven_covers_nothing():
    """Two flush slabs that are held cover each other's sides; one that goes away does not."""
    scene = parse_scene(TEXT.format(table="hold all", more=""))
    assert build_models(scene)[1].frame.open is not None and build_models(scene, driven={0})[1].frame.open is None


@pytest.mark.parametrize(
    ("names", "words", "told"),
    [
        (["motor"], {"table": ""}, "nothing of table is held, so nothing of it can be driven or released"),
        (["crank", "motor"], {}, "table is driven by crank and by motor"),
    ],
)
def test_what_cannot_be_driven_is_refused(driven, names, words, told):
    """With the place of the object, and a way out."""
    with pytest.raises(SceneError) as refused:
        driven(*names, **words)
    (problem,) = refused.value.problems
    assert problem.message == told and problem.hint and problem.span.line == 2
