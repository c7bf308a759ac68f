# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/leapfrog against eq. (3.12) as printed, its energy account, its options."""

import re

import numpy as np
import plugin_lab as lab
import pytest
from twin.leapfrog import exponential, leapfrog
from twin.spring import spring_forces

BODY = lab.shaken(lab.block((3, 2, 2)), 0.05)
DRAG = np.random.default_rng(2).uniform(0.0, 0.4, len(BODY.x))


def force(x):
    """Springs alone."""
    return spring_forces(x, BODY.v, BODY.bond, BODY.k, BODY.r0)[0]


def run(folder, fix, steps=50, dt=0.2, **options):
    """x, v in tag order, the fix's scalar and its vector after a run."""
    lmp = lab.load(BODY, folder, [f"fix run all mdanim/leapfrog {fix}", f"timestep {dt}", f"run {steps}"], **options)
    result = (
        lab.by_tag(lmp, "x"),
        lab.by_tag(lmp, "v"),
        lmp.extract_fix("run", 0, 0),
        [lmp.extract_fix("run", 0, 1, n) for n in (0, 2)],
    )
    lmp.close()
    return result


@pytest.mark.parametrize("drag", [0.0, 0.3, 40.0], ids=["no drag", "phi up to 0.24", "phi above 1"])
def test_equals_the_scheme_as_printed(tmp_path, drag):
    """Advance half-step velocities by (3.12); compare positions, whole-step velocities (3.10), loss."""
    x, v, lost, _ = run(tmp_path, f"lambda {drag}" if drag else "")
    x0, v0, lost0 = leapfrog(BODY.x, BODY.v, force, BODY.mass, np.full(len(BODY.x), drag), 0.2, 50)
    # Two ways to round 50 steps; a spring system does not amplify much.
    assert np.abs(x - x0).max() < 1e-12
    assert np.abs(v - v0).max() < 1e-12
    assert lost == pytest.approx(lost0, rel=1e-11, abs=1e-15)


def test_every_particle_has_its_own_drag(tmp_path):
    """Read lambda from a property."""
    x, v, lost, (phi, seconds) = run(tmp_path, "lambda d_drag", columns={"drag": DRAG})
    x0, v0, lost0 = leapfrog(BODY.x, BODY.v, force, BODY.mass, DRAG, 0.2, 50)
    assert np.abs(x - x0).max() < 1e-12
    assert np.abs(v - v0).max() < 1e-12
    assert lost == pytest.approx(lost0, rel=1e-11)
    assert phi == pytest.approx((DRAG * 0.2 / 2.0 / BODY.mass).max(), rel=1e-14)
    assert 0.0 < seconds < 10.0


@pytest.mark.parametrize("drag", [0.0, 0.3], ids=["no drag", "drag"])
@pytest.mark.parametrize("style", ["verlet", "verlet/mdanim"])
def test_kinetic_energy_is_that_of_the_smooth_path(tmp_path, style, drag):
    """Work out T - dt v.(F' - F)/12 - dt^2 F.F/24m from the forces of the last two steps;
    at the start there is no step before."""
    dt, m = 0.2, BODY.mass[:, None]
    lmp = lab.load(
        BODY,
        tmp_path,
        [
            "fix run all mdanim/leapfrog" + (f" lambda {drag}" if drag else ""),
            f"run_style {style}",
            "fix_modify run energy no",
            f"timestep {dt}",
            "run 0",
        ],
    )

    def told():
        return lmp.extract_fix("run", 0, 1, 1)

    swing = dt**2 * (lab.by_tag(lmp, "f") ** 2 / m).sum() / 24.0
    assert told() == pytest.approx(lab.kinetic(BODY, lab.by_tag(lmp, "v")) - swing, rel=1e-13)
    for steps in (7, 1, 30):
        if steps > 1:
            lmp.command(f"run {steps - 1} pre no")
        before = lab.by_tag(lmp, "f")
        lmp.command("run 1 pre no")
        f, v = lab.by_tag(lmp, "f"), lab.by_tag(lmp, "v")
        half = v * (1.0 + drag * dt / 2.0 / m) - 0.5 * dt * f / m  # (3.10) solved for v(n-1/2)
        bent, swing = dt * (half * (f - before)).sum() / 12.0, dt**2 * (f**2 / m).sum() / 24.0
        assert min(abs(bent), swing) > 1e-6 * lab.kinetic(BODY, v)
        assert told() == pytest.approx(lab.kinetic(BODY, v) - bent - swing, rel=1e-13)
    lmp.command("run 25 pre no")  # in one piece: by passes where there are some
    whole = told()
    other = lab.load(
        BODY,
        tmp_path,
        ["fix run all mdanim/leapfrog" + (f" lambda {drag}" if drag else ""), f"timestep {dt}", "run_style verlet", "run 63"],
    )
    assert whole == pytest.approx(other.extract_fix("run", 0, 1, 1), rel=1e-12)
    other.close()
    lmp.close()


@pytest.mark.parametrize("style", ["verlet", "verlet/mdanim"])
def test_kinetic_energy_is_refused_where_it_is_not_known(tmp_path, style):
    """Average over steps with output, which is right; ask in others, which stops the run instead of giving what it was once."""
    lmp = lab.load(
        BODY,
        tmp_path,
        [
            "fix run all mdanim/leapfrog",
            f"run_style {style}",
            "timestep 0.2",
            "thermo 5",
            f"fix mean all ave/time 5 1 5 f_run[2] file {tmp_path / 'mean'}",
            "run 20",
        ],
    )
    seen = lmp.extract_fix("run", 0, 1, 1)
    assert float((tmp_path / "mean").read_text().split()[-1]) == pytest.approx(seen, rel=1e-5)
    lmp.commands_list(["thermo 10", "unfix mean"])
    lmp.command("run 20 every 4 NULL")
    assert lmp.extract_fix("run", 0, 1, 1) != seen
    lmp.command(f"fix mean all ave/time 5 1 5 f_run[2] file {tmp_path / 'mean'}")
    with pytest.raises(Exception, match=r"f_run\[2\], is worked out in steps with output alone"):
        lmp.command("run 20")
    lmp.close()


@pytest.mark.parametrize("drag", [1e-9, 0.3, 40.0, 1e5])
def test_exponential_drag_equals_exp(tmp_path, drag):
    """Our exp from + - * / agrees with NumPy's, from the series for small phi to complete decay."""
    x, v, lost, _ = run(tmp_path, f"lambda {drag} drag exp")
    x0, v0 = exponential(BODY.x, BODY.v, force, BODY.mass, np.full(len(BODY.x), drag), 0.2, 50)
    assert np.abs(x - x0).max() < 1e-12
    assert np.abs(v - v0).max() < 1e-12
    assert lost > 0.0


@pytest.mark.parametrize("kind", ["implicit", "exp"])
def test_terminal_velocity(tmp_path, kind):
    """A falling particle ends at m g / lambda, whatever the scheme."""
    lmp = lab.load(
        lab.particles([[0.0, 0, 0]], mass=[2.0]),
        tmp_path,
        [f"fix run all mdanim/leapfrog lambda 0.5 drag {kind}", "fix g all gravity 3.0 vector 0 0 -1", "timestep 0.5", "run 400"],
    )
    # e^-50 of the start is left.
    assert lab.by_tag(lmp, "v")[0] == pytest.approx([0.0, 0.0, -2.0 * 3.0 / 0.5], rel=1e-12)
    lmp.close()


@pytest.mark.parametrize("kind", ["implicit", "exp"])
def test_energy_with_the_loss_is_constant(tmp_path, kind):
    """Kinetic + elastic + scalar: what drag takes is accounted for; drag takes most of it."""
    lmp = lab.load(
        BODY,
        tmp_path,
        [
            f"fix run all mdanim/leapfrog lambda 0.05 drag {kind}",
            "fix_modify run energy yes",
            "timestep 0.05",
            "thermo_style custom step etotal f_run",
            "run 0",
        ],
    )
    start, off = lmp.get_thermo("etotal"), []
    for _ in range(20):
        lmp.command("run 50 pre no post no")
        off.append(lmp.get_thermo("etotal") / start - 1.0)
    assert lmp.extract_fix("run", 0, 0) > 0.5 * start
    # The leap-frog's own energy swings by (w dt)^2 / 4 of the elastic part: w dt = 0.14 for the fastest mode.
    assert np.abs(off).max() < 3e-3
    lmp.close()


def test_without_drag_it_is_velocity_verlet(tmp_path):
    """The same bits as stock fix nve with the same bond style."""
    ours = run(tmp_path, "")[:2]
    lmp = lab.load(BODY, tmp_path, ["fix run all nve", "timestep 0.2", "run 50"])
    # fix nve multiplies by dt/2m in another order of factors: a rounding per step.
    assert np.abs(ours[0] - lab.by_tag(lmp, "x")).max() < 1e-12
    assert np.abs(ours[1] - lab.by_tag(lmp, "v")).max() < 1e-12
    lmp.close()


def test_only_the_group_moves(tmp_path):
    """Particles outside the group keep place and velocity."""
    lmp = lab.load(BODY, tmp_path, ["group some id 1:9", "fix run some mdanim/leapfrog lambda 0.1", "run 20"])
    x = lab.by_tag(lmp, "x")
    assert np.array_equal(x[9:], BODY.x[9:])
    assert np.array_equal(lab.by_tag(lmp, "v")[9:], BODY.v[9:])
    assert np.all(np.abs(x[:9] - BODY.x[:9]).max(1) > 0.0)
    lmp.close()


def test_mass_by_type_and_a_changed_time_step(tmp_path):
    """Without rmass the mass of the type counts; a new time step takes effect between runs."""
    import plugin_path

    lmp = plugin_path.lammps()
    for command in [
        "units lj",
        "atom_style atomic",
        "boundary s s s",
        "region r block -1 1 -1 1 -1 1",
        "create_box 1 r",
        "create_atoms 1 single 0 0 0",
        "mass 1 4.0",
        "velocity all set 1 0 0",
        "pair_style none",
        "comm_modify cutoff 1",
        "fix run all mdanim/leapfrog lambda 2.0",
        "timestep 0.1",
        "run 1",
        "timestep 0.4",
        "run 1",
    ]:
        lmp.command(command)
    phi = [2.0 * dt / 8.0 for dt in (0.1, 0.4)]
    assert lab.by_tag(lmp, "v")[0, 0] == pytest.approx(np.prod([(1 - p) / (1 + p) for p in phi]), rel=1e-14)
    assert lmp.extract_fix("run", 0, 1, 0) == pytest.approx(phi[1], rel=1e-14)
    lmp.close()


def test_restart_keeps_the_energy_account(tmp_path):
    """The loss goes on counting after a restart."""
    import plugin_path

    fix = "fix run all mdanim/leapfrog lambda 0.1"
    lmp = lab.load(BODY, tmp_path, [fix, "timestep 0.1", "run 20", f"write_restart {tmp_path}/r"])
    lost = lmp.extract_fix("run", 0, 0)
    lmp.close()
    other = plugin_path.lammps()
    for command in [
        "atom_modify map array sort 0 0",
        "newton off",
        f"read_restart {tmp_path}/r",
        "fix model all property/atom rmass",
        "pair_style none",
        "comm_modify cutoff 3",
        fix,
        "run 0",
    ]:
        other.command(command)
    assert other.extract_fix("run", 0, 0) == lost > 0.0
    other.close()


def test_warns_when_drag_makes_velocities_change_sign(tmp_path, capfd):
    """phi above 0.5 is reported once, with the number."""
    import plugin_path

    script = tmp_path / "in.drag"
    script.write_text(
        "units lj\natom_style atomic\nboundary s s s\nregion r block -1 1 -1 1 -1 1\ncreate_box 1 r\n"
        "create_atoms 1 single 0 0 0\nmass 1 1.0\npair_style none\ncomm_modify cutoff 1\ntimestep 0.1\n"
        "fix run all mdanim/leapfrog lambda 14 drag ${kind}\nrun 1\n"
    )
    assert "reaches 0.7" in plugin_path.lmp(script, 1, "-var", "kind", "implicit").stdout
    assert "reaches" not in plugin_path.lmp(script, 1, "-var", "kind", "exp").stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("lambda -0.5", "lambda must be >= 0, got -0.5"),
        ("lambda d_nothing", "no per-particle property d_nothing"),
        ("lambda", "lambda"),
        ("lambda 0.1 drag paper", "drag must be implicit or exp, got paper"),
        ("drag exp", "there is no lambda"),
        ("gamma 0.1", "unknown keyword gamma"),
    ],
)
def test_mistakes_are_refused_with_the_word(tmp_path, words, message):
    """Give one wrong word."""
    with pytest.raises(Exception, match=re.escape(message)) as caught:
        lab.load(BODY, tmp_path, [f"fix run all mdanim/leapfrog {words}"]).close()
    assert words.split()[-1] in str(caught.value)


def test_respa_is_refused(tmp_path):
    """run_style respa is not supported, and the message says what is."""
    with pytest.raises(Exception, match="use run_style verlet"):
        lab.load(BODY, tmp_path, ["fix run all mdanim/leapfrog", "run_style respa 2 2", "run 1"])


def test_negative_property_is_refused_with_the_particle(tmp_path):
    """A negative lambda of one particle is found before the run."""
    drag = DRAG.copy()
    drag[6] = -1.0
    with pytest.raises(Exception, match="d_drag = -1 of particle 7"):
        run(tmp_path, "lambda d_drag", columns={"drag": drag})
