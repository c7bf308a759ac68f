# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/liquid: its state is taken up to the bit, by its own functions and by restart files."""

import numpy as np
import plugin_lab as lab
import pytest
from liquid_lab import BASIN, FALL, POOL, block_in_pool, cells, lattice, state, take_up, value


def frames(lmp, pieces):
    """Positions, velocities and cells after each of these numbers of steps."""
    out = []
    for steps in pieces:
        lmp.command(f"run {steps}")
        out.append((lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v"), cells(lmp)))
    return out


def same(a, b) -> bool:
    """Whether all arrays are equal to the last bit."""
    return all(np.array_equal(p, q) for p, q in zip(a, b))


FAST = dict(shape=(3, 3, 3), corner=(-1.7, -1.3, 10.5), velocity=(0.02, 0.0, -0.3))


def test_pieces_of_a_run_are_one_run(tmp_path):
    """Setups in between change no bit."""
    one_run = block_in_pool(tmp_path, **FAST)
    pieces = block_in_pool(tmp_path, **FAST)
    assert same(frames(one_run, [301])[-1], frames(pieces, [1, 100, 3, 97, 100])[-1])
    one_run.close()
    pieces.close()


def test_a_state_is_taken_up_to_the_bit(tmp_path):
    """Another instance with the same particles and the stored state goes on alike."""
    first = block_in_pool(tmp_path, **FAST)
    frames(first, [150])
    x, v, stored = lab.by_tag(first, "x"), lab.by_tag(first, "v"), state(first)
    second = block_in_pool(tmp_path, **FAST)
    second.command("reset_timestep 150")
    second.numpy.extract_atom("x")[: len(x)] = x
    second.numpy.extract_atom("v")[: len(v)] = v
    take_up(second, stored)
    assert same(frames(first, [150])[-1], frames(second, [150])[-1])
    with pytest.raises(RuntimeError, match="grid"):
        take_up(second, stored[:-1])
    first.close()
    second.close()


HEAD = np.dtype(
    [
        ("version", "f8"),
        *((n, "i8") for n in ("nx", "ny", "nz", "units", "swept", "waited", "calm")),
        *((n, "f8") for n in ("travel", "crossed", "work", "lost")),
    ]
)


@pytest.mark.parametrize("calm", [0, 1])
def test_a_state_comes_back_whole(tmp_path, calm):
    """Every number of its head and every cell, also of what never moves, is what was taken up."""
    wall = lab.block((2, 4, 14), (-5.0, -2.0, 0.0))
    lmp = lab.load(
        wall, tmp_path,
        ["fix table all property/atom i2_cell 7 ghost yes", *lattice(wall, (2, 4, 14)), *BASIN, POOL + " cells i2_cell still all",
         "run 8"],
    )  # fmt: skip
    stored = state(lmp)
    head = stored[: HEAD.itemsize].view(HEAD)
    assert (head["nx"], head["nz"], head["units"]) == (20, 16, value(lmp, "units"))
    for name, number in dict(swept=77, waited=3, calm=calm, travel=0.1, crossed=0.2, work=0.3, lost=0.4).items():
        head[name] = number
    take_up(lmp, stored)
    assert np.array_equal(state(lmp), stored)
    assert np.count_nonzero(cells(lmp) == 255) == 2 * 4 * 14
    lmp.close()


@pytest.mark.parametrize("model", ["surface", "waves drops 1"])
def test_a_restart_file_goes_on(tmp_path, model):
    """LAMMPS's own restart holds liquid and solids; units and cells are those of the unbroken run. With momentum a splash
    goes on: restart files hold its links, and what acts on particles until the next update."""
    pool = f"{POOL} model {model}"
    first = block_in_pool(tmp_path, pool=pool, **FAST)
    first.command("run 150")
    stored = state(first)
    if "waves" in model:
        assert np.linalg.norm([value(first, "momentum.x"), value(first, "momentum.y")]) > 1e-4
        assert value(first, "crest") > value(first, "level") + 0.2, "it was to be stopped in a splash"
    first.command(f"write_restart {tmp_path}/half.restart")
    unbroken = frames(first, [150])[-1]
    first.close()
    import plugin_path

    second = plugin_path.lammps()
    for command in [
        "atom_modify map array sort 0 0", "newton off", f"read_restart {tmp_path}/half.restart",
        "fix model all property/atom rmass d_volume d_lambda ghost yes", "fix table all property/atom i2_cell 7 ghost yes",
        *BASIN, FALL, pool + " cells i2_cell buoyancy d_volume drag 0.1 lambda d_lambda",
        "fix move all mdanim/leapfrog lambda d_lambda", "timestep 0.3", "neighbor 0.4 bin", "neigh_modify every 1 delay 0",
        "comm_modify cutoff 3.0", "pair_style none",
    ]:  # fmt: skip
        second.command(command)
    assert np.array_equal(state(second), stored)
    assert same(frames(second, [150])[-1], unbroken)
    second.close()


def test_a_damaged_state_is_refused(tmp_path):
    """A state whose cells do not hold what its head says, or hold what no cell can, is not taken up."""
    lmp = block_in_pool(tmp_path, **FAST)
    lmp.command("run 0")
    stored = state(lmp)
    dry, burst = stored.copy(), stored.copy()
    dry[-16 * 20 * 20 :] = 0
    burst[-16 * 20 * 20] = 252
    with pytest.raises(RuntimeError, match="holds 0 units of liquid"):
        take_up(lmp, dry)
    with pytest.raises(RuntimeError, match="a cell holds 252"):
        take_up(lmp, burst)
    take_up(lmp, stored)
    lmp.close()


def test_waves_refuse_particles_of_no_object(tmp_path):
    """Records are of objects: a restart file of such a run could not be read."""
    refused = "particle 1 belongs to no object, its molecule ID is 0; .*, or leave it out of the group of this fix"
    with pytest.raises(Exception, match=refused):
        block_in_pool(tmp_path, (3, 2, 2), (-1.5, -1.0, 9.0), ["set group all mol 0", "run 0"], pool=POOL + " model waves")
    block_in_pool(tmp_path, (3, 2, 2), (-1.5, -1.0, 9.0), ["set group all mol 0", "run 0"]).close()
