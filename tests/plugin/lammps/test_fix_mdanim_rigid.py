# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/rigid: free bodies against closed forms, bodies under forces, bits, state, what it refuses."""

import re
from dataclasses import replace

import numpy as np
import plugin_lab as lab
import pytest
import rigid_lab
import rigid_motions
import state_lab
from mdanim_lammps.run.folder import open_run
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from rigid_motions import with_moments
from scipy.integrate import solve_ivp


def body(lmp, n=0):
    """Centre, velocity, rotation and angular velocity of a body."""
    row = np.array([lmp.extract_fix("r", 0, 2, n, column) for column in range(13)])
    return row[:3], row[3:6], rigid_lab.matrix(row[6:10]), row[10:]


def momenta(particles, x, v):
    """Momentum and angular momentum about the origin."""
    p = particles.mass[:, None] * v
    return np.r_[p.sum(0), np.cross(x, p).sum(0)]


@pytest.mark.parametrize(("steps_of_a_turn", "energy"), [(60, 1e-4), (600, 1e-6)])
def test_a_free_body_keeps_its_energy_and_angular_momentum(tmp_path, steps_of_a_turn, energy):
    """Spinning about its middle axis, for 300 turns. The error of energy is of second order in the time step and does not grow;
    that of angular momentum is rounding, some 1e-16 a step of the places alone."""
    moving = with_moments((1.0, 2.0, 3.0), (1e-3, 1.0, 1e-3))
    lmp = lab.load(moving, tmp_path, ["fix r all mdanim/rigid", f"timestep {2.0 * np.pi / steps_of_a_turn}", "run 0"])
    start = momenta(moving, moving.x, moving.v)
    errors = []
    for _ in range(60):
        lmp.command(f"run {5 * steps_of_a_turn} pre no post no")
        errors.append(lmp.extract_fix("r", 0, 1, 2) / (0.5 * (moving.mass * (moving.v**2).sum(1)).sum()) - 1.0)
        assert momenta(moving, lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v")) == pytest.approx(start, abs=1e-13)
    assert np.abs(errors).max() < energy
    assert np.abs(errors[30:]).max() < 1.2 * np.abs(errors[:30]).max()
    apart = np.linalg.norm(lab.by_tag(lmp, "x")[:, None] - lab.by_tag(lmp, "x"), axis=2)
    assert apart == pytest.approx(np.linalg.norm(moving.x[:, None] - moving.x, axis=2), abs=1e-14)
    lmp.close()


@pytest.mark.parametrize("spin", [(0.05, 1.0, 0.05), (0.05, 1.0, 0.5)])
def test_flips_of_the_middle_axis_take_the_elliptic_period(tmp_path, spin):
    """300 steps a turn: the splitting is of second order, here 2e-5. Linear between two looks: 8 dt of an arc, 1e-4 of the period
    at most; of two crossings alike, less."""
    found, period = rigid_motions.flips(tmp_path, spin)
    assert found == pytest.approx(period, rel=1e-4)


@pytest.mark.parametrize("moments", [(2.0, 2.0, 3.0), (1.0, 3.0, 3.0), (2.0, 2.0, 2.0)])
def test_a_body_of_revolution_precesses_as_in_closed_form(tmp_path, moments):
    """It turns about L at L/I and about its own axis at the difference of the spins, to the series of the tangent."""
    spin = np.array([0.3, 0.7, 1.1])
    moving = with_moments(moments, spin)
    L = np.asarray(moments) * spin
    axis = {(2.0, 2.0, 3.0): 2, (1.0, 3.0, 3.0): 0, (2.0, 2.0, 2.0): 0}[moments]
    across = moments[(axis + 1) % 3]
    dt, steps = 0.05, 400
    lmp = lab.load(moving, tmp_path, ["fix r all mdanim/rigid", f"timestep {dt}", f"run {steps}"])

    def turned(about, angle):
        u = about / np.linalg.norm(about)
        cross = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
        return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross

    time = dt * steps
    own = turned(np.eye(3)[axis], time * L[axis] * (1.0 / moments[axis] - 1.0 / across))
    expected = moving.x @ (turned(L, time * np.linalg.norm(L) / across) @ own).T
    assert lab.by_tag(lmp, "x") == pytest.approx(expected, abs=1e-9)
    lmp.close()


PULL = (0.3, -0.2, 0.5)


def pulled(time, moving, rtol=1e-12):
    """Places after a time while a constant force acts on particle 1: Newton and Euler by a method of high order."""
    mass, centre = moving.mass.sum(), (moving.mass[:, None] * moving.x).sum(0) / moving.mass.sum()
    arms = moving.x - centre
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(moving.mass, arms))

    def rates(_, state):
        axes, momentum = state[6:15].reshape(3, 3), state[15:]
        spin = axes @ np.linalg.solve(inertia, axes.T @ momentum)
        return np.r_[state[3:6], np.asarray(PULL) / mass, np.cross(spin, axes.T).T.ravel(), np.cross(axes @ arms[0], PULL)]

    velocity = (moving.mass[:, None] * moving.v).sum(0) / mass
    angular = np.cross(arms, moving.mass[:, None] * moving.v).sum(0)
    start = np.r_[centre, velocity, np.eye(3).ravel(), angular]
    end = solve_ivp(rates, (0.0, time), start, method="DOP853", rtol=rtol, atol=rtol).y[:, -1]
    return end[:3] + arms @ end[6:15].reshape(3, 3).T


def test_a_pulled_body_follows_newton_and_euler(tmp_path):
    """A body that is not symmetric; the error is of second order in the time step."""
    at = np.array([[0.0, 0, 0], [1, 0, 0.2], [0, 2, 0], [0.3, 0.1, 3], [-1, 1, 0]])
    moving = lab.particles(at, np.ones(5, int), v=np.cross((0.2, 0.5, -0.1), at) + (0.1, 0, 0), mass=[1.0, 2, 1, 0.5, 1])
    expected, errors = pulled(8.0, moving), []
    for dt in (0.04, 0.02):
        commands = [
            "group one id 1",
            f"fix p one addforce {PULL[0]} {PULL[1]} {PULL[2]}",
            "fix r all mdanim/rigid",
            f"timestep {dt}",
        ]
        lmp = lab.load(moving, tmp_path, [*commands, f"run {round(8.0 / dt)}"])
        errors.append(np.abs(lab.by_tag(lmp, "x") - expected).max())
        lmp.close()
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_the_order_of_fixes_does_not_matter(tmp_path):
    """Forces of a fix that comes later are in the first step."""
    moving = with_moments((1.0, 2.0, 3.0), (0.3, 1.0, 0.2))
    ends = []
    for commands in (
        ["fix r all mdanim/rigid", "fix g all mdanim/gravity 0 0 -1"],
        ["fix g all mdanim/gravity 0 0 -1", "fix r all mdanim/rigid"],
    ):
        lmp = lab.load(moving, tmp_path, [*commands, "timestep 0.01", "run 100"])
        ends.append(lab.by_tag(lmp, "x"))
        lmp.close()
    assert np.array_equal(*ends)
    assert ends[0].mean(0) == pytest.approx([0.0, 0.0, -0.5], abs=1e-13)


TWO = lab.join(
    lab.shaken(lab.block((2, 3, 1)), 0.02),
    lab.block((2, 2, 2), (0.5, 0.3, 3.2), (0.1, 0.0, -0.5)),
    lab.block((1, 1, 2), (4.0, 0.0, 0.0)),
)
"""A tilted slab, a cube that falls on it, and a body that stays elastic."""
FORCES = [
    "group stiff molecule 1 2",
    "group soft molecule 3",
    "fix floor all mdanim/wall below 40",
    "fix touch boundary mdanim/barrier boundary boundary 30 0.9",
    "fix down all mdanim/gravity 0 0 -0.3",
    "fix r stiff mdanim/rigid",
    "fix run soft mdanim/leapfrog",
    f"timestep {0.2 * lab.BOUND}",
]
BELOW = "region below block INF INF INF INF -0.4 INF"


def test_bits_do_not_depend_on_ranks_or_order(tmp_path):
    """Sums over the particles of a body are the same for any distribution of them."""
    commands = [BELOW, *FORCES, "run 80"]
    mixed = np.random.default_rng(3).permutation(len(TWO.x))
    forms = ({}, {"order": mixed}, {"ranks": 2}, {"ranks": 3})
    ends = [lab.in_child(TWO, tmp_path, commands, **form) for form in forms]
    assert len(set(ends)) == 1


def test_bodies_move_and_keep_momentum(tmp_path):
    """Two bodies joined by springs, one of them elastic: momenta stay to rounding of 4000 steps, energy to second order."""
    stiff, soft = lab.block((2, 2, 2)), lab.block((2, 2, 2), (0.0, 0.0, 3.0), (0.2, 0.1, 0.0))
    both = lab.join(stiff, soft)
    bond = np.concatenate([both.bond, [[18, 27], [26, 35]]])
    joined = replace(both, bond=bond, k=np.r_[both.k, 0.3, 0.2], r0=np.r_[both.r0, 0.8, 0.9])
    lmp = lab.load(
        joined,
        tmp_path,
        [
            "group stiff molecule 1",
            "group soft molecule 2",
            "fix r stiff mdanim/rigid",
            "fix run soft mdanim/leapfrog",
            "thermo_style custom step etotal",
            f"timestep {0.05 * lab.BOUND}",
            "run 0",
        ],
    )
    start, energy = momenta(joined, joined.x, joined.v), lmp.get_thermo("etotal")
    for _ in range(4):
        lmp.command("run 1000 pre no post no")
        assert momenta(joined, lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v")) == pytest.approx(start, abs=1e-11)
        assert lmp.get_thermo("etotal") == pytest.approx(energy, rel=2e-3)
    assert np.abs(body(lmp)[3]).max() > 1e-3
    lmp.close()


def test_a_restart_file_goes_on_to_the_bit(tmp_path):
    """Bodies and the places of particles in them are in the file."""
    commands = [BELOW, *FORCES, "run 60"]
    whole = lab.load(TWO, tmp_path, [*commands, f"write_restart {tmp_path / 'half'}", "run 40"])
    expected = lab.by_tag(whole, "x")
    whole.close()
    again = lab.restarted(tmp_path / "half", TWO, [BELOW, *FORCES[2:], "run 40"])
    assert np.array_equal(lab.by_tag(again, "x"), expected)
    again.close()


def test_a_state_goes_on_to_the_bit_in_another_instance(tmp_path):
    """The records of bodies with places and velocities."""
    first = lab.load(TWO, tmp_path, [BELOW, *FORCES, "run 60"])
    records = state_lab.pack(first, "r")
    assert records.key.tolist() == [[1, 0], [2, 0]]
    other = replace(TWO, x=lab.by_tag(first, "x"), v=lab.by_tag(first, "v"))
    first.command("run 40")
    second = lab.load(other, tmp_path, [BELOW, *FORCES])
    state_lab.put(second, "r", records)
    assert state_lab.pack(second, "r").same(records)
    second.command("run 40")
    assert np.array_equal(lab.by_tag(second, "x"), lab.by_tag(first, "x"))
    for broken, why in [
        (state_lab.Records(records.key + [[4, 0]], records.first, records.data), "is of an object that is not there"),
        (state_lab.Records(records.key, records.first, records.data // 2 + 128), "another version|damaged|cut off"),
    ]:
        with pytest.raises(RuntimeError, match=why):
            state_lab.put(second, "r", broken)
    first.close()
    second.close()


def test_what_is_changed_between_runs_is_followed(tmp_path):
    """Velocities that are set, and particles that are moved."""
    spinning = with_moments((1.0, 2.0, 3.0), (0.3, 1.0, 0.2))
    lmp = lab.load(spinning, tmp_path, ["fix r all mdanim/rigid", "timestep 0.01", "run 100"])
    lmp.command("velocity all set 0 0 2")
    lmp.command("run 0")
    centre, velocity, _, spin = body(lmp)
    assert velocity == pytest.approx([0.0, 0.0, 2.0]) and spin == pytest.approx([0.0, 0.0, 0.0], abs=1e-14)
    lmp.command("displace_atoms all move 5 0 0")
    lmp.command("run 0")
    assert body(lmp)[0] == pytest.approx(centre + [5.0, 0.0, 0.0], abs=1e-13)
    lmp.close()


def test_moments_from_a_file(tmp_path):
    """A dumbbell with the moments of a thick one: it turns at torque over moment, and the energy that its points lack is told."""
    dumbbell = lab.particles([[-1.0, 0, 0], [1, 0, 0]], [1, 1], v=[[0, -1.0, 0], [0, 1, 0]], mass=[2.0, 2.0])
    (tmp_path / "moments").write_text("# thick\n1  3 10 10  0 0 0\n")
    lmp = lab.load(dumbbell, tmp_path, [f"fix r all mdanim/rigid inertia {tmp_path / 'moments'}", "timestep 0.01", "run 0"])
    assert body(lmp)[3] == pytest.approx([0.0, 0.0, 1.0], abs=1e-13)
    assert lmp.extract_fix("r", 0, 1, 2) == pytest.approx(5.0)
    assert lmp.extract_fix("r", 0, 0) == pytest.approx(5.0 - 2.0)
    for command in ["group right id 2", "fix p right addforce 0 0 0.4", "velocity all set 0 0 0", "run 50"]:
        lmp.command(command)
    # Torque 0.4 about -y; the arm has turned by 5e-3, whose cosine is within 2e-5 of 1.
    assert body(lmp)[3] == pytest.approx([0.0, -0.4 / 10.0 * 0.5, 0.0], rel=2e-5, abs=1e-13)
    lmp.close()


STONE = """
gravity (0, 0, -9.81)
ground z 0
object soft { shape box (20, 20, 20) cm  position (0, 0, 10) cm  density 1000  elasticity 0.1 MPa }
object stone {
  shape box (10, 10, 10) cm  position (2, 0, 32) cm  orientation euler (20, 30, 0) deg  density 2000  elasticity 0.1 MPa
}
control { time 0.4 s  resolution 5 cm  contact-damping 0 }
"""


def test_an_object_of_a_scene_is_made_rigid(tmp_path):
    """The script that `build` writes, with the stone as a body. It falls with one corner ahead on the elastic cube and comes
    back. The error of energy is of second order in the time step; with both of them elastic it is 9e-4 at this step."""
    with open_run(prepare(parse_scene(STONE, "fall")), tmp_path / "out", force=False, draws=None) as folder:
        script = (folder / "in.fall").read_text()
        elastic = "fix leapfrog mobile mdanim/leapfrog"
        assert elastic in script
        apart = ["group stone molecule 2", "group soft subtract mobile stone"]
        rigid = [*apart, "fix leapfrog soft mdanim/leapfrog", "fix stone stone mdanim/rigid"]
        (folder / "in.rigid").write_text(script.replace(elastic, "\n".join(rigid)))
        done = lab.plugin_path.lmp(folder / "in.rigid", 1)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = [line.split() for line in done.stdout.splitlines()]
    rows = np.array([line for line in lines if len(line) == 9 and line[0].isdigit()], float)
    total = rows[:, 2] + rows[:, 3] + rows[:, 5:].sum(1)  # kinetic, springs, gravity, contact, barrier, ground
    assert rows[:, 6].max() > 0.2  # J in the contact
    assert np.ptp(total) < 1.5e-3 * rows[:, 2].max()


def test_bodies_take_degrees_of_freedom(tmp_path):
    """A compute temp counts six of each body."""
    lmp = lab.load(TWO, tmp_path, ["group stiff molecule 1 2", "fix r stiff mdanim/rigid", "compute t stiff temp", "run 0"])
    moving = TWO.molecule < 3
    kinetic = 0.5 * (TWO.mass * (lab.by_tag(lmp, "v") ** 2).sum(1))[moving].sum()
    assert lmp.extract_compute("t", 0, 0) == pytest.approx(2.0 * kinetic / (12 - 3))
    lmp.close()


@pytest.mark.parametrize(
    ("commands", "why"),
    [
        (["group some id 1 2 3", "fix r some mdanim/rigid"], "3 of the 27 particles of object 1 (molecule ID) are in its group"),
        (["set atom 4 mol 0", "fix r all mdanim/rigid"], "particle 4 belongs to no object"),
        (["set atom 4 mol 2", "fix r all mdanim/rigid"], "the particles of object 2 (molecule ID) stand on a line"),
        (["fix r all mdanim/rigid moments"], "unknown keyword moments; it knows inertia"),
        (["fix r all mdanim/rigid inertia"], "it is written as 'inertia FILE'"),
        (["fix r all mdanim/rigid inertia nowhere"], "cannot read the moments of inertia in nowhere"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, commands, why):
    """With the object, and a way out."""
    with pytest.raises(Exception, match=re.escape(why)):
        lab.load(lab.block((2, 2, 2)), tmp_path, [*commands, "run 0"]).close()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1 1 1", "line 1 of"),
        ("\n1 1 1 one 0 0 0", "line 2 of {}: one is not a number"),
        ("1 1 1 5 0 0 0", "no body has the principal moments 1, 1 and 5"),
        ("1 1 1 1 0 0 2", "no body has the principal moments -1, 1 and 3"),
        ("1.5 1 1 1 0 0 0", "1.5 is not a molecule ID"),
        ("1 1 1 1 0 0 0\n1 1 1 1 0 0 0", "line 2 of {}: object 1 has a line already"),
        ("7 1 1 1 0 0 0", "there are moments of inertia for object 7 (molecule ID), which has no particle in its group"),
    ],
)
def test_a_file_of_moments_that_is_wrong(tmp_path, text, why):
    """With the line, and what is wrong in it."""
    path = tmp_path / "moments"
    path.write_text(text)
    with pytest.raises(Exception, match=re.escape(why.replace("{}", str(path)))):
        lab.load(lab.block((2, 2, 2)), tmp_path, [f"fix r all mdanim/rigid inertia {path}", "run 0"]).close()
