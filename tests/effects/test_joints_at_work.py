# SPDX-License-Identifier: GPL-2.0-only
"""Joints of scenes against closed forms, at the defaults of the language."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.joints.rows import BROKEN, FORCE, GAP, NUMBER, RATE, WAY
from mdanim_lammps.run.energy import energies, tell
from scipy.special import ellipk

G = 9.81
ROD = """gravity (0, 0, -9.81) m/s^2
let a = {angle} deg
let l = {length} m
object rod {{
  shape box ({wide}*l, {wide}*l, l)
  position (0.5*l*sin(a), 0, 10 m - 0.5*l*cos(a))
  orientation axis (0, 1, 0) angle -a
  density {density} kg/m^3
  elasticity {elasticity}
}}
joint hinge rod world {{ at (0, 0, 10) m axis (0, 1, 0) }}
control {{ time 20 s {more} }}
"""
FREE = "object {name} {{ shape {shape} position {at} m density 1000 elasticity rigid }}\n"


class Watched:
    """Joints of a scene at work: times [s], rows of all joints, shape (F, J, ...), and all energy that is lost [J]."""

    def __init__(self, ready, seconds, looks=50):
        dt = ready.certificate.timestep
        steps = max(1, round(seconds / dt / looks))
        self.time, rows, self.sums = [], [], []
        self.place, self.energies = [], []
        with Instance(ready.plan) as instance:
            instance.setup()
            for _ in range(looks + 1):
                told = tell(instance)["joint"]["value"]
                rows.append(told[np.argsort(told[:, NUMBER])])
                self.time.append(instance.step * dt)
                middle = ready.system.center_of_mass(instance.array("x"))
                self.place.append(middle)
                self.energies.append(energies(instance, middle))
                instance.run(steps)
        self.rows, self.time, self.place = np.array(rows), np.array(self.time), np.array(self.place)

    def column(self, which, joint=0):
        return self.rows[:, joint, which]

    def residual(self, sources=("work",)) -> float:
        """Largest change of all energies together, over the largest change of any."""
        total = [sum(v if k not in sources else -v for k, v in e.items()) for e in self.energies]
        swing = max(np.ptp([e[k] for e in self.energies]) for k in self.energies[0])
        return float(np.ptp(total) / swing)


def period(time, angle) -> float:
    """From the first to the last passage through 0 in one direction, between samples by straight lines."""
    crossings = [k for k in range(1, len(time)) if angle[k - 1] < 0.0 <= angle[k]]
    at = [time[k - 1] - angle[k - 1] * (time[k] - time[k - 1]) / (angle[k] - angle[k - 1]) for k in crossings]
    return (at[-1] - at[0]) / (len(at) - 1)


def period_of_rod(length, wide, angle) -> float:
    """Period of a rod on a hinge at its end: 4 K(sin(a/2)) sqrt(I/(m g l/2))."""
    arm = length / 2.0
    inertia = length**2 * (1.0 + wide**2) / 12.0 + arm**2
    return 4.0 * ellipk(np.sin(np.radians(angle) / 2.0) ** 2) * np.sqrt(inertia / (G * arm))


@pytest.mark.parametrize(
    ("angle", "length", "wide", "density"),
    [(5, 1.0, 0.04, 700), (120, 1.0, 0.04, 700), (5, 0.05, 0.1, 7800), (120, 6.0, 0.02, 2500)],
)
def test_a_rigid_rod_swings_with_its_period(prepared, angle, length, wide, density):
    """From 5 and 120 degrees, of four sizes and two materials: 0.5 % was asked for; a hinge that opens by a hair leaves 1e-4."""
    wanted = period_of_rod(length, wide, angle)
    ready = prepared(ROD.format(angle=angle, length=length, wide=wide, density=density, elasticity="rigid", more=""))
    watched = Watched(ready, 3.3 * wanted, 400)
    assert period(watched.time, watched.column(WAY) - np.radians(angle)) == pytest.approx(wanted, rel=1e-3)
    assert watched.residual() < 3e-4
    assert watched.column(GAP).max() < 0.005 * wide * length


@pytest.mark.parametrize("angle", [5, 120])
def test_an_elastic_rod_swings_with_its_period(prepared, angle):
    """Held at particles in a spacing around the hinge; the rod stretches and bends a little."""
    wanted = period_of_rod(0.5, 0.1, angle)
    text = ROD.format(angle=angle, length=0.5, wide=0.1, density=1000, elasticity="5 MPa", more="accuracy preview")
    watched = Watched(prepared(text), 2.2 * wanted, 200)
    assert period(watched.time, watched.column(WAY) - np.radians(angle)) == pytest.approx(wanted, rel=5e-3)
    assert watched.residual() < 1e-2  # of `preview`


def test_a_double_pendulum_keeps_its_energy(prepared):
    """Ten seconds of chaotic motion: what joints take is in their account, 1e-4 of all energy is missing at most."""
    text = """gravity (0, 0, -9.81) m/s^2
let wood = { density 700 kg/m^3 elasticity rigid }
object upper { use wood shape box (50, 4, 4) cm position (25, 0, 200) cm }
object lower { use wood shape box (50, 4, 4) cm position (75, 4.5, 200) cm }
joint hinge upper world { at (0, 0, 2) m axis (0, 1, 0) }
joint hinge lower upper { at (0.5, 0.0225, 2) m axis (0, 1, 0) }
control { time 10 s }
"""
    assert Watched(prepared(text), 10.0, 200).residual() < 1.5e-4


def test_a_hanging_chain_bears_its_weight(prepared):
    """Each joint of twenty links bears what hangs below it, from the first frame on, and nothing moves."""
    text = """gravity (0, 0, -9.81) m/s^2
repeat i in 1 .. 20 {
  object link[i] { shape box (1, 1, 5.4) cm position (0, 0, 2 - 0.06*(i - 0.5)) m density 7800 elasticity rigid }
}
joint ball link[1] world { at (0, 0, 2) m }
repeat i in 1 .. 19 { joint ball link[i] link[i + 1] { at (0, 0, 2 - 0.06*i) m } }
control { time 2 s }
"""
    watched = Watched(prepared(text), 1.0, 20)
    link = 7800 * 1e-4 * 0.054 * G
    below = link * np.arange(20, 0, -1)
    np.testing.assert_allclose(watched.rows[0, :, FORCE], below, rtol=1e-5)
    np.testing.assert_allclose(watched.rows[:, :, FORCE], np.tile(below, (21, 1)), rtol=1e-4)
    assert np.abs(watched.place - watched.place[0]).max() < 1e-6


def test_two_hinges_of_a_door_share_its_weight(prepared):
    """Each bears a half; across, both bear the moment: F = m g (w/2)/h."""
    text = """gravity (0, 0, -9.81) m/s^2
object door { shape box (80, 4, 200) cm position (40, 0, 100) cm density 500 elasticity rigid }
repeat i in 0 .. 1 { joint hinge door world { at (0, 0, 0.2 + 1.6*i) m axis (0, 0, 1) } }
control { time 1 s }
"""
    watched = Watched(prepared(text), 0.2, 10)
    weight = 500 * 0.8 * 0.04 * 2.0 * G
    assert watched.rows[0, 0, FORCE] == pytest.approx(watched.rows[0, 1, FORCE], rel=1e-6)
    # Torque of each hinge about y takes a part of the moment, so the force is at most that of two balls.
    assert 0.5 * weight < watched.rows[0, 0, FORCE] <= np.hypot(0.5 * weight, weight * 0.4 / 1.6) * (1.0 + 1e-9)
    assert np.abs(watched.column(WAY)).max() < 1e-6


def test_a_motor_with_a_limit_runs_a_flywheel_up(prepared):
    """w = M t/I, and once it is there it stays: the work of the motor is what the wheel has."""
    text = """object wheel { shape cylinder 20 cm 5 cm density 7800 position (0, 0, 1) m elasticity rigid }
joint hinge wheel world { axis (0, 0, 1) motor speed 60 rpm torque 2 N*m }
control { time 10 s }
"""
    inertia = 0.5 * 7800 * np.pi * 0.2**2 * 0.05 * 0.2**2
    speed = 2.0 * np.pi
    watched = Watched(prepared(text), 1.5 * speed * inertia / 2.0, 60)
    half = int(np.searchsorted(watched.time, 0.5 * speed * inertia / 2.0))
    assert watched.column(RATE)[half] == pytest.approx(2.0 * watched.time[half] / inertia, rel=2e-3)
    assert watched.column(RATE)[-1] == pytest.approx(speed, rel=1e-3)
    assert watched.residual() < 1e-3


def test_a_spring_and_its_dashpot(prepared):
    """A mass on a spring: its period, and the decay by c/2m."""
    text = f"""{FREE.format(name="mass", shape="sphere 5 cm", at="(0, 0, 0.6)")}
joint spring mass world {{ to (0, 0, 1) m length 30 cm stiffness 80 N/m damping 0.1 N*s/m }}
control {{ time 10 s }}
"""
    mass = 1000 * 4.0 / 3.0 * np.pi * 0.05**3
    watched = Watched(prepared(text), 4.0, 400)
    more = watched.column(WAY) - 0.3
    wanted = 2.0 * np.pi / np.sqrt(80.0 / mass - (0.05 / mass) ** 2)
    assert period(watched.time, more) == pytest.approx(wanted, rel=1e-3)
    peaks = more[1:-1][(more[1:-1] > more[:-2]) & (more[1:-1] > more[2:])]
    assert np.log(peaks[0] / peaks[-1]) == pytest.approx(0.05 / mass * wanted * (len(peaks) - 1), rel=0.02)
    assert watched.residual() < 1e-3


@pytest.mark.parametrize("angle", [10, 40])
def test_a_slider_on_a_slope(prepared, angle):
    """It slides with g sin a - F/m, where friction F holds it no longer, and stops at its limit."""
    text = f"""gravity (0, 0, -9.81) m/s^2
let a = {angle} deg
object block {{ shape box (10, 10, 10) cm position (0, 0, 1) m orientation axis (0, 1, 0) angle a density 1000 elasticity rigid }}
joint slider block world {{ axis (cos(a), 0, -sin(a)) friction 2 N limits -10 cm to 30 cm }}
control {{ time 5 s }}
"""
    slope = G * np.sin(np.radians(angle))
    watched = Watched(prepared(text), 1.0, 100)
    acceleration = max(0.0, slope - 2.0 / 1.0)
    slides = watched.time < np.sqrt(2 * 0.28 / max(acceleration, 1e-9))
    np.testing.assert_allclose(watched.column(WAY)[slides], 0.5 * acceleration * watched.time[slides] ** 2, atol=1e-3)
    assert watched.column(WAY).max() < 0.305


@pytest.mark.parametrize(
    ("wide", "elasticity", "density", "along"),
    [(0.29, "1 MPa", 7800, -0.2), (0.2, "1 MPa", 7800, -0.2), (0.2, "1 MPa", 7800, 0.4), (0.2, "0.3 MPa", 2000, -0.2)],
)
def test_a_block_slides_along_a_soft_part_to_its_stop(prepared, wide, elasticity, density, along):
    """A part that deforms holds on to it by all particles along the way: those around the start alone turned over at the end of
    the way, and energies of 1e10 J came up at the stop. The block falls 5 to 8 cm; it is 40 to 300 times as heavy as the part. A
    scene has to insist on this: the part turns over where the block stays on its stop."""
    text = f"""gravity (0, 0, -9.81) m/s^2
object base {{ shape box (0.1, 0.25, 0.15) m position (0, 0, 3) m density 300 elasticity {elasticity} }}
object block {{ shape box ({wide}, {wide}, {wide}) m position ({0.05 + wide / 2}, 0, 3) m density {density} elasticity rigid }}
joint weld base world {{ at (0, 0, 3) m }}
joint slider block base {{ at (0.05, 0, 3) m axis ({along}, 0.6, 0.6) limits -8 cm to 8 cm }}
control {{ time 1 s }}
"""
    watched = Watched(prepared(text, insist=True), 0.35, 10)
    assert watched.column(WAY, 1).min() < -0.07
    assert watched.residual() < 1e-4


@pytest.mark.parametrize("most", [8, 30])
def test_check_tells_the_gap_of_a_slider_at_the_end_of_its_way(prepared, most):
    """It holds a part of 25 cm by a longer lever there, with K over the ratio of the mobilities 1/M + d.S^-1 d of its points."""
    text = f"""gravity (0, 0, -9.81) m/s^2
object base {{ shape box (0.1, 0.15, 0.25) m position (0, 0, 3) m density 300 elasticity 1 MPa }}
object block {{ shape box (0.2, 0.2, 0.2) m position (0.15, 0, 3) m density 7800 elasticity rigid }}
joint weld base world {{ at (0, 0, 3) m stiffness 1e8 N/m }}
joint slider block base {{ at (0.05, 0, 3) m axis (0, 0, 1) limits {-most} cm to {most} cm }}
control {{ time 1 s accuracy preview }}
"""
    ready = prepared(text, insist=True)
    words = ready.plan.tables["joints"].splitlines()[2].split()
    k, radius = float(words[words.index("stiffness") + 1]), words[words.index("patch") + 2]
    system, at = ready.system, np.array([0.05, 0.0, 3.0])
    near = (system.object == 0) & (np.linalg.norm(system.position - at, axis=1) <= (np.inf if radius == "all" else float(radius)))
    centre = np.average(system.position[near], axis=0, weights=system.mass[near])
    place, mass = system.position[near] - centre, system.mass[near]
    inverse = np.linalg.inv(np.einsum("p,pi,pj->ij", mass, place, place))
    own = 1.0 / (7800 * 0.2**3) * (1.0 + 0.1**2 / (0.2**2 / 6.0))
    start, end = (own + 1.0 / mass.sum() + d @ inverse @ d for d in (at - centre, at - centre + [0.0, 0.0, most / 100.0]))
    gap = next(m for m in ready.certificate.margins if m.name == "joint gap")
    assert gap.value == pytest.approx(7800 * 0.2**3 * G / k * end / start, rel=1e-3)
    assert "at the end of its way" in gap.text


@pytest.mark.parametrize(
    ("more", "springs"), [("", 1), (" friction 0.5 N*m", 2), (" friction 0.5 N*m limits -1 rad to 1 rad", 3)]
)
@pytest.mark.parametrize(("shape", "axis"), [("(0.3, 0.2, 0.1)", (0, 1, 0)), ("(0.1, 0.1, 0.4)", (0.3, 1, -0.5))])
def test_the_bound_counts_the_servos_of_an_elastic_hinge(prepared, shape, axis, more, springs):
    """Each spring of a servo has the rate k e.S^-1 e = k sum w^2/m at the particles it acts on, e across the axis: at least that
    of the direction that is hardest to turn, in the second moments S of the particles within the radius that the fix is told."""
    text = f"""object block {{ shape box {shape} m position (0, 0, 1) m density 1000 elasticity 1 MPa }}
joint hinge block world {{ at (0.02, 0, 1) m axis {axis} MORE }}
control {{ time 1 s accuracy preview }}
"""
    without, given = prepared(text.replace("MORE", "")), prepared(text.replace("MORE", "motor speed 2 rad/s" + more))
    words = given.plan.tables["joints"].splitlines()[1].split()
    k, radius = float(words[words.index("servo") + 1]), float(words[words.index("patch") + 1])
    system = given.system
    near = np.linalg.norm(system.position - [0.02, 0.0, 1.0], axis=1) <= radius
    mass, place = system.mass[near], system.position[near] - np.average(system.position[near], axis=0, weights=system.mass[near])
    inverse = np.linalg.inv(np.einsum("p,pi,pj->ij", mass, place, place))
    n = np.array(axis) / np.linalg.norm(axis)
    plane = np.linalg.svd(n[None])[2][1:]
    least = np.linalg.eigvalsh(plane @ inverse @ plane.T)[0]
    rise = (joint_rate(given) - joint_rate(without))[near].max()
    assert rise >= 0.99 * springs * k * least


def joint_rate(ready):
    """Share of joints in the bound of each particle [1/s^2]."""
    return next(effect for effect in ready.resolved.effects if effect.name == "joint").rate(ready.context)


def test_a_joint_breaks_at_its_force(prepared):
    """A mass on a rod is let down into a spring-loaded pull that rises: it parts within 2 % of its force, and falls."""
    text = f"""gravity (0, 0, 0) m/s^2
{FREE.format(name="mass", shape="sphere 5 cm", at="(0, 0, 1)")}
{FREE.format(name="puller", shape="sphere 5 cm", at="(0, 0, 0)")}
joint ball mass world {{ at (0, 0, 1.05) m breaks 20 N }}
joint slider puller world {{ axis (0, 0, -1) motor speed 0.2 m/s }}
joint spring mass puller {{ stiffness 100 N/m }}
control {{ time 3 s }}
"""
    watched = Watched(prepared(text), 2.0, 400)
    broken = watched.column(BROKEN) > 0.0
    assert broken[-1] and not broken[0]
    at = int(np.argmax(broken))
    assert 100.0 * (watched.column(WAY, 2)[at] - 1.0) == pytest.approx(20.0, rel=0.02)
    assert watched.column(FORCE)[at:].max() == 0.0


def test_what_is_joined_does_not_touch(prepared):
    """Links in each other are not refused, not pushed apart, and no contact is on; with `contact on` they are refused."""
    text = f"""gravity (0, 0, -9.81) m/s^2
{FREE.format(name="a", shape="box (10, 4, 4) cm", at="(0, 0, 1)")}
{FREE.format(name="b", shape="box (10, 4, 4) cm", at="(0.09, 0, 1)")}
joint ball a world {{ at (-0.05, 0, 1) m }}
joint hinge b a {{ at (0.045, 0, 1) m axis (0, 1, 0) MORE }}
control {{ time 1 s }}
"""
    ready = prepared(text.replace("MORE", ""))
    assert not ready.resolved.on("contact") and "all that could meet is joined" in ready.verdicts["contact"].reason
    with pytest.raises(Exception, match="b starts inside a"):
        prepared(text.replace("MORE", "contact on"))


@pytest.mark.parametrize("elasticity", ["1 MPa", "5 MPa", "50 MPa"])
def test_what_hangs_on_a_rope_does_not_part_from_it(prepared, elasticity):
    """No gap that shows at the usual stiffness, however much the rope stretches; a harder rope has the joint of its material."""
    text = f"""gravity (0, 0, -9.81) m/s^2
object line {{ shape rope from (0, 0, 2) m to (0, 0, 1) m thickness 1 cm density 900 elasticity {elasticity} hold start }}
object bob {{ shape sphere 8 cm position (0, 0, 0.92) m mass 1 kg elasticity rigid }}
joint ball line bob {{ at (0, 0, 1) m }}
control {{ time 0.1 s }}
"""
    gap = next(m for m in prepared(text).certificate.margins if m.name == "joint gap")
    assert gap.severity == "ok" and gap.value < 1.6e-4
