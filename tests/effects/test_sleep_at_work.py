# SPDX-License-Identifier: GPL-2.0-only
"""`sleep on` of scenes: what lies still is told as it lies."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.threads import with_threads
from mdanim_lammps.run.loop import simulate

SCENE = """gravity {g} m/s^2
ground z 0 m
object box {{ shape box (10, 10, 10) cm  position (0, 0, 0.05) m  density 600  elasticity {elasticity} }}
control {{ time 0.6 s  friction 0.5  sleep on }}
{expect}
"""
WEIGHT = """expect box.contact.z at 0.5 s = 5.88399 N +- 0.00001 N
expect world.contact.z at 0.5 s = -5.88399 N +- 0.00001 N
expect box.speed at 0.5 s < 1e-9 m/s
expect energy.residual = 0 +- 1e-9
"""


def test_a_box_sleeps_with_its_weight(prepared, tmp_path):
    """The forces of its contacts are those at rest."""
    done = simulate(prepared(SCENE.format(g="(0, 0, -9.80665)", elasticity="rigid", expect=WEIGHT)), tmp_path)
    assert [one.met for one in done.outcomes] == [True] * 4, done.outcomes
    assert "stilled" in (tmp_path / "ledger.csv").read_text().partition("\n")[0].split(",")


@pytest.mark.parametrize(
    ("g", "elasticity", "why"),
    [("(0, 0, 0)", "rigid", "there is no gravity"), ("(0, 0, -9.8)", "1 MPa", "no object that can move is rigid")],
)
def test_sleep_that_does_nothing_is_told(prepared, g, elasticity, why):
    """Where nothing rigid lies."""
    ready = prepared(SCENE.format(g=g, elasticity=elasticity, expect=""))
    assert f"sleep does nothing: {why}" in [problem.message for problem in ready.scene.warnings]


ANGLE = """gravity (0, 0, -9.80665) m/s^2
ground z 0 m
let wood = { density 600  elasticity rigid }
object foot { use wood  shape box (20, 20, 10) cm  position (0, 0, 0.05) m }
object arm { use wood  shape box (10, 10, 10) cm  position (0.05, 0, 0.15) m }
joint weld arm foot { at (0.05, 0, 0.1) m }
object ball { use wood  shape sphere 4 cm  position (0.1, 0, 0.45) m }
object jelly { shape box (10, 10, 10) cm  position (-0.3, 0, 0.05) m  density 1000  elasticity 100 kPa  resolution 3.5 cm }
control { time 0.3 s  friction 0.5  sleep on }
"""


def test_what_is_welded_sleeps_and_wakes_on_any_number_of_threads(prepared):
    """Two boxes, beside a jelly that threads share, until a ball falls on them: to the bit."""
    ready = prepared(ANGLE)
    ends, slept = [], []
    for threads in (1, 3):
        with with_threads(threads), Instance(ready.plan) as run:
            run.setup()
            for _ in range(2):
                run.run(ready.certificate.steps // 2)
                slept.append(run.fix_value("rigid", "asleep"))
            ends.append(run.array("x").copy())
    assert slept == [2, 0] * 2 and np.array_equal(*ends)
