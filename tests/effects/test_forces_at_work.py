# SPDX-License-Identifier: GPL-2.0-only
"""Forces and torques of scenes: what they give to objects of every kind, what the ledger tells, and what is refused."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.contact.surface import fast
from mdanim_lammps.model.inertia import tensor
from mdanim_lammps.run.energy import energies
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene

CUBE = "object cube { shape box (10, 10, 10) cm position (0, 0, 0) m density 1000 elasticity "
KINDS = {
    "soft cube": CUBE + "100 kPa",
    "hard cube": CUBE + "20 MPa",
    "rigid cube": CUBE + "rigid",
    "rigid cone": "object cube { shape cone 8 cm 20 cm position (0, 0, 0) m density 700 elasticity rigid",
    "tilted rod": "object cube { shape box (4, 4, 20) cm position (0, 0, 0) m density 2000 elasticity 1 MPa"
    " orientation axis (1, 2, 0) angle 40 deg",
}


def ledger_of(instance) -> dict:
    return energies(instance, instance.system.center_of_mass(instance.array("x")))


def moved(ready) -> tuple[np.ndarray, np.ndarray, float]:
    """Velocity and angular velocity at the end, and the largest residual of energy, over the work."""
    system = ready.system
    rows = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(ready.certificate.steps // ready.certificate.steps_per_frame):
            rows.append(ledger_of(instance))
            instance.run(ready.certificate.steps_per_frame)
        rows.append(ledger_of(instance))
        x, v = instance.array("x").copy(), instance.array("v").copy()
    totals = np.array([sum(value for name, value in row.items() if name != "work") - row["work"] for row in rows])
    most = max(abs(row["work"]) for row in rows)
    mass = system.mass
    arm = x - mass @ x / mass.sum()
    inertia = np.einsum("i,i,jk->jk", mass, (arm**2).sum(1), np.eye(3)) - np.einsum("i,ij,ik->jk", mass, arm, arm)
    spin = np.linalg.solve(inertia, np.cross(arm, mass[:, None] * v).sum(0))
    return mass @ v / mass.sum(), spin, float(np.abs(totals - totals[0]).max() / most)


@pytest.mark.parametrize("kind", KINDS)
def test_a_push_for_a_time_gives_its_impulse(prepared, kind):
    """F T/M to rounding, whatever the object is made of, and 2 F T/M of two forces; the work is the energy that it has."""
    text = KINDS[kind] + "\n  force (2, 0, -1) N from 0.0101 s to 0.0507 s  force (2, 0, -1) N from 0.02 s to 0.0606 s }\n"
    velocity, _, off = moved(prepared(text + "control { time 0.1 s }\n"))
    mass = prepared(text + "control { time 0.1 s }\n").system.mass.sum()
    np.testing.assert_allclose(velocity, 2.0 * 0.0406 * np.array([2.0, 0.0, -1.0]) / mass, rtol=1e-10, atol=1e-13)
    assert off < 1e-3


@pytest.mark.parametrize("kind", ["hard cube", "rigid cube", "rigid cone"])
def test_a_torque_spins_it_up(prepared, kind):
    """omega = T t/I about an axis of the shape, with the moment of the shape; elastic ones have that of their particles, whose
    masses are fitted to it."""
    text = KINDS[kind] + "\n  torque (0, 0, 0.02) N*m }\ncontrol { time 0.1 s }\n"
    ready = prepared(text)
    solid = ready.scene.solids[0]
    moment = tensor(solid.shape, ready.system.mass.sum(), solid.rotation)[2, 2]
    velocity, spin, off = moved(ready)
    # an elastic one is twisted at first, and swings about its shape
    off_by = 1e-4 if kind == "hard cube" else 1e-9
    np.testing.assert_allclose(spin, [0.0, 0.0, 0.02 * 0.1 / moment], rtol=off_by, atol=1e-12)
    np.testing.assert_allclose(velocity, 0.0, atol=1e-12)
    assert off < 1e-3


def test_a_part_that_is_held_takes_its_share(prepared):
    """A bar with one face held bends under a force, and swings about its place behind its window; energy and work agree."""
    text = "object bar { shape box (40, 8, 8) cm position (0, 0, 0) m density 1000 elasticity 500 kPa hold face -x damping 0.1\n"
    ready = prepared(text + "  force (0, 0, 8) N to 0.3 s }\ncontrol { time 0.6 s resolution 4 cm }\n")
    heights, rows = [], []
    end = ready.system.position[:, 0] > 0.19
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(12):
            instance.run(ready.certificate.steps // 12)
            heights.append(instance.array("x")[end, 2].mean())
            rows.append(ledger_of(instance))
    sag = 12.0 * 8.0 * 0.4**3 / (8.0 * 5e5 * 0.08**4)  # F L^3/(8 E I) of an even load; it swings to twice that at most
    assert 0.8 * sag < max(heights[:6]) < 2.2 * sag and min(heights[6:]) < -0.8 * max(heights)
    totals = np.array([sum(v for name, v in row.items() if name != "work") - row["work"] for row in rows])
    assert np.abs(totals - totals[0]).max() < 2e-3 * max(abs(row["work"]) for row in rows)


def test_reach_knows_how_far_a_force_takes_an_object(prepared):
    """Two cubes that never meet without it: contact is on where the force brings them together, off where it is too short."""
    other = "object other { shape box (10, 10, 10) cm position (1, 0, 0) m density 1000 elasticity 100 kPa }\n"
    for force, meets in (("force (2, 0, 0) N", True), ("force (2, 0, 0) N from 0.5 s to 0.501 s", False), ("", False)):
        ready = prepared(KINDS["soft cube"] + f"\n  {force} }}\n{other}control {{ time 1.5 s }}\n")
        assert ready.context.on("contact") is meets, force


def test_forces_turn_with_a_group_and_stand_in_the_lock():
    """The forces of a placed group are turned with it; the lock has their windows."""
    text = """group kit { object cube { shape box (10, 10, 10) cm position (0, 0, 0) m mass 1 kg elasticity rigid
  force (1, 0, 0) N from 0.1 s  torque (0, 1, 0) N*m to 0.2 s } }
place kit { position (0, 0, 1) m orientation axis (0, 0, 1) angle 90 deg }
control { time 1 s }
"""
    scene = parse_scene(text, "kit.txt")
    (solid,) = scene.solids
    assert solid.force[0].vector == pytest.approx((0.0, 1.0, 0.0)) and solid.torque[0].vector == pytest.approx((-1.0, 0.0, 0.0))
    again = parse_scene(lock_text(scene), "kit.lock.txt")
    assert again.solids[0].force == solid.force and again.solids[0].torque == solid.torque


@pytest.mark.parametrize(
    ("words", "place", "message", "way_out"),
    [
        ("hold all force (1, 0, 0) N", "1:103", "cube is held as a whole, so a force does not move it", "hold a part of it"),
        ("force (1, 0, 0) N from -1 s", "1:117", "a force begins at 0 s or later, found -1 s", "begins at 0 s"),
        ("torque (1, 0, 0) N*m from 2 s to 1 s", "1:127", "ends after it begins, found to 1 s and from 2 s", "the earlier time"),
        ("torque (1, 0, 0) N*m to 0 s", "1:118", "ends after it begins, found to 0 s and from 0 s", "the earlier time"),
        ("force (1, 0, 0) m", "1:100", "fx of force must be a force, found (1, 0, 0) m, a length", "N kN"),
    ],
)
def test_what_is_refused(words, place, message, way_out):
    with pytest.raises(SceneError) as refused:
        parse_scene(KINDS["soft cube"] + f" {words} }}\ncontrol {{ time 1 s }}\n", "push.txt")
    said = str(refused.value)
    assert message in said and way_out in said and f"push.txt:{place}" in said, said


def test_a_rope_is_pulled_and_not_turned():
    text = "object rope { shape rope from (0, 0, 0) m to (1, 0, 0) m thickness 1 cm density 1000 elasticity 1 MPa "
    with pytest.raises(SceneError, match="rope is a line of particles, which nothing turns about itself"):
        parse_scene(text + "torque (1, 0, 0) N*m }\ncontrol { time 1 s }\n", "rope.txt")
    assert parse_scene(text + "force (1, 0, 0) N }\ncontrol { time 1 s }\n", "rope.txt").solids[0].force


def test_a_force_that_begins_behind_the_end_is_told():
    scene = parse_scene(CUBE + "rigid force (1, 0, 0) N from 3 s }\ncontrol { time 1 s }\n", "late.txt")
    assert any("begins at 3 s, and the run ends at 1 s" in w.message for w in scene.warnings)


SLED = """gravity (0, 0, -9.81) m/s^2
ground z 0
object sled { shape box (40, 20, 10) cm  position (0, 0, 0.05) m  density 125  elasticity 300 kPa  force (12, 0, 0) N }
object load { shape box (10, 10, 10) cm  position (0, 0, 0.15) m  density 500  elasticity 300 kPa }
"""


def velocities_after(ready, seconds: float) -> np.ndarray:
    """Velocities of the centres of mass."""
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(seconds / ready.certificate.timestep))
        return ready.system.center_of_mass(instance.array("v"))


@pytest.mark.parametrize("seconds", [1.0, 3.0])
def test_friction_does_not_depend_on_how_long_the_scene_is(prepared, seconds):
    """A pushed sled takes its load along, in a scene of any length: friction was off where the force could act for long."""
    short, long = (prepared(SLED + f"control {{ time {t} s  friction 0.5 }}") for t in (0.3, seconds))
    early, late = velocities_after(short, 0.3), velocities_after(long, 0.3)
    sled, load = early[:, 0]
    along, _, up = np.array([1.0, 0.5]) @ early  # momenta: the ground gives M g t + p_z, and mu of that along itself
    assert along == pytest.approx(12.0 * 0.3 - 0.5 * (1.5 * 9.81 * 0.3 + up), rel=2e-3)
    assert load > 0.8 * sled  # it starts without weight on the sled and slips at first; it had -0.005 m/s
    np.testing.assert_allclose(late, early, atol=0.02)


def test_check_tells_the_force_that_makes_it_fast(prepared):
    """The warning counts the force until the end, and says how to end it."""
    ready = prepared(SLED + "control { time 3 s  friction 0.5 }")
    found = {m.name: m for m in ready.certificate.margins}
    for name in ("amplitude", "closing speed"):
        assert found[name].severity == "warning"
        assert "36 m/s by the force of sled" in found[name].text
        assert "write force … to T in sled" in found[name].hint
    assert found["closing speed"].span.line == 3
    assert not any("without friction" in w.message for w in ready.warnings)


@pytest.mark.parametrize(
    ("push", "speed"),
    [
        pytest.param("(30, 0, 0) N", np.sqrt(2.0 * 30.0 / 0.5 * 0.4), id="slow"),
        pytest.param("(6000, 0, 0) N", np.sqrt(2.0 * 6000.0 / 0.5 * 0.4), id="fast"),
        pytest.param("(6000, 0, 0) N to 1 ms", 6000.0 / 0.5 * 1e-3, id="a blow"),
    ],
)
def test_the_way_to_a_partner_chooses_the_barrier(prepared, push, speed):
    """The speed across 0.4 m to a target, v = sqrt(2 F s/m), or in a window, F T/m, over 0.3 c; at any time of the scene."""
    cube = "shape box (10, 10, 10) cm  density 500  elasticity 300 kPa"
    objects = f"object ball {{ {cube}  position (0, 0, 0) m  force {push} }}\nobject wall {{ {cube}  position (0.5, 0, 0) m }}\n"
    for seconds in (1.0, 5.0):
        context = prepared(objects + f"control {{ time {seconds} s  friction 0.5 }}", insist=True).plan.context
        assert context.reach.thrown_across == pytest.approx([speed, 0.0])
        assert fast(context).tolist() == 2 * [speed > 0.3 * np.sqrt(1.2 * 300e3 / 500.0)]


@pytest.mark.parametrize("push", ["torque (0, 0, 0.02) N*m", "force (0.5, 0, 0) N"])
def test_what_is_laid_aside_has_no_part(prepared, push):
    """Its forces do no work, and a torque finds nothing to turn."""
    more = (
        "control { time 0.1 s resolution 5 cm }\n" + CUBE.replace("cube", "other").replace("(0, 0, 0)", "(1, 0, 0)") + "rigid }\n"
    )
    ready = prepared(CUBE + f"100 kPa {push} }}\n" + more)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(20)
        work = instance.fix_value("force", "work")
        instance.lay_aside([0])
        instance.run(20)
        assert work > 0.0 and instance.fix_value("force", "work") == work
