# SPDX-License-Identifier: GPL-2.0-only
"""Driven objects: where each goes, what it does to others by contact and friction, what the ledger tells, and what is refused."""

import math
import re
from itertools import pairwise

import numpy as np
import pytest
from drive_cases import GRAVITY, G, followed, plate, stays
from mdanim_lammps import Scene
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.contact.rigid_surfaces import loads
from mdanim_lammps.features.drives import motion
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from twin.drives import Motion

# --- where it goes ----------------------------------------------------------------------------------------------------

ALL = """drive velocity (0.2, 0, 0.1) m/s  drive turn (0, 2, 1) rad/s about (10, 0, 0) cm
  drive oscillation (1, 2, 0) cm frequency 3 Hz  drive oscillation (0, 0, 1) cm frequency 5 Hz phase 90 deg
  key 0.1 s at (5, 0, 0) cm axis (0, 0, 2) angle 400 deg  key 0.3 s at (0, 8, -2) cm"""
TWIN = Motion(
    velocity=(0.2, 0.0, 0.1),
    turn=(0.0, 2.0, 1.0),
    about=(0.1, 0.0, 0.0),
    oscillations=[((0.01, 0.02, 0.0), 3.0, 0.0), ((0.0, 0.0, 0.01), 5.0, 0.25)],
    pivot=(0.0, 0.0, -0.02),
    keys=[(0.0, (0, 0, 0), (0, 0, 0)), (0.1, (0.05, 0, 0.02), (0, 0, math.radians(400.0))), (0.3, (0, 0.08, 0), (0, 0, 0))],
)


def test_all_drives_add_up(prepared):
    """Words of a scene to places, against numpy; before the first key it comes from where it is, behind the last it stays."""
    ready = prepared(plate(ALL) + "control { time 0.4 s }\n")
    start, times = ready.system.position, (0.05, 0.2, 0.4)
    dt = ready.certificate.timestep
    for time, x in zip(times, followed(ready, times, lambda instance: instance.array("x").copy())):
        np.testing.assert_allclose(x, TWIN.places(start, round(time / dt) * dt), rtol=0, atol=1e-14)


def test_a_lift_that_waits_stands(prepared):
    """It stands until its first key and from the one at the top on, in all digits, tilted as it is; on its way it is never below
    or above. Its bounds have no way that it does not go, and 3/2 of its mean speed with up to a fifth for what is between the
    places at which they look."""
    tilted = " axis (1, 0, 0) angle 10 deg"
    keys = f"key 0.1 s at (0, 0, -2) cm  key 0.3 s at (0, 0, 18) cm{tilted}  key 0.4 s at (0, 0, 18) cm{tilted}"
    ready = prepared(plate(keys) + "control { time 0.5 s }\n")
    start, times = ready.system.position, [*np.linspace(0.01, 0.5, 50)]
    x = [start, *followed(ready, times, lambda instance: instance.array("x").copy())]
    for a, b in pairwise(x[:11]):
        assert np.array_equal(a, b)
    for a, b in pairwise(x[31:]):
        assert np.array_equal(a, b)
    height = np.array([now[:, 2].mean() for now in x])
    assert height.min() >= height[0] - 1e-15 and height.max() <= height[0] + 0.2 + 1e-12
    assert height[-1] == pytest.approx(height[0] + 0.2, abs=1e-12)
    path = motion.KeyPath(motion.keys_of(solid := ready.scene.solids[0]), solid.position, 0.5)
    assert path.low[2] == 0.0 and path.high[2] == pytest.approx(0.2, rel=1e-12)
    assert 1.5 * 0.2 / 0.2 <= path.speed <= 1.2 * 1.5 * 0.2 / 0.2


@pytest.mark.parametrize(("drive", "time"), [
    *((drive, 0.4) for drive in [ALL, *ALL.replace("  drive", "\n  drive").replace("  key", "\n  key").splitlines()[:5]]),
    ("drive turn (0, 0, 0.3) rad/s about (2, 0, 0) m", 0.4), ("key 0.2 s at (0, 0, 0) cm axis (1, 1, 0) angle 90 deg", 0.4),
    ("drive turn (5, -5, 0) rad/s  key 10 s at (1, 1, 1) m", 10.0),
    ("drive turn (1, 1, 1) rad/s about (1, 0, 0) m  key 5 s at (1, -2, 1) m  key 10 s at (-1, 1, 0) m", 10.0),
    ("key 1 s at (0, 0, -2) cm  key 3 s at (0, 0, 2) m  key 4 s at (0, 0, 2) m", 5.0),
    ("key 1 s at (0, 0, 0) m  key 3 s at (0, 0, 2) m axis (0, 1, 0) angle 1  key 4 s at (0, 0, 5) m axis (0, 1, 0) angle 1", 5.0),
])  # fmt: skip
def test_bounds_hold_and_are_near(drive, time):
    """Ways of all corners, and their speeds, at many times: within the bounds, which are no more than four times as wide."""
    if not drive.strip():
        return
    scene = parse_scene(plate(drive) + f"control {{ time {time} s }}\n")
    solid = scene.solids[0]
    found = motion.bounds(solid, time)
    start = motion._corners(solid)
    rate, about = motion.turn_of(solid)
    twin = Motion(
        velocity=motion.velocity_of(solid),
        turn=rate,
        about=about,
        oscillations=[(one.way, one.frequency, one.phase / (2 * math.pi)) for one in motion.oscillations_of(solid)],
        pivot=solid.position,
        keys=[(key.time, np.subtract(key.at, solid.position), key.rotation) for key in motion.keys_of(solid)],
    )
    x = np.array([twin.places(start, t) for t in np.linspace(0.0, time, 2001)])
    way, speed = x - start, np.linalg.norm(np.diff(x, axis=0), axis=2).max() / (time / 2000)
    box = (x - start).min((0, 1)), (x - start).max((0, 1))
    corner = x.min((0, 1)) - start.min(0), x.max((0, 1)) - start.max(0)  # of the box around all places
    assert (np.array(found.low) <= corner[0] + 1e-12).all() and (np.array(found.high) >= corner[1] - 1e-12).all()
    assert speed <= found.speed * (1 + 1e-9) and found.speed <= 4.0 * speed
    widest = np.maximum(np.abs(box), 0.02).max()
    assert np.abs([found.low, found.high]).max() <= 4.0 * widest and way.any()


def test_rigid_objects_touch_it_by_features(prepared):
    """A ball on a belt rolls: friction moves it and turns it until the point that touches has the speed of the belt, v_ball =
    2/7 v; at points of a surface it would be dragged along. Both have few particles, and the fix asks the drive where it is."""
    speed = 0.7
    ball = "object ball { shape sphere 4 cm position (0, 0, 4) cm density 700 elasticity rigid }\n"
    belt = plate(f"drive velocity ({speed}, 0, 0) m/s", "(200, 20, 4) cm")
    ready = prepared(GRAVITY + belt + ball + "control { time 0.4 s friction 0.3 }\n")
    assert "drive drive" in next(c for c in ready.resolved.effects if c.name == "rigid").commands(ready.context)[-1]
    assert ready.system.particles == 16

    def watch(instance):
        system = instance.system
        first, v, x = system.first[1], instance.array("v"), instance.array("x")
        arm, own = x[first:] - x[first:].mean(0), v[first:] - v[first:].mean(0)
        turning = np.cross(arm, own).sum(0) / (arm[:, [0, 2]] ** 2).sum()  # about y
        return v[first:].mean(0)[0], turning[1]

    ((moves, turns),) = followed(ready, [0.4], watch)
    assert moves == pytest.approx(2.0 / 7.0 * speed, rel=2e-3)
    assert turns == pytest.approx(-5.0 / 7.0 * speed / 0.04, rel=2e-3)


def test_a_placed_group_takes_its_drives_along(prepared):
    """Velocities, axes, points and keys are turned and moved with it."""
    alone = prepared(plate(ALL) + "control { time 0.4 s }\n")
    group = f"group g {{\n{plate(ALL)}}}\nplace g as p {{ position (1, 2, 3) m orientation axis (0, 0, 1) angle 90 deg }}\n"
    placed = prepared(group + "control { time 0.4 s }\n", "placed")
    one, other = (followed(r, (0.2,), lambda instance: instance.array("x").mean(axis=0))[0] for r in (alone, placed))
    np.testing.assert_allclose(other, [1.0 - one[1], 2.0 + one[0], 3.0 + one[2]], rtol=0, atol=1e-12)


def test_the_lock_says_the_same():
    """All words come back from scene.lock.txt."""
    scene = parse_scene(plate(ALL) + "control { time 0.4 s }\n")
    again = parse_scene(lock_text(scene, {}))
    assert again.solids[0].drive == scene.solids[0].drive and again.solids[0].key_points == scene.solids[0].key_points


# --- what it does -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("shape", "elasticity", "frequency"), [
    ("sphere 4 cm", "1 MPa", 2.0), ("box (6, 6, 6) cm", "300 kPa", 5.0), ("box (6, 6, 6) cm", "rigid", 5.0),
    ("sphere 4 cm", "rigid", 3.0),
])  # fmt: skip
def test_what_lies_on_a_shaking_plate_leaves_it_at_g(shape, elasticity, frequency):
    """Amplitude (2 pi f)^2 = g, within 2 per cent: just below it presses on the plate at all times, above it lifts off. All are
    stiff beside their weight, so they follow the plate: the elastic ball gives way by 0.44 mm, and a mass on a spring of Hertz
    that does, by its equation of motion, leaves at 0.988 g at 2 Hz (here: 0.995 g), at 0.977 g at 3 Hz (0.983 g)."""
    assert stays(0.98, shape, elasticity, frequency) and not stays(1.02, shape, elasticity, frequency)


@pytest.mark.parametrize("elasticity", ["1 MPa", "rigid"])
@pytest.mark.parametrize(("speed", "friction"), [(0.4, 0.3), (0.8, 0.5)])
def test_a_block_on_a_belt_slips_and_then_rides(prepared, speed, friction, elasticity):
    """A plate that runs at v below a block: it slips for v/(mu g), within a per cent, then rides; the work of the drive is
    m v^2, half of it heat, and the momentum that the block gets is the impulse."""
    more = f"density 500 elasticity {elasticity} friction {friction}"
    block = f"object block {{ shape box (8, 8, 4) cm position (0, 0, 2) cm {more} }}\n"
    belt = plate(f"drive velocity ({speed}, 0, 0) m/s", "(200, 20, 4) cm", f"friction {friction}")
    ready = prepared(GRAVITY + belt + block + "control { time 1 s }\n")
    slips = speed / (friction * G)
    mass = ready.system.mass_of[1]

    def watch(instance):
        speed_of_block = instance.system.center_of_mass(instance.array("v"))[1, 0]
        return speed_of_block, energies(instance, instance.system.center_of_mass(instance.array("x")))

    begins, *others = followed(ready, [1e-9, 0.5 * slips, 2.0 * slips], watch)
    (half, _), (end, ledger) = others
    assert speed * 0.5 * slips / half == pytest.approx(slips, rel=0.01)
    assert end == pytest.approx(speed, rel=0.01)
    assert ledger["work"] == pytest.approx(mass * speed**2, rel=0.01)
    assert ledger["friction_heat"] + ledger["contact_damping_loss"] == pytest.approx(0.5 * mass * speed**2, rel=0.02)
    change = sum(ledger.values()) - sum(begins[1].values())
    assert abs(change - 2.0 * ledger["work"]) < 1e-3 * mass * speed**2


@pytest.mark.parametrize("drive", [
    "drive turn (0, 0, 9) rad/s", "drive oscillation (3, 0, 1) cm frequency 2 Hz",
    "key 0.2 s at (5, 0, 3) cm axis (0, 1, 0) angle 10 deg",
])  # fmt: skip
def test_the_ledger_closes_with_the_work(prepared, drive):
    """Turntable, shaker, path: two boxes on a plate, with friction and dashpots, and on one of which the lower face is driven."""
    for hold, material in (("all", "300 kPa damping 0.1"), ("face -z", "300 kPa damping 0.1"), ("all", "rigid")):
        boxes = "".join(
            f"object box[{n}] {{ shape box (6, 6, 6) cm position ({x}, 5, 3.01) cm density 500 elasticity {material} }}\n"
            for n, x in enumerate((-8, 6))
        )
        text = (
            GRAVITY
            + plate(drive).replace("hold all", f"hold {hold}")
            + boxes
            + "control { time 0.2 s friction 0.4 resolution 2 cm }\n"
        )
        ready = prepared(text)

        def watch(instance):
            return energies(instance, instance.system.center_of_mass(instance.array("x")))

        first, last = followed(ready, [1e-9, 0.2], watch)
        change = sum(last[k] - first[k] for k in last if k != "work")
        assert abs(last["work"]) > 0.005
        in_play = sum(abs(last[k] - first[k]) for k in last)
        assert abs(change - (last["work"] - first["work"])) < 1e-3 * in_play


BASIN = "liquid water { basin from (-30, -20, 0) cm to (30, 20, 40) cm density 1000 kg/m^3 level 20 cm }\n"


def ledger_of(instance):
    return energies(instance, instance.system.center_of_mass(instance.array("x")))


def test_what_dives_on_a_path_displaces_the_liquid(prepared):
    """A held cube that goes down: the level rises by its volume over the area, and the work is that of Archimedes' lift, less its
    weight, with what waves and drag take. Waves still run then, so the level is a mean."""
    side, times = 0.12, np.arange(2.0, 6.0, 0.05)
    cube = "object cube { shape box (12, 12, 12) cm position (0, 0, 30) cm density 500 elasticity 1 MPa hold all\n"
    ready = prepared(GRAVITY + BASIN + cube + "  key 1.5 s at (0, 0, 10) cm\n}\ncontrol { time 6 s resolution 2 cm }\n")
    first, *later = followed(ready, [1e-9, *times], lambda instance: (ledger_of(instance), instance.fix_value("liquid", "level")))
    last = later[-1]
    assert np.mean([level for _, level in later]) - first[1] == pytest.approx(side**3 / (0.6 * 0.4), rel=0.03)
    work = last[0]["work"] - first[0]["work"]
    lifting = work + 500 * side**3 * G * 0.2
    rise = side**3 / (0.6 * 0.4)
    diving, under = side - rise, 0.2 + rise - side - 0.04  # ways of the lower face until it is under, and from then on
    lift = 1000 * G * side**2 * (0.5 * side * diving + side * under)
    assert lift < lifting < 1.08 * lift
    change = sum(last[0][k] - first[0][k] for k in last[0] if k != "work")
    assert abs(change - work) < 1e-3 * sum(abs(last[0][k] - first[0][k]) for k in last[0])


def test_what_is_driven_off_at_a_frame_beside_a_liquid_at_rest(tmp_path):
    """Nothing else is in play at the frame in which a lid starts, and the account of its first step is not yet even."""
    lid = "object lid { shape box (20, 20, 20) cm position (0, 0, 20) cm density 500 elasticity rigid hold all\n"
    keys = "  key 0.04 s at (0, 0, 20) cm\n  key 0.08 s at (0, 0, 30) cm\n}\n"
    text = GRAVITY + BASIN + lid + keys + "control { time 0.08 s frames 50 fps resolution 4 cm }\n"
    run = Scene(parse_scene(text)).run(tmp_path / "out", movie=False)
    assert run.ledger.residual < 1e-3


@pytest.mark.parametrize("model", ["waves", "surface"])
def test_a_paddle_makes_waves_and_the_ledger_closes(prepared, model):
    """A plate that swings in the basin: waves have energy, and what they and drag have taken is the work of the drive."""
    basin = BASIN.replace(" level", f" model {model} level")
    blade = "object blade { shape box (4, 30, 20) cm position (0, 0, 14) cm density 1000 elasticity 1 MPa hold all\n"
    swing = "  drive oscillation (6, 0, 0) cm frequency 1 Hz phase 90 deg\n}\n"
    ready = prepared(GRAVITY + basin + blade + swing + "control { time 1 s resolution 2 cm }\n")

    def watch(instance):
        return ledger_of(instance), instance.fix_value("liquid", "crest")

    (first, _), *middle, (last, _) = followed(ready, [1e-9, 0.4, 0.7, 1.0], watch)
    change, work = sum(last[k] - first[k] for k in last if k != "work"), last["work"] - first["work"]
    assert abs(change - work) < 1e-3 * sum(abs(last[k] - first[k]) for k in last)
    assert work > 0.02
    if model == "waves":
        assert max(found["waves"] for found, _ in middle) > 0.02 and max(crest for _, crest in middle) > 0.205


@pytest.mark.parametrize(("elasticity", "model"), [("rigid", "surface"), ("1 MPa", "surface"), ("1 MPa", "paper")])
def test_driven_objects_go_through_planes(prepared, elasticity, model):
    """A plate that is driven into the ground neither gives way nor is pushed, whatever it is made of; what lies there is."""
    block = (
        "object block { shape box (6, 6, 6) cm position (0, 40, 4) cm density 500 elasticity 1 MPa velocity (0, 0, -1) m/s }\n"
    )
    down = plate("drive velocity (0, 0, -0.5) m/s").replace("elasticity 1 MPa", f"elasticity {elasticity}")
    text = "ground z -5 cm\n" + down + block + f"control {{ time 0.2 s contact-model {model} }}\n"
    ready = prepared(text)
    most = followed(ready, [0.12, 0.2], lambda i: (abs(ledger_of(i)["work"]), i.array("v")[-1, 2]))
    assert max(work for work, _ in most) == 0.0 and most[-1][1] > 0.5


def test_what_is_driven_is_not_a_load(prepared):
    """A plate that is driven above a ball does not weigh on it, and bears loads itself without one of its own."""
    lid = plate("drive velocity (0.1, 0, 0) m/s").replace("object plate", "object lid").replace("(0, 0, -2) cm", "(0, 0, 30) cm")
    ball = "object ball { shape sphere 4 cm position (0, 0, 4) cm density 700 elasticity rigid }\n"
    system = prepared(GRAVITY + plate("drive velocity (0.1, 0, 0) m/s") + ball + lid + "control { time 0.1 s }\n").system
    with np.errstate(all="raise"):
        found = loads(system, np.arange(3), np.arange(3))
    np.testing.assert_allclose(found, [1.0 + system.mass_of[1] / system.mass_of[0], 1.0, 1.0])


def test_driven_objects_go_through_held_ones(prepared):
    """Neither of two that are held gives way, so nothing acts between blades of a wheel that begin in each other and a post that
    they pass; plates that are driven alike and apart are not named at all."""
    blades = "".join(
        f"object blade[{n}] {{ shape box (30, 8, 4) cm position (0, 0, 20) cm orientation axis (0, 1, 0) angle {90 * n} deg "
        "density 500 elasticity 1 MPa hold all drive turn (0, 9, 0) rad/s }\n"
        for n in range(2)
    )
    post = "object post { shape box (4, 8, 20) cm position (12, 0, 5) cm density 500 elasticity 1 MPa hold all }\n"
    belts = "".join(
        f"object belt[{n}] {{ shape box (10, 10, 2) cm position ({40 + 11 * n}, 0, 0) cm density 500 elasticity 1 MPa hold all "
        "drive velocity (1, 0, 0) m/s }\n"
        for n in range(3)
    )
    ball = "object ball { shape sphere 4 cm position (40, 0, 5) cm density 700 elasticity 300 kPa }\n"
    ready = prepared(GRAVITY + blades + post + belts + ball + "control { time 0.3 s }\n")
    assert motion.passing(ready.scene) == [(0, 1), (0, 2), (1, 2)]
    ((found, deepest),) = followed(ready, [0.3], lambda i: (ledger_of(i), i.fix_value("contact", "deepest")))
    assert abs(found["work"]) < 0.5 and deepest < 0.01


def test_too_many_that_go_through_each_other_are_refused(monkeypatch):
    """At the word that drives one of them, with the limit and a way out; plates that are driven alike and apart do not count."""
    monkeypatch.setattr(motion, "MOST_PASSING", 45)
    belts, wheels = (
        [
            plate(f"drive {way}", "(4, 4, 4) cm").replace("plate", f"plate[{n}]").replace("(0, 0, -2)", f"({5 * n}, 0, 0)")
            for n in range(11)
        ]
        for way in ("velocity (1, 0, 0) m/s", "turn (0, 0, 1) rad/s about (0, 0, 0) m")
    )
    end = "control { time 1 s }\n"
    assert motion.passing(parse_scene("".join(belts) + end)) == []
    assert len(motion.passing(parse_scene("".join(wheels[1:]) + end))) == 45
    with pytest.raises(SceneError) as e:
        prepare(parse_scene("".join(wheels) + end))
    (problem,) = e.value.problems
    assert problem.message == "more than 45 pairs of driven and held objects go through each other"
    assert "fewer" in problem.hint and problem.span.line == 2


# --- words ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("text", "told", "way_out"), [
    (plate("drive velocity (1, 0, 0) m/s").replace("hold all", ""), "nothing of plate is held", "hold all"),
    (plate("key 1 s at (0, 0, 0) m").replace("hold all", ""), "nothing of plate is held", "hold face"),
    (plate("drive turn (0, 0, 1) rad/s  drive turn (0, 0, 1) rad/s about (1, 0, 0) m"),
     "plate turns about (0, 0, -0.02) m and about (1, 0, 0) m; turns are about one point", "the same point"),
    (plate("drive oscillation (0, 0, 1) cm frequency 0 Hz"), "the frequency of a drive must be > 0, found 0 Hz", "e.g."),
    (plate("key 2 s at (0, 0, 0) m  key 1 s at (0, 0, 1) m"), "the times of keys must rise, found 1 s after 2 s", "order"),
    (plate("key -2 s at (0, 0, 0) m"), "the time of a key must be >= 0, found -2 s", "begins at 0 s"),
    (plate("key 1e-300 s at (0, 0, 1) m"), "at least 1e-6 s after the start and after the one before, found 1e-300 s after 0 s",
     "write the key later"),
    (plate("key 0.5 s at (0, 0, 1) m  key 0.5000005 s at (0, 0, 0) m"), "found 5e-7 s after 0.5 s", "or leave it out"),
    (plate("key 0 s at (0, 0, 1) m"), "at its position (0, 0, -0.02) m, and this key has it at (0, 0, 1) m", "leave"),
    (plate("key 1 s at (0, 0, 1) m axis (0, 0, 0) angle 1 rad"), "the axis of a key needs a direction, found (0, 0, 0)", "axis"),
])  # fmt: skip
def test_refusals(text, told, way_out):
    """With its place, cause, value and way out."""
    with pytest.raises(SceneError) as e:
        prepare(parse_scene(text + "control { time 3 s }\n"))
    (problem,) = e.value.problems
    assert told in problem.message and way_out in problem.hint and problem.span.line == 2
    assert re.match(r".*:2:\d+", str(problem.span))


def test_a_drive_without_hold_is_told_with_all_else():
    """In the same pass as what is wrong elsewhere in the text."""
    loose = plate("drive velocity (1, 0, 0) m/s").replace("hold all", "")
    wrong = "object it { shape sphere 4 cm position (0, 0, 1) m density -1 elasticity 1 MPa }\n"
    with pytest.raises(SceneError) as e:
        parse_scene(loose + loose.replace("plate", "other").replace("drive velocity (1, 0, 0) m/s", "release 1 s") + wrong)
    told = [problem.message for problem in e.value.problems]
    assert sum("is held, so nothing of it can be driven or released" in message for message in told) == 2
    assert any("density" in message for message in told)


@pytest.mark.parametrize(("drive", "most"), [
    ("drive oscillation (0, 0, 1) mm frequency 1000 Hz", 1.0 / 40e3),
    ("drive turn (0, 600, 800) rad/s", 2 * math.pi / 1000.0 / 40.0),
    ("key 0.1 s at (0, 0, -2) cm axis (1, 0, 1) angle 1e3 rad", 2 * math.pi / (1.5 * 1e3 / 0.1) / 40.0),
    ("key 1 ms at (0, 0, -1.99) cm  key 50 ms at (0, 0, -2) cm", 1e-3 / 20.0),
])  # fmt: skip
def test_steps_resolve_the_quickest(prepared, drive, most):
    """At least 40 steps in a period, 40 in a turn at the largest rate (between two keys 3/2 of the mean one), and 20 between two
    keys; not many more where nothing else asks for them."""
    ready = prepared(plate(drive).replace("elasticity 1 MPa", "elasticity rigid") + "control { time 0.1 s }\n")
    assert most / 1.2 <= ready.certificate.timestep <= most
