# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/liquid: its state is taken up to the bit, by its own functions and by restart files."""

import numpy as np
import plugin_lab as lab
import plugin_path
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
    with pytest.raises(RuntimeError, match=r"cut off: it has \d+ bytes"):
        take_up(second, stored[:-1])
    first.close()
    second.close()


HEAD = np.dtype(
    [
        ("kind", "S8"),
        ("version", "f8"),
        *((n, "f8") for n in ("work", "lost", "work_power", "lost_power")),
        *((n, "i8") for n in ("nx", "ny", "nz", "units", "swept", "calm")),
        ("before", "f8"),
        ("waited", "i8"),
        ("dt", "f8"),
        ("looked", "i8"),
        *((n, "f8") for n in ("travel", "crossed")),
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


WAVES_HEAD = np.dtype(
    [
        ("kind", "S8"),
        ("version", "f8"),
        *((n, "f8") for n in ("work", "lost", "work_power", "lost_power")),
        *((n, "i8") for n in ("nx", "ny", "nz", "units", "updates", "stale", "moving")),
        ("still", "u8"),
        *((n, t) for n, t in zip(("before", "steps", "dt", "looked"), ("f8", "i8", "f8", "i8"))),
        *((n, "f8") for n in ("gone", "slept", "travel", "energy")),
        ("impulses", "f8", 9),
        ("outer", "f8"),
        ("drops", "u8"),
    ]
)
COLUMNS = [("mass", "f8"), ("afloat", "f8", 2), ("ambient", "f8"), ("added", "f8", 3)]


@pytest.fixture(scope="module")
def splash(tmp_path_factory):
    """A block that has just fallen into waves, with a paddle that owes a part of a unit; and the state of it all."""
    lmp = block_in_pool(tmp_path_factory.mktemp("splash"), pool=f"{POOL} model waves drops 1 wave -x 0.3 50", **FAST)
    lmp.command("run 60")
    yield lmp, state(lmp)
    lmp.close()


def parts(stored):
    """The head, and an array for each of COLUMNS, as views of the bytes of a state."""
    views, at = {"head": stored[: WAVES_HEAD.itemsize].view(WAVES_HEAD)}, WAVES_HEAD.itemsize
    for name, *kind in COLUMNS:
        shape = (400, *kind[1:])
        size = 8 * int(np.prod(shape))
        views[name] = stored[at : at + size].view("f8").reshape(shape)
        at += size
    views["paddle"] = stored[at : at + 8].view("f8")
    views["due"] = stored[at + 24 : at + 32].view("f8")
    return views


def test_the_state_of_waves_is_as_it_is_read_here(splash):
    """Numbers that are known otherwise stand where the other tests damage them."""
    lmp, stored = splash
    found = parts(stored)
    head = found["head"][0]
    assert (head["kind"], head["nx"], head["nz"], head["looked"]) == (b"waves", 20, 16, 60)
    assert head["gone"] + head["slept"] + head["steps"] * head["dt"] == pytest.approx(60 * 0.3)
    assert found["afloat"][:, 0].sum() == pytest.approx(27 * 0.5, abs=0.2) and found["paddle"][0] == pytest.approx(
        head["gone"] / 10
    )
    assert (found["mass"] > 0).any() and np.isnan(found["ambient"]).any() and np.isfinite(found["ambient"]).any()
    take_up(lmp, stored)
    assert np.array_equal(state(lmp), stored)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1e300])
@pytest.mark.parametrize(
    ("part", "field"),
    [
        *(("head", name) for name in ("before", "dt", "gone", "slept", "travel", "work", "lost", "work_power", "lost_power")),
        *(("head", name) for name in ("energy", "impulses", "outer")),
        *((name, None) for name in ("mass", "afloat", "ambient", "added", "paddle", "due")),
    ],
)
def test_no_number_of_a_state_is_taken_unlooked_at(splash, part, field, bad):
    """One that is none, or negative where none can be, would be lift a step later; nothing changes. Heads around bodies may be
    unknown, and energies and heads may be anything finite."""
    lmp, stored = splash
    damaged = stored.copy()
    target = parts(damaged)[part]
    if field == "impulses":
        target[field][0, 3] = bad
    elif field:
        target[field] = bad
    else:
        target.reshape(-1)[{"afloat": 2, "added": 3}.get(part, 0)] = bad
    anything = part == "ambient" or field in ("work", "lost", "work_power", "lost_power", "energy", "impulses", "outer")
    if (np.isnan(bad) and part == "ambient") or (bad == -1e300 and anything):
        return
    with pytest.raises(RuntimeError, match="is damaged: "):
        take_up(lmp, damaged)
    assert np.array_equal(state(lmp), stored)


@pytest.mark.parametrize("field", ["units", "updates", "moving", "steps", "looked"])
def test_no_count_of_a_state_is_negative(splash, field):
    """Such a state is refused."""
    lmp, stored = splash
    damaged = stored.copy()
    parts(damaged)["head"][field] = -1
    with pytest.raises(RuntimeError, match="is damaged: a count is -1"):
        take_up(lmp, damaged)


def test_liquid_faster_than_it_may_be_is_refused(splash):
    """Its updates would have no end: 10^9 cells a time are as many sub-updates."""
    lmp, stored = splash
    damaged = stored.copy()
    damaged[-16:-8].view("f8")[:] = 1e9
    with pytest.raises(RuntimeError, match="faster than 16"):
        take_up(lmp, damaged)


def test_a_state_of_an_older_version_is_refused(splash):
    """Its numbers stand in other places."""
    lmp, stored = splash
    older = stored.copy()
    parts(older)["head"]["version"] -= 1
    with pytest.raises(RuntimeError, match=r"not of version \d+ of kind waves, .*another version of the plugin"):
        take_up(lmp, older)
    assert np.array_equal(state(lmp), stored)


def test_each_kind_of_liquid_refuses_the_state_of_the_other(tmp_path, splash):
    """By a word, whatever their versions are."""
    waves, of_waves = splash
    surface = block_in_pool(tmp_path, **FAST)
    surface.command("run 0")
    of_surface = state(surface)
    assert of_surface[:8].tobytes() != of_waves[:8].tobytes()
    of_surface[8:16] = of_waves[8:16]
    with pytest.raises(RuntimeError, match=r"kind waves, .*another model"):
        take_up(waves, of_surface)
    of_waves = of_waves.copy()
    of_waves[8:16] = state(surface)[8:16]
    with pytest.raises(RuntimeError, match=r"kind automat, .*another model"):
        take_up(surface, of_waves)
    surface.close()


def test_held_cells_of_a_state_open_where_no_body_is_held(tmp_path):
    """A state of a wall at one place is taken up where the wall stands at another: its old cells open at the next setup."""

    def wall(x):
        body = lab.block((2, 4, 14), (x, -2.0, 0.0))
        return lab.load(
            body, tmp_path,
            ["fix table all property/atom i2_cell 7 ghost yes", *lattice(body, (2, 4, 14)), *BASIN,
             POOL + " cells i2_cell still all", "run 8"],
        )  # fmt: skip

    first, second = wall(-5.0), wall(3.0)
    take_up(second, state(first))
    second.command("run 8")
    found = cells(second) == 255
    assert np.count_nonzero(found) == 2 * 4 * 14 and found[:14, 8:12, 13:15].all()
    first.close()
    second.close()


@pytest.mark.parametrize(("ghost", "told"), [("no", "add 'ghost yes' to its fix property/atom"), ("yes", "")])
def test_ghosts_need_rows_of_cells_on_several_ranks(tmp_path, ghost, told):
    """Else a lattice cell whose first corner is another rank's would be read from a row that is not its own."""
    shape = (3, 2, 2)
    body = lab.block(shape, (-1.5, -1.0, 8.0))
    table = [f"fix table all property/atom i2_cell 7 ghost {ghost}", *lattice(body, shape)]
    commands = [*table, *BASIN, POOL + " cells i2_cell buoyancy 1.0", "fix run all mdanim/leapfrog", "run 1"]
    (tmp_path / "in.test").write_text("\n".join(lab.script(body, tmp_path, commands)) + "\n")
    done = plugin_path.lmp(tmp_path / "in.test", 2)
    assert (done.returncode != 0) == bool(told) and told in done.stdout + done.stderr, done.stdout + done.stderr
