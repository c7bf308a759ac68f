# SPDX-License-Identifier: GPL-2.0-only
"""An effect that only this file knows: adding it to the table of effects is all that it takes."""

import json

import numpy as np
import pytest
from mdanim_lammps import effects, features
from mdanim_lammps.effects.margin import Margin
from mdanim_lammps.engine.commands import input_script
from mdanim_lammps.engine.data_file import data_text
from mdanim_lammps.errors import DivergedError, Problem
from mdanim_lammps.model.planes import Plane
from mdanim_lammps.report import check_json, scene_lines
from mdanim_lammps.run.guard import Guard
from mdanim_lammps.run.loop import simulate, write_inputs
from mdanim_lammps.run.observe import Observer

SCENE = """
title "windy"
object a {{ shape box (30, 30, 30) cm position (-2, 0, 0) m density 1000 elasticity 1 MPa velocity ({v}, 0, 0) m/s }}
object b {{ shape box (30, 30, 30) cm position (2, 0, 0) m density 1000 elasticity 1 MPa velocity (1, 0, 0) m/s hold {hold} }}
control {{ time 0.2 s frames 100 fps resolution 10 cm }}
"""
FAR = -5.0
"""Where the fence of the wind stands [m]."""


class Wind(effects.Effect):
    """A constant acceleration along x, with a fence that objects are to stay behind."""

    name = fix = ledger = "wind"
    has_potential = True
    if_off = "sails hang down"
    strength = 3.0

    def called_for(self, scene, reach):
        return effects.Verdict(self.name, scene.title == "windy", f"its title is {scene.title!r}")

    def columns(self, context):
        return {"sail": np.linspace(1.0, 2.0, context.system.particles)}

    def commands(self, context):
        return [f"fix wind mobile mdanim/gravity {self.strength!r} 0.0 0.0"]

    def potential(self, scene, mass, x):
        return -self.strength * float(mass @ x[:, 0])

    def rate(self, context):
        return np.full(context.system.particles, 1e9)

    def max_timestep(self, context):
        return 1e-5

    def planes(self, scene):
        return (Plane(self.name, "the fence", 0, 1, FAR, "beyond the fence"),)

    def margins(self, envelope):
        return [Margin("gust", envelope.system.names[0], 2.0, 1.0, "m/s", "a gust of 2 m/s", None, "warning", hint="wait")]

    def warnings(self, context):
        return [Problem(None, "sails are up", "haul them down", severity="warning")]


@pytest.fixture
def windy(monkeypatch, prepared):
    """Prepare a scene with the wind in the table of effects."""
    known = features.effects()
    monkeypatch.setattr(features, "effects", lambda: (*known, Wind()))
    return lambda v=0, hold="all": prepared(SCENE.format(v=v, hold=hold))


def test_check_tells_of_it(windy):
    """Cause, bound, margin and warning."""
    ready = windy()
    told = check_json(ready)
    assert told["effects"]["wind"] == {"on": True, "reason": "its title is 'windy'", "place": None}
    assert any("wind" in line for line in scene_lines(ready))
    c = ready.certificate
    assert (c.cause, c.share > 0.9) == ("wind", True)
    assert c.bound == pytest.approx(2.0 / np.sqrt(1e9), rel=0.1) and c.timestep <= 1e-5
    assert "gust" in [m.name for m in c.margins]
    assert {"a gust of 2 m/s", "sails are up"} <= {w.message for w in ready.warnings}


def test_lammps_is_told_of_it(windy):
    """Column and commands, in the files as in a live instance."""
    ready = windy()
    assert "fix wind mobile mdanim/gravity 3.0 0.0 0.0" in input_script(ready.plan)
    assert "d_sail" in input_script(ready.plan)
    assert "d_sail" in "".join(data_text(ready.plan)) or "2.0" in "".join(data_text(ready.plan))


def test_a_run_keeps_its_account(windy, tmp_path):
    """Objects are accelerated, the ledger has its column and adds up, summary and cost name it."""
    ready = windy()
    folder = tmp_path / "windy.out"
    folder.mkdir()
    write_inputs(ready, folder)
    result = simulate(ready, folder)
    assert "wind" in result.ledger.terms
    assert result.ledger.residual < 1e-3
    mass, way = ready.system.mass_of[0], 0.5 * Wind.strength * 0.2**2
    assert np.ptp(result.ledger.array("wind")) == pytest.approx(mass * Wind.strength * way, rel=1e-3)
    # The zero of its potential is as arbitrary as that of gravity: a joule too much is held against the 5 J that move.
    row = result.ledger.rows[0]
    joule = result.ledger.weigh(0.2, row | {"kinetic": row["kinetic"] + 1.0})["residual"]
    assert joule == pytest.approx(1.0 / (row["kinetic"] + 1.0 + np.ptp(result.ledger.array("wind"))), rel=0.2)
    assert "wind" in json.loads((folder / "summary.json").read_text())["effects"]
    assert "wind" in result.cost.effects


def test_its_plane_is_one_of_the_scene(windy, prepared, tmp_path):
    """An object thrown away from the other may come back from the fence, and the guard stops what has passed it."""
    assert windy(v=-20).verdicts["contact"].on
    guard = Guard(windy(), tmp_path)
    x = guard.ready.system.position.copy()
    moved = guard.ready.system.object == 0
    x[moved, 0] += 2.0 * FAR  # below the fence
    with pytest.raises(DivergedError, match="it has left the fence"):
        guard.check(1, Observer(guard.ready.plan, ()).observe(np.arange(2), np.arange(2), x, np.zeros_like(x)))


def test_without_it_nothing_is_left(prepared):
    """The same scene with the table as it is: no wind, and no contact of objects that fly apart."""
    ready = prepared(SCENE.format(v=-20, hold="all"))
    assert "wind" not in ready.verdicts and not ready.verdicts["contact"].on
    assert ready.certificate.cause == "springs"
