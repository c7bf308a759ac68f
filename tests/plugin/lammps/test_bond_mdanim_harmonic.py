# SPDX-License-Identifier: GPL-2.0-only
"""bond_style mdanim/harmonic against its naive twin, the stock style, and bit for bit itself."""

import re
from dataclasses import replace

import numpy as np
import plugin_lab as lab
import pytest
from twin.spring import spring_forces

BODY = lab.shaken(lab.join(lab.block((4, 3, 2)), lab.block((2, 2, 2), (6.0, 0.0, 0.0))), 0.05)


def final_state(body, folder, commands, **options):
    """x and v in tag order after the commands."""
    lmp = lab.load(body, folder, commands, **options)
    try:
        return np.concatenate([lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v")])
    finally:
        lmp.close()


@pytest.mark.parametrize("c", [None, 0.3], ids=["springs", "springs and dashpots"])
def test_forces_equal_the_naive_twin(tmp_path, c):
    """Sum the same springs one by one."""
    lmp = lab.load(BODY, tmp_path, ["fix run all mdanim/leapfrog", "run 0"], c=c)
    force, energy = spring_forces(BODY.x, BODY.v, BODY.bond, BODY.k, BODY.r0, c or 0.0)
    # Sums of up to 18 terms of size 0.1: 1e-14 is a few dozen roundings.
    assert np.abs(lab.by_tag(lmp, "f") - force).max() < 1e-14
    assert lmp.get_thermo("ebond") == pytest.approx(energy, rel=1e-12)
    lmp.close()


@pytest.mark.parametrize("shuffled", [False, True], ids=["in tag order", "shuffled"])
def test_stock_style_gives_the_same_forces_energy_and_virial(tmp_path, shuffled):
    """Run 0 with bond_style harmonic and with ours, by halves and in gather form."""
    order = np.random.default_rng(6).permutation(len(BODY.x)) if shuffled else None
    found = []
    for style in ("harmonic", "mdanim/harmonic"):
        lmp = lab.load(
            BODY,
            tmp_path,
            [
                "compute u all pe/atom bond",
                "compute s all stress/atom NULL bond",
                "compute total all reduce sum c_u c_s[*]",
                "compute p all pressure NULL bond",
                "fix run all mdanim/leapfrog",
                "thermo_style custom step ebond press c_total[*] c_p c_p[*]",
                "run 0",
            ],
            style=style,
            order=order,
        )
        total = [lmp.numpy.extract_compute("total", 0, 1), lmp.numpy.extract_compute("p", 0, 1)]
        per_atom = [lmp.numpy.extract_compute("u", 1, 1), *lmp.numpy.extract_compute("s", 1, 2).T]
        found.append([lab.by_tag(lmp, "f").ravel(), [lmp.get_thermo("ebond")], *map(np.copy, total + per_atom)])
        lmp.close()
    for stock, ours in zip(*found):
        # Same terms, another order: a few roundings of the largest of them.
        assert np.abs(np.subtract(stock, ours)).max() <= 1e-12 * np.abs(stock).max()


@pytest.mark.parametrize("c", [None, 0.2], ids=["springs", "springs and dashpots"])
def test_order_of_particles_changes_no_bit(tmp_path, c):
    """Shuffle the data file: the gather path replaces the half evaluation."""
    commands = ["fix run all mdanim/leapfrog", "timestep 0.2", "run 300"]
    order = np.random.default_rng(5).permutation(len(BODY.x))
    straight = final_state(BODY, tmp_path, commands, c=c)
    assert np.abs(straight[: len(BODY.x)] - BODY.x).max() > 0.1
    assert np.array_equal(straight, final_state(BODY, tmp_path, commands, order=order, c=c))


def test_springs_reach_through_a_periodic_boundary(tmp_path):
    """A body laid across the edge of a periodic box feels what stock springs make it feel."""
    found = []
    for style in ("harmonic", "mdanim/harmonic"):
        lmp = lab.load(
            BODY,
            tmp_path,
            [
                "change_box all boundary p p p x final 0.0 9.0 y final -2.0 6.0 z final -2.0 6.0",
                "displace_atoms all move 7.3 0 0",
                "fix run all mdanim/leapfrog",
                "run 0",
            ],
            style=style,
        )
        assert np.ptp(lab.by_tag(lmp, "x")[BODY.molecule == 1][:, 0]) > 7.0
        found.append(lab.by_tag(lmp, "f"))
        lmp.close()
    assert np.abs(found[0]).max() > 0.1
    assert np.abs(found[1] - found[0]).max() < 1e-13


def test_rebuilding_lists_changes_no_bit(tmp_path):
    """Rebuild in every step instead of when needed, and cut the run in pieces."""
    fast = replace(BODY, v=BODY.v + [0.3, 0.0, 0.0])
    fix = ["fix run all mdanim/leapfrog", "timestep 0.2"]
    one = final_state(fast, tmp_path, [*fix, "run 100"])
    every = final_state(fast, tmp_path, [*fix, "neigh_modify every 1 delay 0 check no", "run 100"])
    pieces = final_state(fast, tmp_path, [*fix, "run 0", *["run 10 pre no post no"] * 10])
    assert np.array_equal(one, every)
    assert np.array_equal(one, pieces)


def test_bonds_cut_between_runs_are_noticed(tmp_path):
    """Delete all bonds of the second object between two runs: its particles feel nothing any more."""
    lmp = lab.load(
        BODY,
        tmp_path,
        ["fix run all mdanim/leapfrog", "run 0", "group second molecule 2", "delete_bonds second multi remove", "run 0"],
    )
    force = lab.by_tag(lmp, "f")
    assert np.all(force[BODY.molecule == 2] == 0.0)
    assert np.all(np.abs(force[BODY.molecule == 1]).max(1) > 0.0)
    lmp.close()


def test_bonds_cut_during_a_run_are_noticed(tmp_path):
    """Let stock fix bond/break take the longer of two springs in the middle of a run."""
    chain = replace(
        lab.particles([[0.0, 0, 0], [1.5, 0, 0], [3.0, 0, 0], [6.0, 0, 0]], molecule=[1, 1, 1, 1]),
        bond=np.array([[0, 1], [2, 3]]),
        k=np.full(2, 0.1),
        r0=np.full(2, 1.0),
    )
    lmp = lab.load(
        chain,
        tmp_path,
        ["fix run all mdanim/leapfrog", "fix break all bond/break 5 1 2.5", "timestep 0.01", "run 7"],
        special="0 1 1",
        cutoff=6.0,
    )
    force = lab.by_tag(lmp, "f")[:, 0]
    assert force[0] == -force[1] == pytest.approx(0.05, rel=1e-2)
    assert np.all(force[2:] == 0.0)
    lmp.close()


def test_internal_forces_cancel_and_momentum_stays(tmp_path):
    """Momentum of a ringing, damped body after 500 steps is that of the start."""
    lmp = lab.load(BODY, tmp_path, ["fix run all mdanim/leapfrog", "timestep 0.2", "run 500"], c=0.1)
    before = (BODY.mass[:, None] * BODY.v).sum(0)
    after = (BODY.mass[:, None] * lab.by_tag(lmp, "v")).sum(0)
    # 500 steps of 60 velocities of size 0.05 rounded at 1e-17.
    assert np.abs(after - before).max() < 1e-13
    lmp.close()


def test_two_particles_in_one_place_feel_no_spring(tmp_path):
    """A spring of length zero has no direction: force zero, no NaN."""
    pair = replace(
        lab.particles([[0.0, 0, 0], [0.0, 0, 0]], molecule=[1, 1]), bond=np.array([[0, 1]]), k=np.array([1.0]), r0=np.array([1.0])
    )
    lmp = lab.load(pair, tmp_path, ["fix run all mdanim/leapfrog", "run 0"], c=0.5)
    assert np.all(lab.by_tag(lmp, "f") == 0.0)
    lmp.close()


def dashpot_loss(lmp) -> float:
    """Loss by dashpots so far, on this rank [J]."""
    import ctypes

    import plugin_path

    library = ctypes.CDLL(plugin_path.folder() + "/mdanimplugin.so")
    library.mdanim_bond_lost.restype = ctypes.c_double
    return library.mdanim_bond_lost(ctypes.c_void_p(getattr(lmp.lmp, "value", lmp.lmp)))


def missing(tmp_path, dt: float, commands=()) -> tuple[float, float]:
    """Energy that goes missing from t = 2 to t = 20, and what dashpots say to have taken then, both over the first."""
    lmp = lab.load(
        BODY, tmp_path, ["fix run all mdanim/leapfrog", f"timestep {dt!r}", "thermo_style custom step pe", *commands], c=0.1
    )
    # Not from t = 0: the forces of a setup see whole-step velocities, which is another motion for half a step.
    energy, lost = zip(*((lab.conserved(lmp, BODY, dt, round(t / dt)), dashpot_loss(lmp)) for t in (2.0, 18.0)))
    lmp.close()
    return (energy[0] - energy[1]) / energy[0], (lost[1] - lost[0]) / energy[0]


def test_dashpot_loss_is_the_energy_that_is_missing(tmp_path):
    """The loss is the missing energy; the rest falls with the third power of the time step, by the ends of the account."""
    errors = []
    for dt in (0.16, 0.08, 0.04):
        found, lost = missing(tmp_path, dt)
        assert lost > 0.05
        errors.append(abs(found - lost))
    assert errors[0] > 5.0 * errors[1] > 25.0 * errors[2]
    assert errors[2] < 1e-5


def test_passes_sum_the_same_loss_spring_by_spring(tmp_path):
    """The motion of plain steps, and their loss but for the bend of one pass and rates of four bytes."""
    plain, passes = (missing(tmp_path, 0.04, [f"run_style {style}"]) for style in ("verlet", "verlet/mdanim"))
    assert passes[0] == pytest.approx(plain[0], rel=1e-9)
    assert passes[1] != plain[1]
    assert passes[1] == pytest.approx(plain[1], rel=3e-6)


def test_dashpot_loss_survives_a_new_order_of_particles(tmp_path):
    """Let LAMMPS sort particles in the middle of the run; only the steps across a sort are estimated."""
    plain, other = missing(tmp_path, 0.04), missing(tmp_path, 0.04, ["atom_modify sort 20 1.1"])
    assert other[0] == pytest.approx(plain[0], rel=1e-9)
    assert other[1] != plain[1]
    assert other[1] == pytest.approx(plain[1], rel=1e-4)


def test_single_restart_and_data_file_keep_the_coefficients(tmp_path):
    """Write a restart and a data file and read both back; compute bond/local asks single()."""
    lmp = lab.load(
        BODY,
        tmp_path,
        [
            "fix run all mdanim/leapfrog",
            "compute e all bond/local engpot force",
            "run 0",
            f"write_restart {tmp_path}/r",
            f"write_data {tmp_path}/d",
        ],
        c=0.125,
    )
    force = lab.by_tag(lmp, "f")
    local = lmp.numpy.extract_compute("e", 2, 2)
    assert local[:, 0].sum() == pytest.approx(lmp.get_thermo("ebond"), rel=1e-12)
    lmp.close()

    import plugin_path

    for read in (
        ["atom_modify map array sort 0 0", "newton off", f"read_restart {tmp_path}/r"],
        [
            *lab.prelude()[:-1],
            "fix model all property/atom rmass",
            "bond_style mdanim/harmonic",
            f"read_data {tmp_path}/d fix model NULL model",
        ],
    ):
        other = plugin_path.lammps()
        for command in ["fix model all property/atom rmass"] if "read_restart" in read[-1] else []:
            read = [*read, command]
        for command in [*read, "pair_style none", "comm_modify cutoff 3", "fix run all mdanim/leapfrog", "run 0"]:
            other.command(command)
        again = lab.by_tag(other, "f")
        other.close()
        if "read_restart" in " ".join(read):
            assert np.array_equal(again, force)
        else:
            # write_data rounds positions to 16 digits.
            assert np.abs(again - force).max() < 1e-14


@pytest.mark.parametrize("style", ["verlet", "verlet/mdanim"])
def test_new_coefficients_act_without_a_setup(tmp_path, style):
    """Alter a spring after a run and go on with 'pre no': from the next force on it is the new spring that pulls."""
    pair = lab.join(*(lab.particles([[1.5 * k, 0.0, 0.0]], molecule=[1]) for k in range(2)))
    pair = replace(pair, bond=np.array([[0, 1]]), k=np.array([2.0]), r0=np.ones(1), molecule=np.ones(2, int))
    commands = ["fix run all mdanim/leapfrog", "timestep 1e-6", f"run_style {style}", "run 3"]
    lmp = lab.load(pair, tmp_path, [*commands, "bond_coeff 1 100.0 1.0", "run 5 pre no"])
    assert lab.by_tag(lmp, "f")[0, 0] == pytest.approx(100.0, rel=1e-6)
    lmp.close()
    lmp = lab.load(pair, tmp_path, [*commands, "bond_coeff 1 1.0 1.0 0.2"])
    with pytest.raises(Exception, match=r"dashpots .* leave out 'pre no' of this run"):
        lmp.command("run 5 pre no")
    lmp.close()


def test_a_restart_of_another_version_is_refused(tmp_path):
    """Alter the version of the record of coefficients in a restart file, and leave it out as files before had none."""
    import plugin_path

    lmp = lab.load(BODY, tmp_path, ["fix run all mdanim/leapfrog", "run 0", f"write_restart {tmp_path}/r"])
    lmp.close()
    table, _ = lab.bond_types(BODY)
    file, coefficients = (tmp_path / "r").read_bytes(), np.array([0.5 * table[0, 0], table[0, 1], 0.0]).tobytes()
    at = file.index(coefficients)
    assert file[at - 4 : at] == np.int32(1).tobytes()
    for changed, version in ((file[: at - 4] + np.int32(7).tobytes() + file[at:], "7"), (file[: at - 4] + file[at:], "-?[0-9]+")):
        (tmp_path / "r").write_bytes(changed)
        other = plugin_path.lammps()
        for command in ["atom_modify map array sort 0 0", "newton off"]:
            other.command(command)
        with pytest.raises(Exception, match=f"record of coefficients has version {version}, 1 is needed; write the restart"):
            other.command(f"read_restart {tmp_path}/r")
        other.close()


@pytest.mark.parametrize(
    ("commands", "options", "message"),
    [
        pytest.param(["run 0"], {"newton": "on"}, "put 'newton off'", id="newton on"),
        pytest.param(["bond_coeff 1 -1.0 1.0"], {}, "K must be >= 0, got -1.0", id="negative K"),
        pytest.param(["bond_coeff 1 1.0 -2"], {}, "r0 must be >= 0, got -2", id="negative rest length"),
        pytest.param(["bond_coeff 1 1.0 1.0 -3"], {}, "c must be >= 0, got -3", id="negative dashpot"),
        pytest.param(["bond_coeff 1 1.0 1.0 1.0 1.0"], {}, "coefficients are K r0 [c], got 4 words", id="too many words"),
        pytest.param(
            [
                "thermo_modify lost/bond ignore",
                "set group all x 0.0",
                "group gone id 1",
                "delete_atoms group gone compress no bond no",
                "run 0",
            ],
            {},
            "has lost its bond partner 1 at step 0",
            id="partner lost",
        ),
    ],
)
def test_mistakes_are_refused_with_the_cure(tmp_path, commands, options, message):
    """Give one wrong word or setting."""
    with pytest.raises(Exception, match=re.escape(message)):
        lab.load(BODY, tmp_path, commands, **options).close()
