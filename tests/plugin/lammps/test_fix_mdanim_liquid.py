# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/liquid: lift, drag, displacement and bookkeeping against closed forms, sleep, state, what it refuses."""

import ctypes
import os
import subprocess
import sys

import numpy as np
import plugin_lab as lab
import pytest
from liquid_lab import BASIN, FALL, POOL, block_in_pool, call, cells, lattice, one, value
from mdanim_lammps.engine.plugin import folder

G, RHO = 0.01, 1.0


# --- forces ---


@pytest.mark.parametrize("z", [3.0, 9.2, 9.7, 10.0, 10.3, 10.6, 14.0])
def test_lift_is_the_weight_of_what_is_displaced(tmp_path, z):
    """At rest the surface is exactly flat, so a particle is lifted by rho V g times its part below it."""
    lmp = lab.load(one(z), tmp_path, [*BASIN, POOL + " buoyancy 0.7", "fix move all mdanim/leapfrog", "run 0"])
    # The particle's own cell holds no liquid: one unit of 400 is elsewhere, none when it is above the surface.
    part = np.clip(10.0 - z + 0.5, 0.0, 1.0)
    assert lab.by_tag(lmp, "f")[0] == pytest.approx([0.0, 0.0, RHO * 0.7 * part * G], abs=1e-15)
    lmp.close()


@pytest.mark.parametrize("mass", [0.3, 0.5, 0.9])
def test_a_particle_floats_where_archimedes_says(tmp_path, mass):
    """V s rho = m at rest: z = 10 + 1/2 - m."""
    columns = {"lambda": np.zeros(1)}
    lmp = lab.load(
        one(12.0, mass), tmp_path,
        [*BASIN, FALL, POOL + " buoyancy 1.0 drag 0.05 lambda d_lambda", "fix move all mdanim/leapfrog lambda d_lambda",
         "timestep 0.3", "run 6000"], columns=columns,
    )  # fmt: skip
    # One cell of 400 is displaced at most: the level rises by 1/400.
    assert lab.by_tag(lmp, "x")[0, 2] == pytest.approx(10.5 - mass, abs=0.01)
    assert value(lmp, "units") == value(lmp, "start") == 4000
    lmp.close()


@pytest.mark.parametrize("mass", [2.0, 3.0])
def test_terminal_speed_under_quadratic_drag(tmp_path, mass):
    """(m - rho V) g = (gamma + k v) rho V v."""
    gamma, k = 0.02, 0.1
    lmp = lab.load(
        one(9.0, mass), tmp_path,
        ["region basin block -10 10 -10 10 -300 16", FALL,
         f"fix water all mdanim/liquid basin 1.0 grid 20 20 316 level 10 gravity 0.01 buoyancy 1.0 drag {gamma} quadratic {k} "
         "lambda d_lambda",
         "fix move all mdanim/leapfrog lambda d_lambda", "timestep 0.3", "run 2000"], columns={"lambda": np.zeros(1)},
    )  # fmt: skip
    fall = (-gamma + np.sqrt(gamma**2 + 4.0 * k * (mass - 1.0) * G)) / (2.0 * k)
    # exp(-gamma t / mass) of the start is left, at most.
    assert lab.by_tag(lmp, "v")[0, 2] == pytest.approx(-fall, rel=1e-3)
    lmp.close()


@pytest.mark.parametrize("mass", [2.0, 3.0])
def test_terminal_speed_under_drag(tmp_path, mass):
    """(m - rho V) g = gamma rho V v."""
    gamma = 0.05
    lmp = lab.load(
        one(9.0, mass), tmp_path,
        ["region basin block -10 10 -10 10 -300 16", FALL,
         "fix water all mdanim/liquid basin 1.0 grid 20 20 316 level 10 gravity 0.01 buoyancy 1.0 drag 0.05 lambda d_lambda",
         "fix move all mdanim/leapfrog lambda d_lambda", "timestep 0.3", "run 2000"], columns={"lambda": np.zeros(1)},
    )  # fmt: skip
    # exp(-gamma t / mass) of the start is left.
    assert lab.by_tag(lmp, "v")[0, 2] == pytest.approx(-(mass - 1.0) * G / gamma, rel=1e-3)
    lmp.close()


def test_energies_close_without_drag(tmp_path):
    """Kinetic + gravity + minus the work of buoyancy stays the same for a particle that bobs."""
    body = one(11.0, 0.5)
    lmp = lab.load(
        body, tmp_path,
        [*BASIN, FALL, "fix_modify gravity energy yes", POOL + " buoyancy 1.0", "fix_modify water energy yes",
         "fix move all mdanim/leapfrog", "timestep 0.05", "thermo_style custom step pe", "run 0"],
    )  # fmt: skip
    start, found = lmp.get_thermo("pe"), []
    for _ in range(20):
        lmp.command("run 400")
        found.append(lmp.get_thermo("pe") + lab.kinetic(body, lab.by_tag(lmp, "v")) - start)
    # Second order in the step, of an energy of m g * 1 = 5e-3.
    assert np.abs(found).max() < 1e-6
    assert lmp.extract_fix("water", 0, 0) != 0.0
    lmp.close()


def test_drag_loss_is_that_of_the_leapfrog(tmp_path):
    """With no friction but the liquid's, both fixes sum up the same energy."""
    lmp = lab.load(
        one(5.0, 2.0, -0.3), tmp_path,
        [*BASIN, POOL + " buoyancy 1.0 drag 0.02 lambda d_lambda", "fix move all mdanim/leapfrog lambda d_lambda",
         "timestep 0.05", "run 200"], columns={"lambda": np.zeros(1)},
    )  # fmt: skip
    # The trapezoidal rule over whole steps against sums of half steps.
    assert value(lmp, "lost") == pytest.approx(lmp.extract_fix("move", 0, 0), rel=1e-4)
    assert value(lmp, "lost") > 0.01
    lmp.close()


def test_base_friction_is_added(tmp_path):
    """lambda = base + gamma rho V s."""
    columns = {"lambda": np.zeros(2), "air": np.array([0.25, 0.5])}
    body = lab.particles([[0.0, 0.0, 5.0], [3.0, 0.0, 14.0]])
    lmp = lab.load(body, tmp_path, [*BASIN, POOL + " buoyancy 2.0 drag 0.1 lambda d_lambda base d_air", "run 0"], columns=columns)
    assert lmp.numpy.extract_atom("d_lambda")[:2] == pytest.approx([0.25 + 0.1 * 2.0, 0.5], rel=1e-14)
    lmp.close()


# --- solids on the grid ---


def test_a_block_displaces_its_volume(tmp_path):
    """A block on the grid fills just its cells; the level is that of the liquid beside it."""
    lmp = block_in_pool(tmp_path, (4, 3, 2), (-2.0, -1.0, 2.0), ["run 0"])
    solid = np.zeros((16, 20, 20), bool)
    solid[2:4, 9:12, 8:12] = True
    assert np.array_equal(cells(lmp) == 255, solid)
    assert value(lmp, "solid") == 24
    # `level 10` is where the surface starts: 4000 cells less the block.
    assert value(lmp, "units") == 4000 - 24
    assert value(lmp, "level") == pytest.approx(10.0, abs=1e-12)
    lmp.close()


def test_a_block_floats_at_its_density(tmp_path):
    """A 4x4x4 block of half the density sinks in by half its height, wherever it comes from."""
    lmp = block_in_pool(tmp_path, (4, 4, 4), (-2.0, -2.0, 9.0), ["run 4000"])
    bottom = lab.by_tag(lmp, "x")[:25, 2].mean()
    assert value(lmp, "level") - bottom == pytest.approx(2.0, abs=0.02)  # 1 % of the side: noise of turning
    # At the start one layer of the block was below the surface at 10; now two are. The surface layer has 400 - 16 open cells.
    assert value(lmp, "level") == pytest.approx(10.0 + 16 / 384, abs=1e-12)
    assert value(lmp, "units") == value(lmp, "start") == 4000 - 16
    lmp.close()


def test_still_walls_part_the_surface(tmp_path):
    """A wall of still particles through the pool, filled on one side only: each side has its own height."""
    wall = lab.block((2, 20, 16), (-1.0, -10.0, 0.0))
    lmp = lab.load(
        wall, tmp_path,
        ["fix table all property/atom i2_cell 7 ghost yes", *lattice(wall, (2, 20, 16)), *BASIN,
         "region left block -10 -1 -10 10 0 16",
         "fix water all mdanim/liquid basin 1.0 grid 20 20 16 level 8 fill left gravity 0.01 cells i2_cell still all", "run 400"],
    )  # fmt: skip
    smooth, raw = np.empty((20, 20)), np.empty((20, 20))
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (smooth, raw)]
    call("liquid_heights", lmp, *pointers)
    assert np.array_equal(smooth[:, :9], np.full((20, 9), 8.0))
    assert np.array_equal(smooth[:, 11:], np.zeros((20, 9)))
    assert np.isnan(raw[:, 9:11]).all() and not np.isnan(raw[:, :9]).any()
    assert value(lmp, "units") == 8 * 9 * 20
    lmp.close()


def test_a_table_set_anew_between_two_runs_is_looked_up_again(tmp_path):
    """A corner whose only lattice cell is taken away is not lifted any more: what is left is its weight."""
    lmp = block_in_pool(tmp_path, (2, 2, 2), (-1.0, -1.0, 4.0), ["bond_coeff * 0.0 1.0", "run 20"], pool=POOL + " model waves")
    weight = -0.5 / 8 * 0.01
    assert lab.by_tag(lmp, "f")[0, 2] > 0.5 * abs(weight)
    lmp.command("set atom 1 i2_cell[1] 0")
    lmp.command("run 20")
    force = lab.by_tag(lmp, "f")[:, 2]
    assert force[0] == pytest.approx(weight, rel=1e-12) and force[1] > 0.5 * abs(weight)
    lmp.close()


def test_the_paper_model_lifts_what_liquid_is_near(tmp_path):
    """model paper: liquid in any of the 26 cells around lifts the whole of a particle, or none."""
    columns = {"lambda": np.zeros(3)}
    body = lab.particles([[0.0, 0.0, 4.0], [4.0, 0.0, 10.6], [8.0, 0.0, 12.0]])
    lmp = lab.load(
        body, tmp_path, [*BASIN, POOL + " model paper buoyancy 0.7 drag 0.1 lambda d_lambda", "run 0"], columns=columns
    )
    assert lab.by_tag(lmp, "f")[:, 2] == pytest.approx([0.7 * G, 0.7 * G, 0.0], abs=1e-15)
    assert lmp.numpy.extract_atom("d_lambda")[:3] == pytest.approx([0.07, 0.07, 0.0], rel=1e-14)
    lmp.close()


# --- sleep, state ---


def test_level_liquid_sleeps_and_wakes(tmp_path):
    """No sweep while a block is far above; sweeps when it has come; none again when it rests on the surface."""
    lmp = block_in_pool(tmp_path, (3, 3, 3), (-1.5, -1.5, 60.0), ["run 200"])
    assert (value(lmp, "sweeps"), value(lmp, "awake")) == (0, 0)
    lmp.command("run 4000")
    assert value(lmp, "sweeps") > 10
    lmp.command("run 6000")
    rested = value(lmp, "sweeps")
    lmp.command("run 2000")
    assert value(lmp, "sweeps") == rested
    assert value(lmp, "units") == 4000
    lmp.close()


def test_updates_come_after_a_stride(tmp_path):
    """Updates of a block that sinks through the pool: a longer stride has fewer, each of one sweep here,
    and one that is never done none."""
    seen = []
    for stride in (0.1, 1.0, 1e6):
        lmp = block_in_pool(
            tmp_path,
            (3, 3, 3),
            (-1.5, -1.5, 4.0),
            ["run 80"],
            density=1.0,
            velocity=(0.0, 0.0, -0.2),
            pool=f"{POOL} sweeps 1 period 1e6 stride {stride}",
        )
        seen.append(value(lmp, "sweeps"))
        lmp.close()
    assert seen[0] >= 2 * seen[1] > 2 * seen[2] == 0


def test_updates_come_after_a_period(tmp_path):
    """A dam has just broken, with nothing near it: at looks every 4 steps of 0.3, a period of 6 sees every fifth."""
    seen = []
    for period in (0.06, 0.6, 1e6):  # times sqrt(cell/g) = 10
        lmp = lab.load(
            one(60.0),
            tmp_path,
            [
                *BASIN,
                "region half block -10 0 -10 10 0 16",
                f"{POOL.replace('level 10', 'volume 1000 fill half')} sweeps 1 period {period}",
                "fix move all mdanim/leapfrog",
                "timestep 0.3",
                "run 80",
            ],
        )
        seen.append(value(lmp, "sweeps"))
        lmp.close()
    assert seen == [20, 4, 0]


OUT_OF_MEMORY = """
import ctypes, resource, sys
import numpy as np, plugin_lab as lab, state_lab
from pathlib import Path
from liquid_lab import BASIN, call, one

pool = "fix water all mdanim/liquid basin 1.0 grid 2000 2000 4 level 10 gravity 0.01"
lmp = lab.load(one(5.0), Path(sys.argv[1]), [*BASIN, pool, "fix move all mdanim/leapfrog", "run 0"])
smooth, raw = np.empty((2, 2000, 2000))
pages = int(Path("/proc/self/statm").read_text().split()[0])
now = pages * resource.getpagesize() + 2**20
resource.setrlimit(resource.RLIMIT_AS, (now, now))
for ask in (
    lambda: call("liquid_heights", lmp, *(a.ctypes.data_as(ctypes.c_void_p) for a in (smooth, raw))),
    lambda: state_lab.pack(lmp, "water"),
):
    try:
        ask()
        print("done")
    except RuntimeError as error:
        print(error)
"""


@pytest.mark.no_memory
def test_out_of_memory_is_told(tmp_path):
    """In a process that may take no more memory each function returns with a message, and the process goes on."""
    paths = {"PYTHONPATH": os.pathsep.join(sys.path), "LAMMPS_PLUGIN_PATH": folder()}
    done = subprocess.run(
        [sys.executable, "-c", OUT_OF_MEMORY, str(tmp_path)],
        env={**os.environ, **paths},
        capture_output=True,
        text=True,
        timeout=100,
    )
    assert (done.returncode, done.stdout.split("\n")) == (0, ["out of memory"] * 2 + [""]), done.stderr


def test_a_still_body_that_was_moved_is_marked_anew(tmp_path):
    """A wall is shifted between two runs: its cells follow at the setup, and no liquid is lost."""
    wall = lab.block((2, 4, 14), (-5.0, -2.0, 0.0))
    lmp = lab.load(
        wall, tmp_path,
        ["fix table all property/atom i2_cell 7 ghost yes", *lattice(wall, (2, 4, 14)), *BASIN,
         POOL + " cells i2_cell still all", "run 8"],
    )  # fmt: skip
    before = cells(lmp) == 255
    lmp.command("displace_atoms all move 6 0 0")
    lmp.command("run 8")
    after = cells(lmp) == 255
    assert before[:14, 8:12, 5:7].all() and before.sum() == after.sum() == 2 * 4 * 14
    assert after[:14, 8:12, 11:13].all()
    assert value(lmp, "units") == value(lmp, "start")
    lmp.close()


def test_a_lid_from_wall_to_wall_still_floats(tmp_path):
    """No column tells a height: the liquid's own volume does, and a sinking lid comes back up."""
    lmp = block_in_pool(tmp_path, (20, 20, 2), (-10.0, -10.0, 10.0), ["run 3000"])
    bottom = lab.by_tag(lmp, "x")[:, 2].min()
    # It floats in by half of its two cells; below it there is no room for liquid that is not there.
    assert 8.0 < bottom < 10.5
    assert np.abs(lab.by_tag(lmp, "v")[:, 2]).max() < 0.1
    assert value(lmp, "units") == value(lmp, "start")
    lmp.close()


# --- refusals ---


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("fix w all mdanim/liquid nowhere 1 grid 4 4 4 level 2 gravity 1", "there is no region nowhere"),
        ("fix w all mdanim/liquid ball 1 grid 4 4 4 level 2 gravity 1", "style block"),
        ("fix w all mdanim/liquid basin -1 grid 4 4 4 level 2 gravity 1", "density must be > 0, got -1"),
        ("fix w all mdanim/liquid basin 1 grid 4 0 4 level 2 gravity 1", "grid must be >= 1 along every axis, got 0"),
        ("fix w all mdanim/liquid basin 1 grid 4000 4000 4000 level 2 gravity 1", "too large"),
        # Few enough cells, but too many bytes of state, or too many places with the rim of the grid.
        ("fix w all mdanim/liquid basin 1 grid 20000 20000 1 level 2 gravity 1", "too large: 1.2e.09 cells .* 3.6e.09 bytes"),
        ("fix w all mdanim/liquid basin 1 grid 1 1 1000000000 level 2 gravity 1", "too large: 1.2e.10 cells"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 gravity 1", "either volume V or level Z"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 volume 3 gravity 1", "not both"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2", "gravity G is missing"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 20 gravity 1", "not within the basin"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 wet yes", "unknown keyword wet"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 still none", "no group none"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 lambda 3", "must be a per-particle property"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 lambda d_no", "make it with"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 stride 0", "stride must be > 0, got 0"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 period x", "Expected floating point"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 sweeps 0", "auto or 1 to"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 model wave", "surface, paper or waves"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 calm 3", "calm is for model waves; leave it out"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 model waves calm 0", "calm must be > 0, got 0"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 drops 0.5", "drops is for model waves; leave it out"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 model waves drops 2", "a share from 0 to 1, got 2"),
        *(
            (
                f"fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 model waves {maker}",
                f"the {maker.split()[0]} comes at 1e9; in this basin liquid flows at .* at most",
            )
            for maker in ("current +y 1e9", "inflow basin 1 1e9 0", "inflow basin 1 0 1e9")
        ),
        ("fix w all mdanim/liquid basin 1 grid 4 4 6 level 2 gravity 1 model waves", "too far from cubes.*another number"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 2 gravity 1 model waves\nrun 0", "add cells i2_NAME"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 level 0.1 gravity 1\nrun 0", "level 0.1 is less than half a cell"),
        ("fix w all mdanim/liquid basin 1 grid 4 4 4 volume 40 gravity 1\nrun 0", "volume 40.* is less than half a cell"),
    ],
)  # fmt: skip
def test_refuses_with_a_cure(tmp_path, command, message):
    """Every wrong argument has its own message."""
    with pytest.raises(Exception, match=message):
        lab.load(one(5.0), tmp_path, [*BASIN, "region ball sphere 0 0 0 5", *command.split("\n")])


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ("buoyancy 1 drag 0.1", "drag needs lambda"),
        ("buoyancy 1 lambda d_lambda", "there is no drag"),
        ("drag 0.1 lambda d_lambda", "add buoyancy"),
        ("cells i2_none", "not a property of 7 integers"),
        ("faces i2_none", "faces is not there any more; write model waves"),
    ],
)
def test_refuses_what_does_not_fit_together(tmp_path, keywords, message):
    """Keywords that need each other are checked when a run starts."""
    with pytest.raises(Exception, match=message):
        lab.load(one(5.0), tmp_path, [*BASIN, POOL, f"fix_modify water {keywords}", "run 0"], columns={"lambda": np.zeros(1)})


def test_liquid_that_finds_no_room_is_refused(tmp_path):
    """More liquid than open cells: the numbers are told, nothing is poured away."""
    with pytest.raises(Exception, match="400 of 6800 cells of liquid find no room"):
        lab.load(one(50.0), tmp_path, [*BASIN, POOL.replace("level 10", "volume 6800"), "run 0"])
