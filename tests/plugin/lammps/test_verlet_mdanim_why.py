# SPDX-License-Identifier: GPL-2.0-only
"""run_style verlet/mdanim says once in a run why there are no passes, and what to write."""

import plugin_lab as lab
import pytest
from liquid_lab import handle, library

BLOCK = lab.block((9, 9, 9))
MOVE = "fix run all mdanim/leapfrog"
WHY = {
    "fix nve": ([MOVE.replace("mdanim/leapfrog", "nve")], "fix run nve acts in every step; use mdanim/leapfrog"),
    "fix gravity": ([MOVE, "fix g all gravity 1e-3 vector 0 0 -1"], "fix g gravity acts in every step; use mdanim/gravity"),
    "another fix": ([MOVE, "fix m all momentum 5 linear 1 1 1"], "fix m momentum acts in every step; leave it out"),
    "two that move": ([MOVE, MOVE.replace("run", "two")], "fix two mdanim/leapfrog is the second of its kind"),
    "none that moves": ([], "there is no fix mdanim/leapfrog"),
    "no check": (
        [MOVE, "region r block -9 30 -9 30 -9 30", "fix w all mdanim/wall r 1.0", "neigh_modify check no"],
        "'neigh_modify check yes'",
    ),
    "lists of a group": (
        [
            MOVE,
            "region r block -9 30 -9 30 -9 30",
            "fix w all mdanim/wall r 1.0",
            "atom_modify first inner",
            "neigh_modify include inner",
        ],
        "'neigh_modify include all'",
    ),
}


def log_of(tmp_path, commands, order=None) -> str:
    """Log of two runs with a setup and one without."""
    log = tmp_path / "log"
    lmp = lab.load(
        BLOCK,
        tmp_path,
        [f"log {log}", *commands, "run_style verlet/mdanim", "run 0", "run 5", "run 5 pre no", "run 5"],
        order=order,
    )
    passes = library().mdanim_passes(handle(lmp))
    lmp.close()
    text = log.read_text()
    assert (passes > 0) != ("no passes" in text)
    return text


@pytest.mark.parametrize("name", WHY)
def test_the_reason_and_what_to_write(tmp_path, name):
    """A line for each setup, none for a run of no steps."""
    commands, told = WHY[name]
    lines = [line for line in log_of(tmp_path, commands).splitlines() if line.startswith("run_style verlet/mdanim: no passes")]
    assert len(lines) == 2 and all(told in line for line in lines)


def test_particles_out_of_order(tmp_path):
    """As read from a file."""
    assert "order of their IDs; use 'atom_modify sort 0 0'" in log_of(tmp_path, [MOVE], order=range(len(BLOCK.x) - 1, -1, -1))


def test_nothing_is_said_where_there_are_passes(tmp_path):
    """In runs whose steps are passes, but for those at outputs."""
    log_of(tmp_path, [MOVE, "thermo 3"])
