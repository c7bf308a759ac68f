# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces that run over objects that stand, and walls that move: what they do to others, the ledger, and what is refused."""

import math

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.drives.shift import Shift, motion_of
from mdanim_lammps.features.drives.words import DriveOscillation, DriveVelocity, ShiftKey
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene

G = 9.81
GRAVITY = "gravity (0, 0, -9.81) m/s^2\n"
KINDS = ["1 MPa", "rigid"]


def block(elasticity: str, friction: float, x: float = 0.0) -> str:
    return (
        f"object block {{ shape box (8, 8, 4) cm position ({x}, 0, 2) cm density 500 "
        f"elasticity {elasticity} friction {friction} }}\n"
    )


def rope(x: float, y: float, friction: float) -> str:
    return (
        f"object rope {{ shape rope from ({x}, 0, 0.5) cm to ({y}, 0, 0.5) cm thickness 1 cm density 900 "
        f"elasticity 1 MPa friction {friction} }}\n"
    )


def watched(ready, times) -> list:
    """Velocities of centres, and ledgers, at some times [s]."""
    found, now, dt = [], 0, ready.certificate.timestep
    with Instance(ready.plan) as instance:
        instance.setup()
        for time in times:
            instance.run(round(time / dt) - now)
            now = round(time / dt)
            centres = instance.system.center_of_mass(instance.array("x"))
            found.append((instance.system.center_of_mass(instance.array("v")), energies(instance, centres)))
    return found


def closes(first: dict, last: dict, within: float) -> bool:
    """Whether what energies have changed by is the work."""
    change = sum(last[k] - first[k] for k in last if k != "work")
    return abs(change - (last["work"] - first["work"])) < within * sum(abs(last[k] - first[k]) for k in last)


def slipping(ready, speed: float, friction: float) -> None:
    """A block slips for v/(mu g), within a per cent, then rides; the work is m v^2, half of it heat."""
    slips = speed / (friction * G)
    (_, first), (half, _), (end, last) = watched(ready, [1e-9, 0.5 * slips, 2.0 * slips])
    mass = ready.system.mass_of[-1]
    assert speed * 0.5 * slips / half[-1, 0] == pytest.approx(slips, rel=0.01)
    assert end[-1, 0] == pytest.approx(speed, rel=0.01)
    assert last["work"] == pytest.approx(mass * speed**2, rel=0.01)
    assert last["friction_heat"] + last["contact_damping_loss"] == pytest.approx(0.5 * mass * speed**2, rel=0.02)
    assert closes(first, last, 1e-3)


# --- belts ------------------------------------------------------------------------------------------------------------


def belt(speed: str, friction: float, elasticity: str = "1 MPa", more: str = "") -> str:
    return (
        f"object belt {{ shape box (200, 20, 4) cm position (0, 0, -2) cm density 1000 elasticity {elasticity} hold all "
        f"friction {friction} {more}\n  drive surface {speed} m/s }}\n"
    )


@pytest.mark.parametrize("elasticity", KINDS)
@pytest.mark.parametrize(("speed", "friction"), [(0.4, 0.3), (0.8, 0.5)])
def test_a_block_on_a_belt_that_stands_slips_and_then_rides(prepared, speed, friction, elasticity):
    """As on a plate that moves as a whole; no point of the belt moves."""
    it = block(elasticity, friction)
    ready = prepared(GRAVITY + belt(f"({speed}, 0, 0)", friction) + it + "control { time 1 s }\n")
    slipping(ready, speed, friction)


def test_a_rigid_ball_on_a_belt_rolls(prepared):
    """At 2/7 of its speed, when it does not slip any more; along both axes alike."""
    ball = "object ball { shape sphere 4 cm position (0, 0, 4) cm density 700 elasticity rigid friction 0.5 }\n"
    ready = prepared(GRAVITY + belt("(0.3, 0.4, 0)", 0.5, "rigid") + ball + "control { time 1 s }\n")
    (_, first), (end, last) = watched(ready, [1e-9, 0.5])
    np.testing.assert_allclose(end[-1, :2], np.array([0.3, 0.4]) * 2.0 / 7.0, rtol=2e-3)
    assert closes(first, last, 1e-3)


def test_a_rope_on_a_belt_is_carried(prepared):
    """Its points ride at the speed of the belt, with the work m v^2."""
    line = rope(-20, 20, 0.4)
    ready = prepared(GRAVITY + belt("(0, 0.3, 0)", 0.4, "rigid") + line + "control { time 0.4 s }\n")
    (_, first), (end, last) = watched(ready, [1e-9, 0.3])
    assert end[-1, 1] == pytest.approx(0.3, rel=0.01)
    assert last["work"] == pytest.approx(ready.system.mass_of[-1] * 0.09, rel=0.02)
    assert closes(first, last, 2e-3)


def test_the_surface_runs_in_the_direction_that_is_written(prepared):
    """Along the world of a belt that is turned; speeds of one that is moved besides add up."""
    turned = belt("(0.3, 0, 0)", 0.5, more="orientation axis (0, 0, 1) angle 30 deg")
    both = belt("(0.3, 0, 0)", 0.5, more="drive velocity (-0.1, 0, 0) m/s")
    for first, speed in ((turned, 0.3), (both, 0.2)):
        for elasticity in KINDS:
            it = block(elasticity, 0.5)
            ready = prepared(GRAVITY + first + it + "control { time 0.3 s }\n")
            ((end, _),) = watched(ready, [0.2])
            np.testing.assert_allclose(end[-1], [speed, 0.0, 0.0], atol=0.01 * speed)


# --- walls ------------------------------------------------------------------------------------------------------------


def room(drive: str, box: str = "from (-50, -20, 0) cm to (50, 20, 40) cm") -> str:
    return f"walls {box}\nwalls {drive}\n"


@pytest.mark.parametrize("elasticity", KINDS)
@pytest.mark.parametrize(("speed", "friction"), [(0.4, 0.3), (0.8, 0.5)])
def test_a_block_on_the_floor_of_a_box_that_moves(prepared, speed, friction, elasticity):
    """It slips for v/(mu g), then rides."""
    it = block(elasticity, friction, 30.0)
    ready = prepared(GRAVITY + room(f"drive velocity ({speed}, 0, 0) m/s") + it + "control { time 1 s }\n")
    slipping(ready, speed, friction)


@pytest.mark.parametrize("elasticity", KINDS)
def test_a_wall_that_comes_throws_a_ball_at_twice_its_speed(prepared, elasticity):
    """Without friction nothing is lost: 2 v of a ball that was at rest, but for what rings in one that deforms; the work is
    2 m v^2."""
    ball = f"object ball {{ shape sphere 4 cm position (-40, 0, 20) cm density 700 elasticity {elasticity} }}\n"
    ready = prepared(room("drive velocity (0.5, 0, 0) m/s") + ball + "control { time 0.4 s }\n")
    (_, first), (end, last) = watched(ready, [1e-9, 0.3])
    mass = ready.system.mass_of[0]
    assert end[0, 0] == pytest.approx(1.0, rel=1e-4 if elasticity == "rigid" else 0.03)
    assert last["work"] == pytest.approx(mass * 0.5 * end[0, 0], rel=2e-3)  # the impulse, at the speed of the wall
    assert closes(first, last, 1e-3)


@pytest.mark.parametrize("elasticity", KINDS)
def test_what_lies_on_a_shaken_floor_leaves_it_at_g(prepared, elasticity):
    """Amplitude (2 pi f)^2 = g, within 2 per cent."""
    least, frequency = [], 4.0
    for factor in (0.98, 1.02):
        amplitude = factor * G / (2 * math.pi * frequency) ** 2
        soft = "elasticity rigid" if elasticity == "rigid" else "elasticity 300 kPa damping 0.5"
        block = f"object it {{ shape box (6, 6, 6) cm position (0, 0, 3) cm density 700 {soft} }}\n"
        shaken = room(f"drive oscillation (0, 0, {amplitude}) m frequency {frequency} Hz phase -90 deg")
        ready = prepared(GRAVITY + shaken + block + "control { time 1 s contact-damping 1 friction 0.3 }\n")
        fix, dt = "rigid" if elasticity == "rigid" else "walls", ready.certificate.timestep
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(round(1.2 / frequency / dt))
            touching = []
            for _ in range(50):
                instance.run(round(0.01 / frequency / dt))
                touching.append(instance.fix_value(fix, "touching"))
        least.append(min(touching))
    assert least[0] > 0 and least[1] == 0


def test_a_box_on_a_path_carries_what_is_in_it(prepared):
    """Through keys, by 20 cm along y and up, with a block, a ball and a rope in it: what is in it comes to rest there, and the
    work is what it was lifted by and what heat took."""
    things = (
        block("1 MPa", 0.5, -20.0)
        + "object stone { shape box (8, 8, 4) cm position (0, 0, 2) cm density 500 elasticity rigid friction 0.5 }\n"
        + rope(15, 30, 0.5)
    )
    keys = "key 0.5 s by (0, 20, 10) cm\nwalls key 0.7 s by (0, 20, 10) cm"
    ready = prepared(GRAVITY + room(keys) + things + "control { time 0.8 s }\n")
    (_, first), (end, last) = watched(ready, [1e-9, 0.75])
    assert np.abs(end).max() < 2e-3
    assert last["work"] - first["work"] > ready.system.mass_of.sum() * G * 0.1
    assert closes(first, last, 2e-3)


def test_places_are_those_of_the_plugin(prepared):
    """Displacements as Python has them for pictures and the guard, against those of a plate that the plugin drives."""
    words = "drive velocity (0.2, 0, 0.1) m/s\n drive oscillation (1, 2, 0) cm frequency 3 Hz phase 30 deg\n"
    keys = " key 0.1 s at (5, 0, -2) cm\n key 0.3 s at (0, 8, 2) cm\n key 0.35 s at (0, 8, 5) cm\n"
    of = "shape box (40, 40, 4) cm position (0, 0, -2) cm density 1000 elasticity 1 MPa hold all"
    plate = f"object plate {{ {of}\n {words}{keys} }}\n"
    ready = prepared(plate + "control { time 0.4 s }\n")
    drives = (DriveVelocity((0.2, 0.0, 0.1)), DriveOscillation((0.01, 0.02, 0.0), 3.0, math.radians(30.0)))
    points = (ShiftKey(0.1, (0.05, 0.0, 0.0)), ShiftKey(0.3, (0.0, 0.08, 0.04)), ShiftKey(0.35, (0.0, 0.08, 0.07)))
    shift, bounds, dt = Shift(drives, points), motion_of("walls", drives, points, 0.4), ready.certificate.timestep
    with Instance(ready.plan) as instance:
        instance.setup()
        start, before = instance.array("x")[0].copy(), np.zeros(3)
        for n in range(1, 40):
            instance.run(round(0.01 / dt))
            time = n * round(0.01 / dt) * dt
            found = instance.array("x")[0] - start
            np.testing.assert_allclose(found, shift.at(time), rtol=0, atol=1e-13)
            assert (np.array(bounds.low) - 1e-12 <= found).all() and (found <= np.array(bounds.high) + 1e-12).all()
            assert np.linalg.norm(found - before) <= bounds.speed * round(0.01 / dt) * dt + 1e-12
            before = found


def test_the_lock_says_the_same():
    """All words come back from scene.lock.txt."""
    drives = "drive oscillation (1, 0, 0) cm frequency 3 Hz\nwalls drive velocity (0, 0.1, 0) m/s\nwalls key 1 s by (0, 0, 0.1) m"
    scene = parse_scene(
        room(drives, "from (-2, -2, -1) m to (2, 2, 1) m") + belt("(0.3, 0, 0)", 0.5) + "control { time 0.4 s }\n"
    )
    again = parse_scene(lock_text(scene, {}))
    assert again.walls == scene.walls and again.walls_drive == scene.walls_drive and again.walls_keys == scene.walls_keys
    assert len(again.walls_drive) == 2 and again.solids[0].drive == scene.solids[0].drive


# --- words ------------------------------------------------------------------------------------------------------------

WALLS = "walls from (-1, -1, 0) m to (1, 1, 1) m\n"
STONE = "object stone { shape box (8, 8, 4) cm position (0, 0, 12) cm density 500 elasticity rigid }\n"


@pytest.mark.parametrize(("text", "told", "way_out"), [
    (belt("(1, 0, 0)", 0.3).replace("hold all", "hold face -z"), "held in a part", "hold all"),
    (belt("(1, 0, 0)", 0.3, more="drive turn (0, 0, 1) rad/s"), "belt is turned", "leave the turn out"),
    (belt("(1, 0, 0)", 0.3, more="release 1 s"), "it is let go", "drive velocity"),
    (belt("(1, 0, 0)", 0.3).replace("hold all", ""), "nothing of belt is held", "hold all"),
    (WALLS + "walls drive oscillation (1, 0, 0) cm frequency 0 Hz\n" + STONE,
     "the frequency of a drive must be > 0", "e.g."),
    (WALLS + "walls key 0 s by (1, 0, 0) cm\n" + STONE, "at 0 s the box of the walls is", "leave"),
    ("# no place\nwalls drive velocity (1, 0, 0) cm/s\n" + STONE, "these walls have no place", "walls from"),
    (WALLS + "walls from (-1, -1, 0) m to (1, 1, 2) m\n" + STONE, "walls have one place", "leave"),
    (WALLS + "walls drive turn (0, 0, 1) rad/s\n" + STONE,
     "walls drive cannot be followed by 'turn'", "velocity, oscillation"),
])  # fmt: skip
def test_refusals(text, told, way_out):
    """With its place, cause, value and way out."""
    with pytest.raises(SceneError) as e:
        prepare(parse_scene(text + "control { time 3 s }\n"))
    (problem,) = e.value.problems
    assert told in problem.message and way_out in problem.hint and problem.span.line == 2


@pytest.mark.parametrize("text", [
    room("drive velocity (1, 0, 0) cm/s") + STONE,
    "# a belt\n" + belt("(1, 0, 0)", 0.0).replace(" friction 0.0", "") + STONE,
])  # fmt: skip
def test_the_contact_of_the_paper_has_neither(text):
    """Its walls stand, and it has no friction."""
    with pytest.raises(SceneError) as e:
        prepare(parse_scene(text.replace("elasticity rigid", "elasticity 1 MPa") + "control { time 1 s contact-model paper }\n"))
    (problem,) = e.value.problems
    assert "contact-model paper" in problem.message and "take contact-model paper out" in problem.hint


BASIN = """
gravity (0, 0, -9.81) m/s^2
liquid water {{ basin from (-50, -30, 0) cm to (50, 30, 40) cm  level 15 cm  density 1000 {more} }}
object duck {{ shape box (10, 10, 10) cm  position (0, 0, 20) cm  density 300  elasticity rigid }}
control {{ time 1 s  resolution 5 cm }}
"""
SLOSH = "drive oscillation (2, 0, 0) cm frequency 0.8 Hz"


@pytest.mark.parametrize(("walls", "more", "way_out"), [
    ("from (-50, -30, 0) cm to (50, 30, 80) cm\nwalls " + SLOSH, "",
     "write drive oscillation (0.02, 0, 0) m frequency 0.8 Hz in water, too"),
    ("from (-50, -30, 0) cm to (50, 30, 80) cm\nwalls key 0.5 s by (10, 0, 0) cm", "",
     "write key 0.5 s by (0.1, 0, 0) m in water"),
    ("from (-50, -30, 0) cm to (50, 30, 80) cm\nwalls drive velocity (0, 0, 1) cm/s", "", "take the motion along z out"),
    ("from (-60, -30, 0) cm to (60, 30, 80) cm\nwalls " + SLOSH, "", None),
    ("from (-50, -30, 0) cm to (50, 30, 80) cm\nwalls " + SLOSH, SLOSH, None),
])  # fmt: skip
def test_walls_that_run_through_a_basin_that_stands_are_told(walls, more, way_out):
    """With the line that has the basin go along, not where they stay outside of it, or it moves."""
    ready = prepare(parse_scene(f"walls {walls}\n" + BASIN.format(more=more)))
    told = [p for p in ready.certificate.notes if p.severity == "warning" and "whose basin stands" in p.message]
    assert len(told) == (way_out is not None)
    if way_out:
        assert way_out in told[0].hint and told[0].span.line <= 2
