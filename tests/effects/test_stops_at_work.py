# SPDX-License-Identifier: GPL-2.0-only
"""Stops and motors of joints in scenes, at the defaults of the language."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import RefusedError, SceneError
from mdanim_lammps.features.joints.rows import GAP, NUMBER, RATE, WAY
from mdanim_lammps.run.energy import energies, tell

SLIDER = """object o {{ shape box ({a}, {b}, {b}) m position (0, 0, 1.5) m density {density} elasticity rigid
  velocity (2, 0, 0) m/s }}
joint slider o world {{ axis (1, 0, 0) limits -1 cm to 60 cm {more} }}
control {{ time 1 s }}
"""
HINGE = """object o {{ shape {shape} position ({x}, 0, 1.5) m orientation axis (1, 0, 0) angle {angle} deg density {density}
  elasticity rigid  spin (0, 2, 0) rad/s  velocity (0, 0, -2*{x}) m/s }}
joint hinge o world {{ at (0, 0, 1.5) m axis (0, 1, 0) limits -1 deg to 60 deg {more} }}
control {{ time 1 s }}
"""


def watched(ready, seconds, looks=150):
    """Times, rows of the first joint, and all energies together."""
    times, rows, sums, dt = [], [], [], ready.certificate.timestep
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(looks + 1):
            told = tell(instance)["joint"]["value"]
            rows.append(told[np.argsort(told[:, NUMBER])][0])
            energy = energies(instance, ready.system.center_of_mass(instance.array("x")))
            sums.append(sum(-v if k == "work" else v for k, v in energy.items()))
            times.append(instance.step * dt)
            instance.run(max(1, round(seconds / dt / looks)))
    return np.array(times), np.array(rows), np.array(sums)


def comes_back(ready, seconds) -> float:
    """Mean speed after the stop over that before it: between, the joint rings."""
    times, rows, _ = watched(ready, seconds)
    way, top = rows[:, WAY], int(rows[:, WAY].argmax())
    after = slice(top + (len(way) - top) // 3, None)
    return float(-np.polyfit(times[after], way[after], 1)[0] / rows[1, RATE])


@pytest.mark.parametrize(("e", "left"), [("", 0.135), ("restitution 0.3", 0.3), ("restitution 0.5", 0.5), ("restitution 1", 1.0)])
@pytest.mark.parametrize(("a", "b", "density"), [(0.2, 0.1, 700), (0.05, 0.03, 7800)])
def test_what_slides_comes_back_with_its_part(prepared, a, b, density, e, left):
    """Nothing but the stop gives way: critical damping leaves exp(-2)."""
    found = comes_back(prepared(SLIDER.format(a=a, b=b, density=density, more=e)), 0.4)
    assert found == pytest.approx(left, abs=0.02)


@pytest.mark.parametrize(
    ("shape", "x", "angle"), [("cylinder 10 cm 6 cm", 0.0, 90), ("box (100, 4, 4) cm", 0.5, 0), ("box (20, 4, 10) cm", 0.1, 0)]
)
@pytest.mark.parametrize(("e", "left"), [("", 0.135), ("restitution 0.5", 0.5), ("restitution 0.9", 0.9)])
def test_what_turns_comes_back_with_its_part(prepared, shape, x, angle, e, left):
    """The hinge springs too, and gives a part of the blow of the dashpot back; it was up to 0.36 without restitution."""
    found = comes_back(prepared(HINGE.format(shape=shape, x=x, angle=angle, density=900, more=e)), 0.7)
    assert found == pytest.approx(left, abs=0.05)


WELDED = """object w {{ shape box (0.1, 0.1, 0.1) m position ({x}, 0, 1.5) m density {density} elasticity rigid
  velocity (2, 0, 0) m/s }}
joint weld w o {{ }}
"""
WEIGHTED = """object w {{ shape box (10, 10, 10) cm position (0.95, 0, 1.57) m density {density} elasticity rigid
  spin (0, 2, 0) rad/s velocity (0.14, 0, -1.9) m/s }}
joint weld w o {{ }}
"""


@pytest.mark.parametrize(("e", "left"), [("", 0.135), ("restitution 0.5", 0.5), ("restitution 0.9", 0.9)])
@pytest.mark.parametrize("ratio", [0.1, 1, 10])
def test_what_is_welded_to_a_slider_stops_with_it(prepared, ratio, e, left):
    """The stop counted the mass of the slider alone: a weight ten times as heavy came back with 0.57 without restitution."""
    text = SLIDER.format(a=0.1, b=0.1, density=700, more=e) + WELDED.format(x=0.1, density=700 * ratio)
    assert comes_back(prepared(text), 0.6) == pytest.approx(left, abs=0.05)


@pytest.mark.parametrize(("e", "left"), [("", 0.135), ("restitution 0.5", 0.5)])
@pytest.mark.parametrize("density", [700, 7000])
def test_what_is_welded_to_an_arm_stops_with_it(prepared, density, e, left):
    """The arm with 7 kg at its end came back with 0.94 where 0.5 was asked."""
    text = HINGE.format(shape="box (100, 4, 4) cm", x=0.5, angle=0, density=900, more=e) + WEIGHTED.format(density=density)
    assert comes_back(prepared(text), 0.7) == pytest.approx(left, abs=0.05)


RAIL = """object p { shape box (0.4, 0.1, 0.1) m position (0, 0.2, 1.5) m density 700 elasticity rigid }
"""
COUNTERWEIGHT = """object q { shape box (0.1, 0.1, 0.1) m position (0, 0.3, 1.5) m density 7000 elasticity rigid }
joint weld q p { }
"""


@pytest.mark.parametrize(("e", "left"), [("", 0.135), ("restitution 0.5", 0.5)])
@pytest.mark.parametrize(
    "more", [RAIL, RAIL + COUNTERWEIGHT, RAIL + "joint weld p world { }\n"], ids=["free", "weighted", "at the world"]
)
def test_what_is_welded_to_the_rail_counts_too(prepared, more, e, left):
    """Both ends; a weld to the world makes one that does not move."""
    text = SLIDER.format(a=0.1, b=0.1, density=700, more=e).replace("slider o world {", "slider o p { at (0, 0, 1.5) m")
    assert comes_back(prepared(text + more), 0.6) == pytest.approx(left, abs=0.05)


def test_a_weight_beside_the_way_of_a_slider_stops_with_it(prepared):
    """It turns the slider in its springs; it came back with 0.8."""
    text = SLIDER.format(a=0.1, b=0.1, density=700, more="restitution 0.5") + WELDED.format(x=0, density=2100)
    text = text.replace("position (0, 0, 1.5) m density 2100", "position (0, 0, 1.7) m density 2100")
    assert comes_back(prepared(text), 0.6) == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("weld", ["joint weld o world { }", RAIL + "joint weld p world { }\njoint weld o p { }"])
def test_stops_of_what_is_welded_fast_do_nothing(prepared, weld):
    """No motion is left, so none has a mobility."""
    ready = prepared(SLIDER.format(a=0.1, b=0.1, density=700, more="").replace("velocity (2, 0, 0) m/s", "") + weld + "\n")
    _, rows, sums = watched(ready, 0.05, 10)
    assert np.abs(rows[:, WAY]).max() < 1e-12 and np.ptp(sums) < 1e-12


def test_restitution_needs_limits(prepared):
    """It is that of stops."""
    with pytest.raises(SceneError, match="has a restitution and no limits"):
        prepared(SLIDER.format(a=0.2, b=0.1, density=700, more="restitution 0.5").replace("limits -1 cm to 60 cm", ""))


ROD = """gravity (0, 0, -9.81) m/s^2
object rod {{ shape box ({length}, {wide}, {wide}) m density 700 position ({length}/2, 0, 10) m elasticity rigid }}
joint hinge rod world {{ at (0, 0, 10) m axis (0, 1, 0) motor speed {speed} rad/s }}
control {{ time 1 s }}
"""


@pytest.mark.parametrize(("length", "wide", "speed"), [(1.0, 0.04, 6.3), (0.1, 0.01, 20.0), (3.0, 0.1, -2.0)])
def test_a_motor_without_limit_starts_as_hard_as_its_joint_bears(prepared, length, wide, speed):
    """The joint opens by no more than 0.0125 of the thickness: twice the gap of its expected load, because acceleration begins at
    once, and a quarter of that for the weight; it was more than a tenth. The motor has its speed after a tenth of a turn, and the
    books close."""
    ready = prepared(ROD.format(length=length, wide=wide, speed=speed))
    _, rows, sums = watched(ready, 3.0 / abs(speed))
    assert rows[:, GAP].max() < 0.0125 * wide
    turned = int(np.argmax(np.abs(rows[:, WAY]) > 0.63))
    assert rows[turned:, RATE] == pytest.approx(speed, rel=0.02)
    assert np.ptp(sums) < 1e-3 * ready.system.mass_of[0] * 9.81 * length


@pytest.mark.parametrize("turns", [True, False])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_motor_without_limit_goes_to_the_stops_and_stays(prepared, turns, sign):
    """It went through, by the whole way of its speed; the stop gives way by little of it, and the books close."""
    kind, speed, end = ("hinge", f"{2 * sign} rad/s", "1 rad") if turns else ("slider", f"{0.5 * sign} m/s", "20 cm")
    door = "object door { shape box (40, 4, 80) cm position (0.2, 0, 1) m density 600 elasticity rigid }\n"
    text = f"joint {kind} door world {{ at (0, 0, 1) m axis (0, 0, 1) motor speed {speed} limits -{end} to {end} }}\n"
    ready = prepared(door + text + "control { time 1 s }\n")
    _, rows, sums = watched(ready, 1.0, 40)
    most = 1.0 if turns else 0.2
    assert np.abs(rows[:, WAY]).max() < 1.03 * most
    assert rows[-4:, WAY] * sign == pytest.approx(most, rel=2e-3)
    assert np.ptp(sums) < 1e-3 * ready.system.mass_of[0] * 0.5**2


def test_a_motor_without_limit_knows_what_is_welded_on(prepared):
    """Rod of 1.1 kg with 5.6 kg at its end: the hinge bears the force that starts both."""
    weight = "object w { shape box (20, 20, 20) cm density 700 position (1, 0, 10) m elasticity rigid }\njoint weld w rod { }\n"
    ready = prepared(ROD.format(length=1.0, wide=0.04, speed=6.3) + weight)
    _, rows, sums = watched(ready, 0.5)
    assert rows[:, GAP].max() < 0.0125 * 0.04
    assert np.ptp(sums) < 1e-3 * ready.system.mass_of.sum() * 9.81


def test_a_heavy_block_on_a_long_soft_slider_is_refused(prepared):
    """The rail would open by more than its thickness, and turn over."""
    text = """gravity (0, 0, -9.81) m/s^2
object rail { shape box (15, 15, 15) cm position (0, 0, 1) m density 300 elasticity 1 MPa hold face -x }
object block { shape box (20, 20, 20) cm position (10, 0, 100) cm density DENSITY elasticity rigid }
joint slider block rail { at (0, 0, 1) m axis (1, 0, 0) limits -5 cm to 30 cm }
control { time 1 s }
"""
    lighter = prepared(text.replace("DENSITY", "300"))
    assert next(m.severity for m in lighter.certificate.margins if m.name == "joint gap") == "warning"
    with pytest.raises(RefusedError, match=r"joint slider block rail opens by .* at the end of its way"):
        prepared(text.replace("DENSITY", "7800"))
    assert prepared(text.replace("DENSITY", "7800"), insist=True).certificate.steps > 0


def test_a_ball_that_bears_much_is_not_refused(prepared):
    """A ball joint turns nothing over, however far it opens."""
    text = """gravity (0, 0, -9.81) m/s^2
object bar { shape box (4, 4, 30) cm position (0, 0, 1.65) m density 1000 elasticity 20 kPa hold face +z }
object weight { shape sphere 12 cm position (0, 0, 1.5) m density 7800 elasticity rigid }
joint ball bar weight { at (0, 0, 1.5) m }
control { time 0.1 s }
"""
    gap = next(m for m in prepared(text).certificate.margins if m.name == "joint gap")
    assert gap.value > 0.04 and gap.severity == "warning"
