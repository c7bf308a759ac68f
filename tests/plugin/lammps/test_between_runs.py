# SPDX-License-Identifier: GPL-2.0-only
"""Commands between two runs, and errors that a program catches: nothing that was deleted or moved is used."""

import os
import signal
import time

import contact_lab
import numpy as np
import plugin_lab as lab
import plugin_path
import pytest
import state_lab
from contact_lab import Cuboid
from liquid_lab import BASIN, FALL, POOL, handle, library, one

MOVE = "fix run all mdanim/leapfrog"


def test_bonds_of_templates_are_refused(tmp_path):
    """Particles of atom_style template have no bonds themselves."""
    sections = {"Coords": "1 0 0 0\n2 1 0 0", "Types": "1 1\n2 1", "Bonds": "1 1 1 2"}
    sections |= {"Special Bond Counts": "1 1 0 0\n2 1 0 0", "Special Bonds": "1 2\n2 1"}
    text = "pair\n\n2 atoms\n1 bonds\n\n" + "\n\n".join(f"{name}\n\n{rows}" for name, rows in sections.items())
    (tmp_path / "m.mol").write_text(text + "\n")
    lmp = plugin_path.lammps()
    lmp.commands_list(
        ["newton off", f"molecule m {tmp_path}/m.mol", "atom_style template m", "atom_modify map array",
         "region box block 0 5 0 5 0 5",
         "create_box 1 box bond/types 1", "create_atoms 0 single 2 2 2 mol m 1", "mass 1 1", "comm_modify cutoff 2.0",
         "bond_style mdanim/harmonic", "bond_coeff 1 0.2 1.0"]
    )  # fmt: skip
    with pytest.raises(Exception, match="use 'atom_style bond', not template"):
        lmp.command("run 0")
    lmp.close()


@pytest.mark.parametrize("style", ["verlet", "verlet/mdanim"])
def test_a_property_that_fix_modify_names_is_read_at_once(tmp_path, style):
    """Also without a setup."""
    columns = {"lambda": np.zeros(1), "gamma": np.full(1, 0.05)}
    commands = [*BASIN, FALL, POOL + " buoyancy 1.0 drag 0.0 lambda d_lambda", MOVE + " lambda d_lambda", f"run_style {style}"]
    found = []
    for drag in ("0.05", "d_gamma"):
        lmp = lab.load(one(5.0, 2.0, -0.3), tmp_path, [*commands, "timestep 0.1", "run 5"], columns=columns)
        lmp.commands_list([f"fix_modify water drag {drag} lambda d_lambda", "run 20 pre no"])
        found.append(lab.by_tag(lmp, "v").tobytes())
        lmp.close()
    assert found[0] == found[1]


@pytest.mark.parametrize("change", ["cells i2_cell", "still some", "softness d_soft"])
def test_fix_modify_of_what_a_setup_reads_needs_one(tmp_path, change):
    """Else these would be half taken up."""
    columns = {"lambda": np.zeros(1), "soft": np.zeros(1)}
    commands = ["fix table all property/atom i2_cell 7 ghost yes", "group some id 1", *BASIN, FALL, POOL + " buoyancy 1.0", MOVE]
    for style in ("verlet", "verlet/mdanim"):
        lmp = lab.load(
            one(5.0), tmp_path, [*commands, f"run_style {style}", "run 5", f"fix_modify water {change}"], columns=columns
        )
        with pytest.raises(Exception, match="leave out 'pre no'"):
            lmp.command("run 20 pre no")
        lmp.commands_list(["fix_modify water every 2", "run 5 post no", "fix_modify water every 3", "run 5 pre no"])
        lmp.close()


def test_the_bound_on_the_step_after_its_wall_was_deleted(tmp_path):
    """LAMMPS asks for a compute between runs."""
    walls = ["region floor plane 0 0 0.5 0 0 1", "fix floor all mdanim/wall floor 3.0", "compute step all mdanim/timestep", MOVE]
    lmp = lab.load(lab.block((2, 2, 2)), tmp_path, walls)
    lmp.commands_list(["run 0", "unfix floor", "variable found equal c_step", "variable springs equal c_step[1]"])
    assert lmp.extract_variable("found") == lmp.extract_variable("springs") > 0.0
    lmp.close()


@pytest.mark.parametrize(("bonds", "told"), [("harmonic", "not of harmonic"), ("mdanim/harmonic", "has no coefficients yet")])
def test_the_bound_on_the_step_with_another_bond_style(tmp_path, bonds, told):
    """And that of springs that have no coefficients."""
    lmp = lab.load(lab.block((2, 2, 2)), tmp_path, ["compute step all mdanim/timestep", MOVE])
    lmp.commands_list(["run 0", "bond_style none", f"bond_style {bonds}", "variable found equal c_step"])
    with pytest.raises(Exception, match=told):
        lmp.command("print $(v_found)")
    lmp.close()


def test_another_region_takes_the_place_of_a_wall(tmp_path):
    """A block, which is convex, is deleted, and its name given to another region: far particles are looked at one by one."""
    commands = ["region r block -9 9 -9 9 -9 9", "fix w all mdanim/wall r 1.0", MOVE, "run 0", "region r delete"]
    lmp = lab.load(lab.particles([[0.0, 0.0, 0.0]]), tmp_path, [*commands, "region r sphere 0 0 30 5", "run 0"])
    assert lmp.extract_fix("w", 0, 0) == pytest.approx(0.5 * 25.0**2)
    for other, told in (("sphere 0 0 0 5 open 1", "open faces"), ("union 2 a b", "one fix per part")):
        lmp.commands_list(["region r delete", "region a block -9 9 -9 9 -9 0 open 1", "region b block -9 9 -9 9 0 9"])
        with pytest.raises(Exception, match=told):
            lmp.commands_list([f"region r {other.replace('sphere 0 0 0 5', 'block -9 9 -9 9 -9 0')}", "run 0"])
        lmp.commands_list(["region a delete", "region b delete"])
    lmp.close()


def test_passes_go_on_after_an_error_in_one(tmp_path):
    """A program catches it: the next run measures from where particles are, not from where the broken pass had them."""
    cuboids = (Cuboid((5, 5, 5)), Cuboid((5, 5, 5), (0.3, 0.2, 5.02), velocity=(0.4, 0.0, -0.05)))
    lmp = contact_lab.load(cuboids, tmp_path, more=["run_style verlet/mdanim"], dt=0.1)
    lmp.command("run 20 post no")
    state_lab.put(lmp, "contact", state_lab.pack(lmp, "contact"))
    with pytest.raises(Exception, match="leave out 'pre no'"):
        lmp.command("run 20 pre no post no")
    lmp.commands_list(["displace_atoms all move 0 0 7.0", "run 0 post no"])
    before = library().mdanim_passes(handle(lmp))
    lmp.command("run 40 pre no post no")
    assert library().mdanim_passes(handle(lmp)) - before > 30
    lmp.close()


def test_an_instance_with_threads_is_closed_in_a_fork(tmp_path):
    """Helpers of the parent sleep when it forks; the child runs, with the same bits, and closes."""
    commands = [MOVE, "run_style verlet/mdanim threads 2", "timestep 0.1", "run 20"]
    lmp = lab.load(lab.shaken(lab.block((5, 5, 5)), 0.1), tmp_path, commands)
    time.sleep(0.01)
    child = os.fork()
    if child == 0:
        signal.alarm(10)
        lmp.command("run 5 pre no post no")
        (tmp_path / "x").write_bytes(lab.by_tag(lmp, "x").tobytes())
        lmp.close()
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    lmp.command("run 5 pre no post no")
    assert (tmp_path / "x").read_bytes() == lab.by_tag(lmp, "x").tobytes()
    lmp.close()
