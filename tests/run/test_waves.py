# SPDX-License-Identifier: GPL-2.0-only
"""Runs with a liquid that has momentum: one unit that is missing stops a run, and a run goes on in the middle of a splash."""

from __future__ import annotations

import re
from functools import partial

import numpy as np
import pytest
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.engine.state import StateRecords
from mdanim_lammps.errors import DivergedError
from mdanim_lammps.parallel.runtime.launch import simulate_on
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.run.loop import Interrupted, simulate

UNIT = 2.0**-20
"""The smallest part of a cell of liquid."""
AT = 9 * 8
"""Where the state of the liquid tells its units at the start: after kind, version, energies and the cells along x, y, z."""
SPLASH = """
gravity (0, 0, -9.81)
liquid water {
  basin from (-20, -20, 0) cm to (20, 20, 40) cm
  density 1000
  level 20 cm
  manning 0.03
  drops 1
  inflow from (-20, -20, 15) cm to (-15, 20, 20) cm rate 1e-3 m^3/s
}
object raft {
  shape box (15, 15, 10) cm
  position (0, 0, 28) cm
  orientation euler (0, 15, 0) deg
  velocity (0, 0, -2)
  density 500
  elasticity 100 kPa
}
control { time 0.4 s  frames 50 fps  resolution 2.5 cm }
expect liquid.residual = 0
expect liquid.crest at 0 s = 20 cm +- 1 mm
expect liquid.crest = 30 cm +- 3 cm
expect liquid.waves at 0.2 s = 2.5 J +- 0.3 J
"""
CLOCK_AT = 18 * 8
"""Where it tells how long the liquid has gone on: after 18 words."""
IN_THE_SPLASH = 8
"""A frame: drops fly."""


def stopped(folder, frame):
    """A run that has stopped after a frame: its scene, its folder and its checkpoint."""
    (folder / "splash.txt").write_text(SPLASH)
    scene = Scene.load(folder / "splash.txt")

    def stop(progress):
        if progress.frame == frame:
            (folder / "cut.out" / "stop").touch()

    with pytest.raises(Interrupted):
        scene.run(folder / "cut.out", on_progress=stop)
    return scene, folder / "cut.out", Checkpoint.read(folder / "cut.out" / "checkpoint")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run from its start to its end."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "splash.txt").write_text(SPLASH)
    return Scene.load(folder / "splash.txt").run()


def test_units_are_told_exactly(whole):
    """Liquid comes in by parts of cells: the ledger has them to the unit, now and as they are due, and their difference is 0."""
    ledger = Ledger.read(whole.folder / "ledger.csv")
    cells, due = ledger.array("liquid_cells"), ledger.array("liquid_due")
    assert np.array_equal(cells, due) and (np.diff(due) > 0.0).all()
    assert np.array_equal(cells / UNIT, np.rint(cells / UNIT)) and (cells % 1.0 > 0.0).sum() > 10
    assert whole.outcomes[0].found == 0.0


def test_crest_is_what_the_splash_throws_up(whole):
    """Level before the raft lands, then higher; the ledger has it at each frame, and the trajectory no higher liquid."""
    crest = Ledger.read(whole.folder / "ledger.csv").array("liquid_crest")
    with Trajectory(whole.folder) as t:
        seen = np.array([np.nanmax(t.liquid_raw(n)) for n in range(len(t))])
    np.testing.assert_allclose(crest, seen, atol=1e-6)
    assert not whole.missed and whole.outcomes[2].found == crest.max() > 0.27


def test_energy_of_waves_is_that_of_the_ledger(whole):
    """A term of it where something moves, in no other column."""
    ledger = Ledger.read(whole.folder / "ledger.csv")
    at = np.searchsorted(ledger.array("time"), 0.2 - 1e-9)
    assert ledger.terms.count("waves") == 1 and "waves" not in ledger.extras
    assert whole.outcomes[3].found == pytest.approx(ledger.array("waves")[at])


def test_energy_of_waves_of_a_dam_that_has_broken(tmp_path):
    """Half a basin, 20 cm deep, is level after some sways: it has lost half of rho g V h/2, to 1 %. There is no object, and
    the ledger has it."""
    text = """
gravity (0, 0, -9.81)
liquid water {
  basin from (0, 0, 0) cm to (80, 20, 40) cm
  density 1000
  level 20 cm
  fill from (0, 0, 0) cm to (40, 20, 40) cm
  calm 0.3 s
}
control { time 4 s  frames 5 fps  resolution 2.5 cm }
expect liquid.waves at 0 s = 0 J
expect liquid.waves = -7.848 J +- 0.08 J
"""
    (tmp_path / "dam.txt").write_text(text)
    result = Scene.load(tmp_path / "dam.txt").run(tmp_path / "out", movie=False)
    assert not result.missed and "waves" in result.ledger.terms


@pytest.mark.parametrize(("units", "executors"), [(-1, 1), (1, 1), pytest.param(-1, 2, id="executors", marks=pytest.mark.mpi)])
def test_one_unit_stops_a_run(tmp_path, units, executors):
    """A checkpoint whose liquid has one unit of 2^-20 cell more or less than it began with: the next frame is refused."""
    scene, folder, checkpoint = stopped(tmp_path, IN_THE_SPLASH)
    records = checkpoint.records["liquid"]
    data = records.data.copy()
    start = data[AT : AT + 8].view(np.int64)
    start -= units
    checkpoint.records["liquid"] = StateRecords(records.keys, records.first, data)
    run = partial(simulate_on, executors, "central") if executors > 1 else simulate
    with pytest.raises(DivergedError, match=r"internal error: .* cells of liquid, .* at the start and come since") as error:
        run(scene.prepared, folder, resume=checkpoint)
    now, due = re.search(r"internal error: (\S+) cells of liquid, (\S+) at", str(error.value)).groups()
    assert float(now) - float(due) == units * UNIT


@pytest.mark.parametrize("executors", [1, pytest.param(2, id="executors", marks=pytest.mark.mpi)])
def test_a_liquid_in_slow_motion_stops_a_run(tmp_path, executors):
    """A checkpoint whose liquid has gone through a microsecond less than solids have: the next frame is refused."""
    scene, folder, checkpoint = stopped(tmp_path, IN_THE_SPLASH)
    records = checkpoint.records["liquid"]
    data = records.data.copy()
    clock = data[CLOCK_AT : CLOCK_AT + 8].view(np.float64)
    assert clock[0] == pytest.approx(IN_THE_SPLASH / 50, rel=0.1)
    clock -= 1e-6
    checkpoint.records["liquid"] = StateRecords(records.keys, records.first, data)
    run = partial(simulate_on, executors, "central") if executors > 1 else simulate
    with pytest.raises(DivergedError, match=r"t = 0.18 s: internal error: water has gone through 0.179999 s"):
        run(scene.prepared, folder, resume=checkpoint)


def test_a_splash_resumes_bit_for_bit(whole, tmp_path):
    """Stop while drops fly; the film that goes on is that of the run that never stopped, and so is its ledger."""
    scene, folder, checkpoint = stopped(tmp_path, IN_THE_SPLASH)
    resumed = simulate(scene.prepared, folder, resume=checkpoint)
    assert compare(whole.folder, folder).equal
    for term in (*resumed.ledger.terms, *resumed.ledger.extras):
        np.testing.assert_allclose(resumed.ledger.array(term), whole.ledger.array(term), rtol=1e-9, atol=1e-12, err_msg=term)
