# SPDX-License-Identifier: GPL-2.0-only
"""How hard rigid objects are where they touch follows from what may happen on their ways, not from the time of the scene."""

from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.contact.rigid_surfaces import frequency
from mdanim_lammps.features.joints.hung import hung
from mdanim_lammps.features.joints.links import links_of
from mdanim_lammps.features.rigid.touching import omega
from mdanim_lammps.scene.parse import parse_scene

ROOT = Path(__file__).parents[2]
SCENE = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object cart {{ shape box (20, 20, 10) cm  position (0, 0, 0.05) m  density 600  elasticity rigid  {push} }}
object load {{ shape box (10, 10, 10) cm  position (0, 0, 0.15) m  density 600  elasticity rigid }}
object stone {{ shape sphere 5 cm  position (0.6, 0, 0.05) m  density 600  elasticity rigid }}
control {{ time {time} s  friction 0.4 }}
"""
PUSHES = {"force": "force (20, 0, 0) N", "torque": "torque (0, 0, 1) N*m", "none": "velocity (1, 0, 0) m/s"}


@pytest.mark.parametrize("push", PUSHES)
def test_a_scene_that_is_watched_for_longer_moves_alike(prepared, push):
    """To the bit, as long as both go on."""
    found = []
    for time in (0.4, 4.0):
        ready = prepared(SCENE.format(push=PUSHES[push], time=time))
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(round(0.2 / ready.certificate.timestep))
            found.append((omega(ready.context), ready.certificate.timestep, ready.system.center_of_mass(instance.array("x"))))
    for other in found[1:]:
        assert other[:2] == found[0][:2] and np.array_equal(other[2], found[0][2])


def test_what_is_pushed_into_the_ground_is_as_hard_as_that_asks(prepared):
    """One object alone, 5 m above the ground: the push counts on its way there."""
    text = """gravity (0, 0, -9.81) m/s^2
    ground z 0 m
    object ball { shape sphere 5 cm  position (0, 0, 5.05) m  density 600  elasticity rigid  force (0, 0, -30) N }
    control { time 1 s }
    """
    ready = prepared(text)
    mass = ready.system.mass_of[0]
    speed = np.sqrt(2 * (9.81 + 30 / mass) * 5.0)
    assert speed <= omega(ready.context) * 0.02 * 0.1 < 2.0 * speed


BOAT = """gravity (0, 0, -9.81) m/s^2
liquid lake { basin from (-0.8, -0.4, 0) m to (0.8, 0.4, 0.9) m  density 1000  level 0.5 m }
object hull { shape box (100, 40, 20) cm  position (0, 0, 0.52) m  density 400  elasticity rigid }
object sail { shape box (40, 0.3, 60) cm  position (0.2, 0, 0.92) m  density 400  elasticity rigid }
joint weld sail hull { at (0.2, 0, 0.62) m }
control { time 1 s  resolution 5 cm }
"""


def test_a_thin_sail_costs_a_boat_little(prepared):
    """One of 3 mm on a hull of 20 cm, that floats with it: cells of the liquid, not of its thickness, and two and a half times
    the steps of the hull alone. By its thickness and the height of its foot it had 400 times the particles and 60 times the
    steps."""
    ready = prepared(BOAT)
    alone = 2.0 * np.sqrt(9.81 / 0.2) / 0.02  # of the hull
    assert frequency(ready.context).speed == 0.0 and omega(ready.context) < 4.0 * alone
    assert ready.system.particles < 2000
    displaced = np.add.reduceat(ready.system.volume, ready.system.first[:-1])
    np.testing.assert_allclose(displaced, [0.08, 0.4 * 0.003 * 0.6])


WELD, HINGE = "joint weld sail hull { at (0.2, 0, 0.62) m }", "joint hinge sail hull { at (0.2, 0, 0.62) m  %s }"


def test_a_sail_on_a_hinge_falls_with_the_hull(prepared):
    """About its mast it does not come down: contacts are softer than those of a sail that falls by itself."""
    ready = prepared(BOAT.replace(WELD, HINGE % "axis (0, 0, 1)"))
    alone = 2.0 * np.sqrt(9.81 / 0.2) / 0.02
    assert frequency(ready.context).speed == 0.0 and omega(ready.context) < 4.0 * alone


@pytest.mark.parametrize(
    ("axis", "sinks"), [("axis (0, 0, 1)", 0.0), ("axis (1, 0, 0)", 0.6), ("axis (1, 0, 0) limits -30 deg to 60 deg", 0.15)]
)
def test_what_a_hinge_lets_come_down(axis, sinks):
    """By its arm and back about a level line, less where it has limits; a cube welded to the sail's top with the sail, and the
    hull by what their energy gives it."""
    top = "shape box (1, 1, 1) cm  position (0.2, 0, 1.225) m  density 400  elasticity rigid"
    more = f"object top {{ {top} }}\njoint weld top sail {{ at (0.2, 0, 1.22) m }}\n"
    links = links_of(parse_scene(BOAT.replace(WELD, HINGE % axis) + more, "boat"))
    (group,) = hung(links)
    hull, sail, top = 0.08, 0.4 * 0.003 * 0.6, 1e-6
    lost = sinks * (sail + top * 0.605 / 0.3)
    assert group.first == 0
    np.testing.assert_allclose([group.sinks[m] for m in range(3)], [lost / hull, lost / (sail + top), sinks * 0.605 / 0.3])


SLING = """gravity (0, 0, -9.81) m/s^2
object mast { shape box (10, 10, 10) cm  position (0, 0, 2) m  density 50000  elasticity rigid }
object arm { shape box (50, 2, 2) cm  position (0.25, 0.1, 2) m  density 5000  elasticity rigid }
object lash { shape box (50, 2, 2) cm  position (0.25, 0.15, 2) m  density 500  elasticity rigid }
joint weld mast world { at (0, 0, 2) m }
joint hinge arm mast { at (0, 0.1, 2) m  axis (0, 1, 0)  %s }
joint %s lash arm { at (0.5, 0.15, 2) m  %s }
control { time 0.35 s }
"""
DOWN = 0.5 / np.sqrt(2.0)


@pytest.mark.parametrize(
    ("first", "joint", "more", "drops"),
    [
        ("", "hinge", "axis (0, 1, 0)", (0.25, 0.75)),
        ("", "ball", "", (0.25, 0.75)),
        ("", "weld", "", (0.25, 0.25)),
        ("", "hinge", "axis (1, 0, 0)", (0.25, 0.75)),  # at most: about its own length, and the arm turned, it is not known how
        ("", "slider", "axis (1, 0, 0)  limits -0.1 m to 0.05 m", (0.25, 0.35)),
        ("limits 0 to 45 deg", "hinge", "axis (0, 1, 0)  limits -30 deg to 0", (DOWN / 2, DOWN + 0.125)),
        ("limits 0 to 45 deg", "hinge", "axis (0, -1, 0)  limits 0 to 30 deg", (DOWN / 2, DOWN + 0.125)),
        ("limits -45 deg to 0", "weld", "", (0.0, 0.0)),
    ],
)
def test_what_a_double_pendulum_may_lose(first, joint, more, drops):
    """A light lash lies folded back along an arm that is level: both hang straight down in the end, or as far as joints let
    them, and each may have the energy of both."""
    (group,) = hung(links_of(parse_scene(SLING % (first, joint, more), "sling")))
    arm, lash = 1.0, 0.1
    lost = arm * drops[0] + lash * drops[1]
    own = (arm + lash,) * 2 if joint == "weld" else (arm, lash)
    wanted = [lost / 50.0, *(max(drop, lost / mass) for drop, mass in zip(drops, own))]
    np.testing.assert_allclose([group.sinks[m] for m in range(3)], wanted, atol=1e-12)


def test_a_hinge_at_what_turns_anyhow_has_no_axis_in_space():
    """An upright axis beyond a ball: the lash goes down as on a second ball."""
    at_ball = SLING.replace("hinge arm mast { at (0, 0.1, 2) m  axis (0, 1, 0)", "ball arm mast { at (0, 0.1, 2) m")
    balls, upright = (
        hung(links_of(parse_scene(at_ball % ("", *joint), "sling")))[0].sinks
        for joint in (("ball", ""), ("hinge", "axis (0, 0, 1)"))
    )
    assert upright[2] == pytest.approx(balls[2])


def test_a_sling_is_no_faster_than_its_energy_lets_it(prepared):
    """The lash gets more energy than by its own fall, and less than it and the arm lose."""
    ready = prepared(SLING % ("", "hinge", "axis (0, 1, 0)"))
    (group,) = hung(links_of(ready.scene))
    fastest = 0.0
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(50):
            instance.run(ready.certificate.steps // 50)
            fastest = max(fastest, float((instance.array("v")[ready.system.object == 2].mean(axis=0) ** 2).sum()))
    assert 0.75 < fastest / (2.0 * 9.81) < group.sinks[2] == pytest.approx(0.75 + 10.0 * 0.25)


def test_what_the_chains_of_a_drawbridge_may_lose():
    """Twelve links from the deck up to either winch, which drives: they may hang down from the deck, one below the other."""
    scene = parse_scene((ROOT / "scenes" / "drawbridge.txt").read_text(), "drawbridge")
    (group,) = hung(links_of(scene))
    place = {m: solid.name for m, solid in enumerate(scene.solids) if m in group.sinks}
    long, rise = np.hypot(2.01, 1.85) / 12, 1.85 / 12
    drops = [(i - 0.5) * (long + rise) for i in range(1, 13)]
    assert place.pop(group.first) == "deck" and len(place) == 24
    lost = 2.0 * sum(drops)
    np.testing.assert_allclose([group.sinks[m] for m in place], lost)
    assert group.sinks[group.first] == pytest.approx(lost * 7800 * 0.98 * long * 0.02**2 / (500 * 2.12 * 1.3 * 0.06))


def test_a_blow_on_a_thin_part_of_a_body_comes_back(prepared):
    """A cube hits a plate of 1 cm, welded to a block, with a corner at 5 m/s: it goes up to twice as deep as v/Omega, as
    central blows on corners do, with that of 5 times 2 % of the thickness; it comes back, and keeps the energy of all."""
    text = """object block { shape box (40, 40, 20) cm  position (0, 0, 0) m  density 400  elasticity rigid }
    object plate { shape box (40, 1, 60) cm  position (0, 0, 0.4) m  density 400  elasticity rigid }
    object cube { shape box (6, 6, 6) cm  position (0.03, 0.08, 0.5) m  velocity (0, -5, 0) m/s  density 400  elasticity rigid
      orientation axis (1, 0.3, 0.7) angle 70 deg }
    joint weld plate block { at (0, 0, 0.1) m }
    control { time 0.04 s  restitution 1 }
    """
    ready = prepared(text)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        deepest = instance.fix_value("rigid", "deepest")
        velocity = instance.array("v")[ready.system.object == 2].mean(axis=0)
        kinetic = instance.fix_value("rigid", "kinetic")
    assert 0.1 * 0.01 < deepest < 0.25 * 0.01 and velocity[1] > 0.5
    assert kinetic == pytest.approx(0.5 * 400 * 0.06**3 * 25.0, rel=5e-3)


@pytest.mark.parametrize(
    ("thick", "weld", "told"),
    [
        (0.3, "", "thin, sets the time step; make it thicker, weld it to something larger, or write contact-stiffness 0.25"),
        (0.3, "joint weld plate block { at (0.3, 0, 1) m }", "thin, sets the time step; make it thicker, or write"),
        (12, "", ""),
    ],
)
def test_what_is_thin_is_told_where_it_sets_the_step(prepared, thick, weld, told):
    """A plate beside a block, as thick as that or not."""
    ready = prepared(f"""gravity (0, 0, -9.81) m/s^2
    ground z 0 m
    object block {{ shape box (20, 20, 20) cm  position (0.4, 0, 1) m  density 600  elasticity rigid }}
    object plate {{ shape box (60, 20, {thick}) cm  position (0, 0, 1) m  density 600  elasticity rigid }}
    {weld}
    control {{ time 40 s }}
    """)
    found = [f"{n.message}; {n.hint}" for n in ready.certificate.notes if "sets the time step" in n.message]
    assert len(found) == bool(told)
    for part in told.split("; ") if told else []:
        assert part in found[0]


@pytest.mark.parametrize(("shape", "thick"), [("box (60, 60, 0.02) cm", 0.0002), ("box (60, 60, 2) cm", None)])
def test_what_is_held_and_thin_is_not_passed_through(prepared, shape, thick):
    """The fastest blow of a cube of 4 cm on it goes half as deep as it is thick, at most; a ball needs no more than by itself."""
    text = f"""gravity (0, 0, -9.81) m/s^2
    object board {{ shape {shape}  position (0, 0, 0) m  hold all }}
    object it {{ shape SHAPE  position (0, 0, 1) m  density 600  elasticity rigid }}
    control {{ time 1 s }}
    """
    cube = frequency(prepared(text.replace("SHAPE", "box (4, 4, 4) cm")).context)
    ball = frequency(prepared(text.replace("SHAPE", "sphere 2 cm")).context)
    assert ball.thin == 0.04 and cube.thin == pytest.approx(0.04 if thick is None else 25.0 * thick)
    assert cube.speed / cube.omega <= 0.5001 * (thick or 1.0)
