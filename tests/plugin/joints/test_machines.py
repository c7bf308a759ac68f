# SPDX-License-Identifier: GPL-2.0-only
"""Motors, friction, stops and joints that break, against closed forms."""

import joint_lab as lab
import numpy as np
import pytest

FREQUENCY = 1000.0
DT = 0.35 / FREQUENCY


def wheel(spin=0.0, mass=2.0):
    """A box that turns about z, and its moment of inertia."""
    size = np.array([0.4, 0.3, 0.1])
    return lab.box(size, mass, spin=(0, 0, spin)), mass * (size[0] ** 2 + size[1] ** 2) / 12.0


def on_axle(folder, words, spin=0.0, **more):
    """The wheel on a hinge to the world."""
    body, moment = wheel(spin)
    joint = f"hinge 1 world at 0 0 0 axis 0 0 1 frequency {FREQUENCY} {words}"
    return lab.World(folder, [body], [joint], DT, **{"gravity": (0, 0, 0)} | more), moment


@pytest.mark.parametrize("torque", [0.02, 0.5, 5.0])
def test_a_motor_at_its_limit_runs_up_straight(tmp_path, torque):
    """w = M t/I; the angle is half of that times t; the work what the wheel has."""
    world, moment = on_axle(tmp_path, f"motor 1000 {torque}")
    with world:
        steps = round(0.2 / DT)
        for n in range(1, 6):
            world.run(steps)
            assert world.told("rate") == pytest.approx(torque * n * steps * DT / moment, rel=2e-3)
            assert world.told("driving") == torque
        assert world.told("way") == pytest.approx(0.5 * torque * (5 * steps * DT) ** 2 / moment, rel=2e-3)
        assert world.number("work") == pytest.approx(0.5 * moment * world.told("rate") ** 2 + world.number("joints"), rel=1e-3)


@pytest.mark.parametrize("limit", ["none", "2.0"])
@pytest.mark.parametrize("load", [0.0, 0.5])
def test_a_motor_keeps_its_speed(tmp_path, limit, load):
    """60 rpm, whatever it carries below its limit: a weight on a rope here, friction of another joint."""
    speed = 2.0 * np.pi
    world, moment = on_axle(tmp_path, f"motor {speed!r} {limit} friction {load}")
    with world:
        world.run(round(1.0 / DT))
        start, work = world.told("way"), world.number("work")
        world.run(round(2.0 / DT))
        assert world.told("rate") == pytest.approx(speed, rel=1e-3)
        assert world.told("way") - start == pytest.approx(speed * round(2.0 / DT) * DT, rel=1e-4)
        assert world.number("work") - work == pytest.approx(load * 2.0 * speed, rel=1e-3, abs=1e-6)
        # Without a limit the motor begins with a blow F = 2 frequency w/(1 + frequency dt) m 0.4^2/12 by the longest side of the
        # wheel: energies of whole steps leave out dt^2 F^2/8 I of its first half.
        blow = 0.5 * moment * speed**2 * (0.35 / 1.35 * 0.4**2 / (0.4**2 + 0.3**2)) ** 2 if limit == "none" else 0.0
        assert world.energy() == pytest.approx(-blow, abs=2e-3 * moment * speed**2)


@pytest.mark.parametrize(("spin", "friction"), [(3.0, 0.1), (-20.0, 0.5)])
def test_friction_stops_a_wheel(tmp_path, spin, friction):
    """After I w/M and I w^2/2M; then it stands still, and all is heat."""
    world, moment = on_axle(tmp_path, f"friction {friction}", spin)
    with world:
        time = moment * abs(spin) / friction
        half = round(0.5 * time / DT)
        world.run(half)
        assert world.told("rate") == pytest.approx(spin * (1.0 - half * DT / time), rel=5e-3)
        world.run(half + round(0.1 / DT))
        way = world.told("way")
        assert way == pytest.approx(np.sign(spin) * 0.5 * moment * spin**2 / friction, rel=5e-3)
        assert world.number("joint_heat") == pytest.approx(0.5 * moment * spin**2, rel=2e-3)
        world.run(round(1.0 / DT))
        assert abs(world.told("rate")) < 1e-6 and world.told("way") == pytest.approx(way, abs=1e-6)


@pytest.mark.parametrize("share", [0.9, 1.2])
def test_friction_holds_a_pendulum_or_does_not(tmp_path, share):
    """A box on a hinge beside it, with friction below or above the torque of its weight: it stands, without a creep, or falls."""
    body = lab.box((0.2, 0.1, 0.1), 1.0, at=(0.1, 0, 0))
    joint = f"hinge 1 world at 0 0 0 axis 0 1 0 frequency {FREQUENCY} friction {share * 9.81 * 0.1}"
    with lab.World(tmp_path, [body], [joint], DT) as world:
        world.run(round(0.5 / DT))
        first = world.told("way")
        world.run(round(1.0 / DT))
        if share > 1.0:
            assert world.told("way") == pytest.approx(first, abs=1e-9) and 0.0 < abs(first) < 2e-3
            assert world.told("driving") == pytest.approx(-9.81 * 0.1, rel=1e-3)
        else:
            assert world.told("way") > 0.5


def test_a_slider_slides_down_its_axis(tmp_path):
    """At g (sin - M/(m g)) along an inclined axis, with the friction M as a force."""
    angle, friction = np.radians(30), 2.0
    axis = (np.cos(angle), 0.0, -np.sin(angle))
    body = lab.box((0.2, 0.1, 0.1), 1.5)
    joint = f"slider 1 world at 0 0 0 axis {axis[0]} 0 {axis[2]} frequency {FREQUENCY} friction {friction}"
    with lab.World(tmp_path, [body], [joint], DT) as world:
        world.run(round(1.0 / DT))
        time = round(1.0 / DT) * DT
        pull = 9.81 * np.sin(angle) - friction / 1.5
        assert world.told("way") == pytest.approx(0.5 * pull * time**2, rel=2e-3)
        assert world.told("gap") == pytest.approx(1.5 * 9.81 * np.cos(angle) / (1.5 / 1.0 * FREQUENCY**2), rel=3.0)
        assert world.number("joint_heat") == pytest.approx(friction * world.told("way"), rel=2e-3)
        assert world.energy() == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("kind", ["hinge", "slider"])
def test_limits_stop_what_moves(tmp_path, kind):
    """It goes to the limit, and leans on it with its weight, by that over the stiffness of the stop."""
    body = lab.box((0.2, 0.1, 0.1), 1.0, at=(0.1, 0, 0))
    words = "at 0 0 0 axis 0 1 0" if kind == "hinge" else "at 0.1 0 0 axis 0 0 -1"
    stiffness = 4e3 if kind == "hinge" else 5e4
    joint = f"{kind} 1 world {words} frequency {FREQUENCY} limits -0.2 0.4 servo {stiffness} {4e-3 * stiffness}"
    with lab.World(tmp_path, [body], [joint], DT) as world:
        highest = 0.0
        for _ in range(100):
            world.run(round(0.01 / DT))
            highest = max(highest, world.told("way"))
        load = 9.81 * 0.1 * np.cos(0.4) if kind == "hinge" else 9.81
        assert highest < 0.42 and world.told("way") == pytest.approx(0.4 + load / stiffness, abs=1e-5)
        assert world.told("driving") == pytest.approx(-load, rel=1e-3)
        assert world.energy() == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("kind", ["ball 1 2 at 0.25 0 0", "weld 1 2 at 0.25 0 0", "spring 1 2 from 0.2 0 0 to 0.3 0 0"])
@pytest.mark.parametrize("most", [3.0, 50.0])
def test_a_joint_breaks_at_its_force(tmp_path, kind, most):
    """Under a load that rises to it in 0.4 s, a thousand times slower than the joint swings; then both go on alone."""
    bodies = [lab.box((0.2, 0.2, 0.2), 1.0, at=(0.5 * n, 0, 0)) for n in range(2)]
    holder = "weld 1 world at 0 0 0 frequency 1000 damping 100"
    rise = (f"variable pull equal {most / 0.4 / 8}*step*dt", "group second molecule 2", "fix p second addforce v_pull 0 0")
    joint = f"{kind} stiffness 2e5 damping 100 breaks {most}"
    with lab.World(tmp_path, bodies, [holder, joint], 2e-4, gravity=(0, 0, 0), commands=rise) as world:
        step = 0
        while step < 3000 and not world.told("broken", 1):
            world.run(10)
            step += 10
        assert step * 2e-4 == pytest.approx(0.4, rel=0.02)
        assert world.number("broken") == 1.0 and world.told("force", 1) == 0.0
        before = world.array("v")[8:, 0].mean()
        world.run(50)
        assert world.array("v")[8:, 0].mean() == pytest.approx(before + most * 50 * 2e-4, rel=0.03)
        assert world.number("joint_heat") > most**2 / 4e5


def test_a_weld_breaks_at_its_torque(tmp_path):
    """A box held beside its centre: m g arm, with damping that leaves no swing above."""
    for most, broken in ((0.9 * 9.81 * 0.1, 1.0), (1.1 * 9.81 * 0.1, 0.0)):
        body = lab.box((0.2, 0.1, 0.1), 1.0, at=(0.1, 0, 0))
        words = f"weld 1 world at 0 0 0 frequency 1000 damping 250 breaks-torque {most} preload 0 0 9.81 0 -0.981 0"
        with lab.World(tmp_path, [body], [words], DT) as world:
            world.run(1000)
            assert world.told("broken") == broken


@pytest.mark.parametrize("kind", ["ball", "hinge", "weld", "slider"])
def test_a_preload_is_borne_from_the_start(tmp_path, kind):
    """Force and torque of the weight beside the place: nothing moves, where without it all swings."""
    body = lab.box((0.2, 0.1, 0.1), 1.0, at=(0.1, 0, 0) if kind in ("weld", "slider") else (0, 0, -0.1))
    axis = {"hinge": "axis 1 1 0", "slider": "axis 1 0 0"}.get(kind, "")
    torque = "0 -0.981 0" if kind in ("weld", "slider") else "0 0 0"
    gaps = []
    for words in ("", f"preload 0 0 9.81 {torque}"):
        with lab.World(tmp_path, [body], [f"{kind} 1 world at 0 0 0 {axis} stiffness 1e5 {words}"], 2e-4) as world:
            start, moved = world.array("x"), 0.0
            for _ in range(50):
                world.run(7)
                moved = max(moved, np.abs(world.array("x") - start).max())
            assert world.told("force") == pytest.approx(9.81, rel=1e-6) or not words
            gaps.append(moved)
    assert gaps[0] > 1e-4 and gaps[1] < 1e-7


@pytest.mark.parametrize("turns", [20, pytest.param(100, marks=pytest.mark.soak)])
def test_a_slider_crank_does_not_drift(tmp_path, turns):
    """A crank of 0.1 at a motor, a rod of 0.3 and a piston: x = r cos(a) + sqrt(l^2 - r^2 sin^2(a)), to 1e-3 of the
    stroke, and no farther at the end."""
    crank, rod, speed = 0.1, 0.3, 20.0
    bodies = [
        lab.box((crank, 0.02, 0.02), 0.2, at=(0.5 * crank, 0, 0)),
        lab.box((rod, 0.02, 0.02), 0.2, at=(crank + 0.5 * rod, 0, 0)),
        lab.box((0.05, 0.05, 0.05), 0.2, at=(crank + rod, 0, 0)),
    ]
    frequency = 4000.0
    joints = [
        f"hinge 1 world at 0 0 0 axis 0 0 1 frequency {frequency} motor {speed} none",
        f"hinge 2 1 at {crank} 0 0 axis 0 0 1 frequency {frequency}",
        f"hinge 3 2 at {crank + rod} 0 0 axis 0 0 1 frequency {frequency}",
        f"slider 3 world at {crank + rod} 0 0 axis 1 0 0 frequency {frequency}",
    ]
    with lab.World(tmp_path, bodies, joints, 0.3 / frequency, gravity=(0, 0, 0)) as world:
        worst = []
        for _ in range(20):
            for _ in range(turns // 25 + 1):
                world.run(round((np.pi / 2 * 1.05 + 2 * np.pi) / speed / world.dt))
                a = world.told("way")
                place = crank * np.cos(a) + np.sqrt(rod**2 - crank**2 * np.sin(a) ** 2)
                worst.append(abs(world.centre(3)[0] - place) / (2 * crank))
            assert abs(world.told("way", 3) - (world.centre(3)[0] - crank - rod)) < 1e-3 * crank
        assert world.told("way") > turns * 2 * np.pi
        half = len(worst) // 2
        assert max(worst) < 1e-3 and max(worst[half:]) < 2.0 * max(worst[:half])
