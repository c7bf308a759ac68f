# SPDX-License-Identifier: GPL-2.0-only
"""The inputs of scenes/lammps, run as their user runs them: on 1, 2 and 4 ranks, with energy and draft looked at."""

import re
import shutil

import numpy as np
import plugin_path
import pytest
from paths import REPOSITORY, SCENES

SCENES = SCENES / "lammps"
# Fast and close, so that few steps hold contact, floor, drag, damp, rebuilds and rebalancing.
SHORT = ("-var", "steps", "100", "-var", "speed", "0.8", "-var", "damp", "0.3", "-var", "lambda", "0.01")
# A heavier fall, so that few steps hold the plunge and some of the way up.
PLUNGE = ("-var", "steps", "250", "-var", "g", "0.02")


def run(folder, ranks, scene, *arguments):
    """Run a copy of a scene in a folder of its own; returns its dump and its output."""
    folder = folder / f"ranks{ranks}"
    folder.mkdir()
    shutil.copy(SCENES / f"in.{scene}", folder)
    if (bodies := SCENES / f"contact.{scene}").exists():
        shutil.copy(bodies, folder)
    done = plugin_path.lmp(folder / f"in.{scene}", ranks, *arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    return (folder / f"{scene}.lammpstrj").read_bytes(), done.stdout


def table(output):
    """The thermo table as {column: values}."""
    lines = output.splitlines()
    start = next(n for n, line in enumerate(lines) if line.split()[:1] == ["Step"])
    rows = []
    for line in lines[start + 1 :]:
        if not re.match(r"\s*\d", line):
            break
        rows.append([float(word) for word in line.split()])
    return dict(zip(lines[start].split(), np.array(rows).T))


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 4])
def test_any_number_of_ranks_gives_the_same_bits(tmp_path, ranks):
    """Compare the dumps byte for byte."""
    alone, output = run(tmp_path, 1, "two_blocks", *SHORT)
    assert table(output)["f_contact[4]"][-1] < 0.8
    assert alone == run(tmp_path, ranks, "two_blocks", *SHORT)[0]


@pytest.mark.mpi
def test_two_cubes_rub_alike_on_any_number_of_ranks(tmp_path):
    """Dumps are the same byte for byte, the books close, and friction has taken some of the energy."""
    alone, output = run(tmp_path, 1, "two_cubes", "-var", "steps", "400")
    t = table(output)
    np.testing.assert_allclose(t["v_balance"], t["v_balance"][0], rtol=2e-4)
    assert t["f_contact[2]"][-1] > 0.03 and t["f_contact[5]"][-1] > 0.2
    assert alone == run(tmp_path, 3, "two_cubes", "-var", "steps", "400")[0]


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 4])
def test_the_pool_is_the_same_on_any_number_of_ranks(tmp_path, ranks):
    """Compare the dumps byte for byte while the raft dives."""
    alone, output = run(tmp_path, 1, "pool", *PLUNGE)
    t = table(output)
    assert t["v_height"].min() < t["f_water[3]"].min() and t["f_water[5]"][-1] > 50
    assert alone == run(tmp_path, ranks, "pool", *PLUNGE)[0]


def test_the_raft_floats_half_immersed(tmp_path):
    """At rest its middle is in the surface, the energies are in balance and no liquid is lost."""
    _, output = run(tmp_path, 1, "pool")
    t = table(output)
    assert (t["f_water[1]"] == t["f_water[1]"][0]).all()
    assert t["KinEng"][-1] < 1e-9
    # By symmetry exactly; 1e-3 is what it still bobs by.
    assert t["v_height"][-1] == pytest.approx(t["f_water[3]"][-1], abs=1e-3)
    # 8 layers and the raft's 48 cells on 320 columns; whole cells are rounded by a tenth of a raft.
    assert t["f_water[3]"][-1] == pytest.approx(8.0 + 48.0 / 320.0, abs=0.03)
    assert t["TotEng"] == pytest.approx(t["TotEng"][0], rel=1e-4)


def test_energy_is_kept(tmp_path):
    """1000 steps with several impacts on floor and block: nothing gets lost."""
    _, output = run(tmp_path, 1, "two_blocks")
    t = table(output)
    assert t["f_contact[4]"][-1] < 0.8 and t["f_floor"].max() > 0.1
    # docs/physics-solids.md: 1e-3 at 0.3 of the bound; here 0.2 of 2/w_b = 0.71 is 0.28.
    assert t["TotEng"] == pytest.approx(t["TotEng"][0], rel=1.5e-3)


def test_energy_is_kept_with_drag(tmp_path):
    """The same with losses; what drag took is in the total."""
    _, output = run(tmp_path, 1, "two_blocks", "-var", "lambda", "0.002")
    t = table(output)
    assert t["f_run"][-1] > 0.05 * t["TotEng"][0]
    assert t["TotEng"] == pytest.approx(t["TotEng"][0], rel=1.5e-3)


@pytest.mark.mpi
def test_a_rigid_slab_tumbles_alike_on_any_number_of_ranks(tmp_path):
    """Dumps are the same byte for byte; the slab has hit the block, turns, and no energy is lost."""
    alone, output = run(tmp_path, 1, "tumble", "-var", "steps", "400")
    t = table(output)
    assert t["f_contact"].max() > 0.1 and t["f_rigid[3]"][-1] < 0.5 * t["f_rigid[3]"][0]
    assert t["TotEng"] == pytest.approx(t["TotEng"][0], rel=1.5e-3)
    assert alone == run(tmp_path, 3, "tumble", "-var", "steps", "400")[0]


@pytest.mark.mpi
def test_a_tray_shakes_alike_on_any_number_of_ranks(tmp_path):
    """Dumps are the same byte for byte; what the drive has brought in is what the block has."""
    alone, output = run(tmp_path, 1, "shaker", "-var", "steps", "400")
    t = table(output)
    assert t["f_drive[1]"].max() > 0.5
    assert t["v_off"] == pytest.approx(t["v_off"][0], rel=1.5e-3)
    assert alone == run(tmp_path, 3, "shaker", "-var", "steps", "400")[0]


@pytest.mark.mpi
def test_a_crank_turns_alike_on_any_number_of_ranks(tmp_path):
    """Dumps are the same byte for byte; the piston is where the angle of the crank says, and energy less work stays."""
    alone, output = run(tmp_path, 1, "crank", "-var", "steps", "1000")
    t = table(output)
    assert t["f_joints[4][3]"] == pytest.approx(t["v_exact"], abs=0.04)  # of a stroke of 8; the joints swing a little
    assert t["f_joints[1][4]"][1:] == pytest.approx(1.0, abs=0.01)
    assert t["TotEng"] == pytest.approx(0.0, abs=2e-4 * t["f_joints[3]"].max())
    assert alone == run(tmp_path, 3, "crank", "-var", "steps", "1000")[0]


@pytest.mark.mpi
@pytest.mark.soak
def test_a_satellite_flies_alike_on_any_number_of_ranks(tmp_path):
    """Dumps are the same byte for byte; it comes to rest where its forces bring it, at a right angle but for what its wings give,
    and has the energy that the jets have brought in."""
    alone, output = run(tmp_path, 1, "satellite")
    t = table(output)
    assert t["v_place"] == pytest.approx(t["v_exact_place"], abs=1e-6)
    assert t["v_angle"] == pytest.approx(t["v_exact_angle"], abs=0.01)
    assert abs(t["v_off"]).max() < 1e-6 and t["KinEng"][-1] < 1e-4
    assert alone == run(tmp_path, 3, "satellite")[0]


@pytest.mark.mpi
def test_a_rope_tears_alike_on_any_number_of_ranks(tmp_path):
    """Dumps are the same byte for byte; the rope has torn at its strength, the others hold, and what it held is heat."""
    alone, output = run(tmp_path, 1, "ropes", "-var", "steps", "400")
    t = table(output)
    assert t["f_ropes[4]"][-1] == 1.0 and t["f_ropes[1][1]"][-1] == 0.0 and t["f_ropes[2][1]"][-1] > 0.3
    assert t["f_ropes[2]"][-1] == pytest.approx(0.3**2 / (2 * 0.1), rel=0.02)
    assert t["TotEng"] == pytest.approx(t["TotEng"][0], rel=1e-3)
    assert alone == run(tmp_path, 3, "ropes", "-var", "steps", "400")[0]


@pytest.mark.mpi
def test_a_windmill_turns_alike_on_any_number_of_ranks(tmp_path):
    """Dumps are the same byte for byte; it comes to the speed of its closed form, and energy less work stays."""
    alone, output = run(tmp_path, 1, "air", "-var", "steps", "3000")
    t = table(output)
    assert t["f_axle[1][4]"][-1] == pytest.approx(t["v_exact"][-1], rel=3e-3)
    assert t["TotEng"] == pytest.approx(0.0, abs=1e-4 * t["f_air[2]"][-1])
    assert alone == run(tmp_path, 3, "air", "-var", "steps", "3000")[0]


def last_table(output):
    """Log of the last ``run``: these scripts have a ``run 0`` before it, which finds the time step."""
    return table(output[output.rindex("   Step ") :])


@pytest.mark.mpi
@pytest.mark.parametrize(("scene", "steps"), [("cantilever", "400"), ("bowl", "300")])
def test_scripts_that_find_their_time_step_are_the_same_on_any_number_of_ranks(tmp_path, scene, steps):
    """Dumps and time steps, to the last bit."""
    alone, _ = run(tmp_path, 1, scene, "-var", "steps", steps)
    assert alone == run(tmp_path, 3, scene, "-var", "steps", steps)[0]


def test_the_cantilever_swings_between_its_start_and_twice_its_sag(tmp_path):
    """The step is half of the bound, which hardly changes; the energy goes to the dashpots little by little."""
    _, output = run(tmp_path, 1, "cantilever")
    t = last_table(output)
    assert t["Time"][1] == pytest.approx(500 * 0.5 * t["c_step"][0], rel=1e-9)
    assert np.ptp(t["c_step"]) < 1e-3 * t["c_step"][0]
    assert 3.0 < t["v_sag"].max() < 4.0 and t["v_sag"][1:].min() > -0.1


def test_cubes_come_to_rest_in_the_bowl(tmp_path):
    """None is crumpled or has left it; the barrier is warned of by name."""
    _, output = run(tmp_path, 1, "bowl")
    t = last_table(output)
    assert t["KinEng"].max() > 0.3 and t["KinEng"][-1] < 0.02 and t["E_bond"][-1] < 0.05
    assert "not in it: fix contact mdanim/barrier" in output


@pytest.mark.mpi
# A setup has forces without dashpots, which the bowl has: cubes that fall hardly see it.
@pytest.mark.parametrize(("scene", "steps", "tolerance"), [("pool", 200, 1e-12), ("bowl", 800, 0.02)])
def test_a_restart_file_goes_on(tmp_path, scene, steps, tolerance):
    """Compare two halves with a run in one piece: all energies at the end."""
    run(tmp_path, 1, scene, "-var", "steps", str(steps))
    again = tmp_path / "ranks1" / f"in.{scene}_restart"
    shutil.copy(SCENES / again.name, again)
    done = plugin_path.lmp(again, 2, "-var", "steps", str(steps))
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "whole").mkdir()
    _, whole = run(tmp_path / "whole", 1, scene, "-var", "steps", str(2 * steps))
    half, whole = table(done.stdout), table(whole[whole.rindex("Per MPI rank memory") :])
    assert half["Step"][-1] == whole["Step"][-1] == 2 * steps
    for name in ("KinEng", "E_bond", *(name for name in half if name.startswith("f_") and "[" not in name)):
        assert half[name][-1] == pytest.approx(whole[name][-1], rel=tolerance, abs=1e-12), name


def test_restart_examples_are_those_of_the_scripts():
    """Every line that a style's page shows after read_restart is a line of a script that goes on."""
    scripts = [re.sub(r" *#.*", "", script.read_text()).split("\n") for script in SCENES.glob("in.*_restart")]
    lines = {" ".join(line.split()) for script in scripts for line in script}
    shown = 0
    for page in (REPOSITORY / "docs").glob("*_mdanim_*.md"):
        for block in re.findall(r"^```\n(read_restart +(?:pool|bowl)\.restart\n.*?)^```", page.read_text(), flags=re.S | re.M):
            shown += 1
            assert {" ".join(line.split()) for line in block.splitlines()} <= lines, page
    assert shown == 4
