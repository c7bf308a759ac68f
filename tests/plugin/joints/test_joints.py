# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/joint: forces against a twin in Python, what is conserved, patches, what it refuses."""

import re
from dataclasses import replace

import joint_lab as lab
import numpy as np
import plugin_lab
import pytest
import rigid_lab
from twin import joint as twin

KINDS = {
    "ball": "at 0.5 0.02 0.03",
    "hinge": "at 0.5 0.02 0.03 axis 1 2 3",
    "weld": "at 0.5 0.02 0.03",
    "slider": "at 0.5 0.02 0.03 axis 1 2 3",
    "spring": "from 0.3 0.1 0.1 to 0.7 -0.1 0.1 length 0.3",
}
DRIVEN = {
    "hinge": "motor 1.0 0.2 friction 0.05 limits -0.1 0.1",
    "slider": "motor 0.3 1.0 friction 0.1 limits -0.02 0.02",
    "spring": "pulls-only",
}
MASS, FREQUENCY = 27.0, 300.0


def bodies(soft, seed=3):
    """Two bodies side by side at random velocities, those in ``soft`` elastic."""
    random, found = np.random.default_rng(seed), []
    for n, off in ((1, 0.0), (2, 1.0)):
        v, spin = 0.2 * random.normal(size=3), random.normal(size=3)
        if n in soft:
            body = lab.elastic((3, 3, 3), 0.1, 1000.0, 1e5, (-0.15 + off, -0.15, -0.15))
            found.append(replace(body, v=v + np.cross(spin, body.x - [off, 0, 0]) + 0.05 * random.normal(size=body.x.shape)))
        else:
            found.append(lab.box((0.6, 0.4, 0.3), MASS, (off, 0, 0), v=v, spin=spin))
    return found


def world(folder, kind, soft, words="", step=0.3, **more):
    """Both with a joint of this kind."""
    patch = "patch " + " ".join("0.9" if n in soft else "all" for n in (1, 2))
    held = "stiffness 2e4" if kind == "spring" else f"frequency {FREQUENCY}"
    joint = f"{kind} 1 2 {KINDS[kind]} {patch} {held} {words}"
    more = {"gravity": (0, 0, 0), "elastic": soft} | more
    return lab.World(folder, bodies(soft), [joint], step / FREQUENCY, **more)


@pytest.mark.parametrize("words", ["", "damping 5"])
@pytest.mark.parametrize("soft", [(), (1,), (1, 2)], ids=["rigid", "both", "elastic"])
@pytest.mark.parametrize("kind", KINDS)
def test_momentum_and_angular_momentum_stay(tmp_path, kind, soft, words):
    """To rounding, with motors, friction, stops and dashpots."""
    with world(tmp_path, kind, soft, f"{words} {DRIVEN.get(kind, '')}") as joined:
        start = joined.momenta()
        joined.run(1000)
        assert joined.momenta() == pytest.approx(start, abs=3e-15 * 1000**0.5 * MASS)
        assert joined.told("gap") < 0.02 or kind == "spring"


@pytest.mark.parametrize("soft", [(), (1,)], ids=["rigid", "both"])
@pytest.mark.parametrize("kind", KINDS)
def test_energy_with_heat_and_work_is_of_second_order(tmp_path, kind, soft):
    """A third of the step leaves a ninth of the error, which begins with the blow of two bodies that move apart."""
    errors = []
    for step in (0.15, 0.05):
        with world(tmp_path, kind, soft, f"damping 5 {DRIVEN.get(kind, '')}", step) as joined:
            start, found = joined.energy(), []
            for _ in range(20):
                joined.run(round(0.01 / joined.dt))
                found.append(abs(joined.energy() / start - 1.0))
        errors.append(max(found))
    assert errors[0] < 3e-3 and errors[1] < errors[0] / 5.0


@pytest.mark.parametrize("soft", [(), (1,), (1, 2)], ids=["rigid", "both", "elastic"])
@pytest.mark.parametrize("kind", KINDS)
def test_forces_are_those_of_the_twin(tmp_path, kind, soft):
    """With dashpots, after a run that has turned and bent the bodies."""
    with world(tmp_path, kind, soft, "damping 5") as joined:
        start = joined.body.x
        joined.run(400)
        joined.lmp.command("run 0")
        x, v, f = (joined.array(name) for name in "xvf")
        told = joined.rows()[0]
        joined.lmp.command("unfix j")
        joined.lmp.command("run 0")
        f = f - joined.array("f")
    of = joined.body.molecule
    ends = [
        np.flatnonzero((of == n) & (np.linalg.norm(start - place(kind, n), axis=1) <= 0.9 if n in soft else True)) for n in (1, 2)
    ]
    patches = [twin.Patch(joined.body.mass[end], start[end]) for end in ends]
    expected, row = twin.forces(
        kind, KINDS[kind], patches, [x[end] for end in ends], [v[end] for end in ends], FREQUENCY, 2e4, 5.0
    )
    scale = np.abs(f).max()
    assert scale > 0.1
    for end, force in zip(ends, expected):
        assert f[end] == pytest.approx(force, abs=1e-9 * scale)
    for column, value in row.items():
        assert told[lab.COLUMNS.index(column)] == pytest.approx(value, rel=1e-6, abs=1e-9), column


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "spring"])
def test_rates_are_those_of_the_page(tmp_path, kind):
    """Loose particles that a joint alone connects stay together at a step just below 2/sqrt(rate), and fly apart just above; the
    rate is that of the twin, below the sums that the page gives for particles, and from frequency^2 to twice that."""
    loose = [replace(body, v=1e-6 * np.random.default_rng(n).normal(size=body.v.shape)) for n, body in enumerate(bodies(()))]
    patches = [twin.Patch(body.mass, body.x) for body in loose]
    added, largest = twin.rates(kind, KINDS[kind], patches, FREQUENCY)
    assert 0.999 * FREQUENCY**2 < largest < 2.001 * FREQUENCY**2
    assert largest < 1.001 * max(rate.max() for rate in added)
    for share in (0.98, 1.02):
        words = f"{kind} 1 2 {KINDS[kind]} frequency {FREQUENCY}"
        with lab.World(tmp_path, loose, [words], share * 2.0 / np.sqrt(largest), gravity=(0, 0, 0), elastic=(1, 2)) as joined:
            joined.run(45)  # a swing grows by exp(0.4) a step
            moved = np.abs(joined.array("x") - joined.body.x).max()
        assert moved < 1e-6 if share < 1.0 else moved > 1e-4


def place(kind, n):
    """Where a joint holds on to a body."""
    numbers = np.array(re.findall(r"-?[\d.]+", KINDS[kind])[:6] + ["0"] * 3, float)
    return numbers[3:6] if kind == "spring" and n == 2 else numbers[:3]


def test_the_place_need_not_be_at_a_particle(tmp_path):
    """A held body, in no group, is read; a load F at a ball opens a gap F/K."""
    block, base = lab.box((0.2, 0.2, 0.2), 2.0, (0.15, 0, 0)), lab.box((0.2, 0.2, 0.2), 1.0, (-0.15, 0, 0))
    with lab.World(tmp_path, [block, base], ["weld 1 2 at 0.01 0.02 0.03 stiffness 1e5 damping 100"], 1e-4, held=(2,)) as joined:
        joined.run(10000)
        assert joined.told("force") == pytest.approx(2.0 * 9.81, rel=1e-6)
        assert joined.told("gap") == pytest.approx(2.0 * 9.81 / 1e5, rel=1e-6)
        assert joined.told("torque") == pytest.approx(2.0 * 9.81 * np.hypot(0.14, 0.02), rel=1e-3)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_patches_may_be_flat(tmp_path, n):
    """A particle, a line of two and a plane of three on a ball; they hang below it."""
    x = np.array([[0, 0, -0.1], [0, 0, -0.3], [0.1, 0, -0.3]])[:n]
    loose = plugin_lab.particles(x, np.ones(n, int), mass=np.full(n, 1.0))
    loose = replace(loose, bond=np.array([[0, 1], [0, 2], [1, 2]])[: n * (n - 1) // 2], k=np.full(n * (n - 1) // 2, 1e4))
    loose = replace(loose, r0=np.linalg.norm(x[loose.bond[:, 0]] - x[loose.bond[:, 1]], axis=1))
    with lab.World(
        tmp_path, [loose], ["ball 1 world at 0 0 -0.1 stiffness 1e4"], 1e-3, elastic=(1,), gravity=(0, 0, -1.0)
    ) as hung:
        start = hung.energy()
        hung.run(3000)
        assert hung.told("gap") < 3.0 * n / 1e4 and hung.energy() == pytest.approx(start, abs=1e-3)


@pytest.mark.parametrize("kind", ["hinge", "slider"])
@pytest.mark.parametrize("damped", [True, False])
def test_stops_do_not_pump_energy_into_what_shakes(tmp_path, kind, damped):
    """A weight leans on a stop at the end of an elastic arm. Forces along the free coordinate are derivatives of an energy, and
    their dashpots dissipate: a torque on the rotation of a patch alone, by an angle that sees its shear as well, would not."""
    h, frequency = 0.05, 1000.0
    arm = lab.elastic((3, 2, 2), h, 1000.0, 2e5, (0.0, -h, -h))
    weight = lab.box((0.2, 0.1, 0.1), 5.0, (0.35, 0.03, 0.02))
    words = "axis 0 1 0 limits -0.01 0.01" if kind == "hinge" else "axis 0.5 0 1 limits -0.001 0.001"
    servo = "" if damped else "servo 50 0" if kind == "hinge" else "servo 2e4 0"
    joints = [f"weld 1 world at 0 0 0 frequency {frequency}", f"{kind} 2 1 at 0.2 0 0 {words} frequency {frequency} {servo}"]
    with lab.World(tmp_path, [arm, weight], joints, 0.2 / frequency, elastic=(1,)) as leaning:
        start, heat = leaning.energy(), 0.0
        for _ in range(10):
            leaning.run(300)
            assert leaning.energy() == pytest.approx(start, abs=1e-3)
            told = leaning.number("joint_heat")
            assert told >= heat - 1e-5 if damped else abs(told) < 1e-5
            heat = told


@pytest.mark.parametrize("mass", [0.1, 0.3, 1.0, 7.0])
def test_a_patch_of_one_particle_is_where_the_particle_is(tmp_path, mass):
    """Its centre is off by rounding, which must not count as an extent of the patch."""
    for n in range(20):
        x = np.random.default_rng(n).uniform(-2, 2, (1, 3))
        one = plugin_lab.particles(x, np.ones(1, int), mass=np.array([mass]))
        place_of = " ".join(repr(float(c)) for c in x[0])
        with lab.World(
            tmp_path, [one], [f"ball 1 world at {place_of} stiffness 1"], 1e-3, elastic=(1,), gravity=(0, 0, 0)
        ) as alone:
            assert alone.told("gap") < 1e-15


REFUSED = [
    ("joint rope 1 2", "joint 1: there is no joint rope; kinds are weld, ball, hinge, slider and spring"),
    ("joint ball 1 1 at 0 0 0 stiffness 1", "joint 1: a joint is between two objects, got one twice"),
    ("joint ball 1 2 stiffness 1", "joint 1: a ball needs 'at x y z'"),
    ("joint hinge 1 2 at 0 0 0 stiffness 1", "a hinge needs 'axis x y z'"),
    ("joint hinge 1 2 at 0 0 0 axis 0 0 0 stiffness 1", "the axis has no direction"),
    ("joint ball 1 2 at 0 0 0", "give one of 'stiffness K' and 'frequency OMEGA', got none"),
    ("joint ball 1 2 at 0 0 0 stiffness 1 frequency 2", "give one of 'stiffness K' and 'frequency OMEGA', got both"),
    ("joint weld 1 2 at 0 0 0 stiffness 1 motor 1 none", "a weld has no word motor; it has at patch stiffness frequency arm"),
    ("joint ball 1 2 at 0 0 0 at 0 0 0 stiffness 1", "at is given twice"),
    ("joint ball 1 2 at 0 0 here stiffness 1", "here is not a number; it stands for the place of the joint"),
    ("joint ball 1 2 at 0 0 0 stiffness -1", "the stiffness must be above 0"),
    ("joint hinge 1 2 at 0 0 0 axis 1 0 0 stiffness 1 limits 1 2", "limits are from the start"),
    ("joint ball 1 7 at 0 0 0 stiffness 1", "there is no object 7 (molecule ID)"),
    (
        "joint ball 1 2 at 0 0 0 patch 0.01 all stiffness 1",
        "joint 1 (ball 1 2): object 1 has no particle within 0.01 of its place",
    ),
    ("joint ball 1 2 at 0 0 0 stiffness 1 joint", "joint 2: the kind of the joint is missing"),
    ("weld 1 2", "unknown keyword weld; it knows joint and joints"),
    ("joints", "it is written as 'joints FILE'"),
    ("joints nothing.here", "cannot read the joints in nothing.here"),
    ("", "it is written as 'fix ID group mdanim/joint joint KIND A B words'"),
]


@pytest.mark.parametrize(("words", "message"), REFUSED)
def test_refusals_say_how(tmp_path, words, message):
    """Mistakes in words stop the command, what the particles do not have the run."""
    two = plugin_lab.join(*bodies(()))
    with pytest.raises(Exception, match=re.escape(message)):
        plugin_lab.load(two, tmp_path, ["fix r all mdanim/rigid", f"fix j all mdanim/joint {words}", "run 0"])


@pytest.mark.parametrize(
    ("x", "words", "message"),
    [
        ([[0, 0, 0], [0, 0, 1]], "ball 1 world at 0.1 0 0", "stand in a line, and its place is off by 0.1"),
        ([[0, 0, 0], [0, 0, 1]], "hinge 1 world at 0 0 0 axis 1 0 0", "have no axis to turn about"),
        ([[0, 0, 0]], "weld 1 world at 0 0 0", "have no direction that both bodies have"),
        ([[0, 0, 0], [0, 0, 1], [0, 1, 0]], "ball 1 world at 0.2 0 0", "stand in a plane, and its place is off by 0.2"),
        ([[0, 0, 0], [0, 0, 1]], "ball 1 world at 0 0 0 preload 1 0 0 0 0 0", "a preload needs particles that stand neither"),
    ],
)
def test_patches_without_place_or_axis_are_refused(tmp_path, x, words, message):
    """They tell what the particles lack."""
    loose = plugin_lab.particles(x, np.ones(len(x), int))
    commands = ["fix l all mdanim/leapfrog", f"fix j all mdanim/joint joint {words} stiffness 1", "run 0"]
    with pytest.raises(Exception, match=re.escape(message)):
        plugin_lab.load(loose, tmp_path, commands)


def test_a_joint_without_particles_in_the_group_is_refused(tmp_path):
    """It would do nothing."""
    two = plugin_lab.join(*bodies(()))
    commands = [
        "group one molecule 1",
        "fix r one mdanim/rigid",
        "fix j one mdanim/joint joint ball 2 world at 1 0 0 stiffness 1",
    ]
    with pytest.raises(Exception, match="none of the particles that it holds on to is in the group of the fix"):
        plugin_lab.load(two, tmp_path, [*commands, "run 0"])


def test_a_file_has_a_joint_a_line(tmp_path):
    """The same joints by words and by a file, and a mistake in it with its line."""
    three = [lab.box((0.2, 0.2, 0.2), 1.0, (0.3 * n, 0, 0)) for n in range(3)]
    rows = [f"ball {n + 1} {n + 2} at {0.3 * n + 0.15} 0 0 frequency 500" for n in range(2)]
    (tmp_path / "joints").write_text(f"# two\n{rows[0]}\n\n{rows[1]}  # the last\n")
    ends = []
    for words in (" ".join(f"joint {row}" for row in rows), f"joints {tmp_path}/joints"):
        lmp = plugin_lab.load(
            plugin_lab.join(*three),
            tmp_path,
            [
                "fix r all mdanim/rigid",
                "fix g all mdanim/gravity 1 0 -9",
                f"fix j all mdanim/joint {words}",
                "timestep 1e-3",
                "run 50",
            ],
        )
        ends.append(plugin_lab.by_tag(lmp, "x"))
        lmp.close()
    assert np.array_equal(*ends)
    (tmp_path / "joints").write_text("ball 1 2 at 0 0 0 stiffness 1\nball 1 2 at 0 0 stiffness 1\n")
    with pytest.raises(Exception, match=re.escape(f"line 2 of {tmp_path}/joints: stiffness is not a number")):
        plugin_lab.load(plugin_lab.join(*three), tmp_path, [f"fix j all mdanim/joint joints {tmp_path}/joints"])


def test_a_free_axis_is_right_handed(tmp_path):
    """A wheel that turns by +1/s about the axis of its hinge to the world, whichever body is named first."""
    wheel = lab.box((0.3, 0.3, 0.1), spin=(0, 0, 1.0))
    base = lab.box((0.1, 0.1, 0.1), at=(0, 0, -0.2))
    for joint, held, sign in (("1 world", (), 1.0), ("1 2", (2,), 1.0), ("2 1", (2,), -1.0)):
        bodies_of = [wheel, base] if held else [wheel]
        words = f"hinge {joint} at 0 0 0 axis 0 0 2 frequency 1000"
        with lab.World(tmp_path, bodies_of, [words], 3e-4, gravity=(0, 0, 0), held=held) as world_of:
            world_of.run(round(7.0 / 3e-4))
            assert world_of.told("way") == pytest.approx(sign * 7.0, abs=1e-3)  # more than a turn
            assert world_of.told("rate") == pytest.approx(sign, abs=1e-4)


def test_rigid_lab_turns_as_the_fix():
    """The rotation of the lab is right-handed."""
    assert rigid_lab.matrix(rigid_lab.about((0, 0, 1), np.pi / 2)) @ [1, 0, 0] == pytest.approx([0, 1, 0])
