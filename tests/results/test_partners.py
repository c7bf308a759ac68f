# SPDX-License-Identifier: GPL-2.0-only
"""Force between two things that touch, stress, work and flow, each against a closed form."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import SceneError

G = 9.81
STACK = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
walls from (-1, -1, 0) m to (1, 1, 2) m
object low  { shape box (10, 10, 10) cm  position (0, 0, 5) cm  mass 3 kg  elasticity rigid }
object mid  { shape box (10, 10, 10) cm  position (0, 0, 15) cm  mass 2 kg  elasticity rigid }
object top  { shape box (10, 10, 10) cm  position (0, 0, 25) cm  mass 1 kg  elasticity rigid }
object post { shape box (10, 10, 10) cm  position (0.5, 0, 0.05) m  mass 1 kg  elasticity rigid  hold all }
object lid  { shape box (10, 10, 10) cm  position (0.5, 0, 0.15) m  mass 1 kg  elasticity rigid }
object left  { shape box (10, 10, 10) cm  position (-0.6, 0, 0.05) m  mass 1 kg  elasticity rigid }
object right { shape box (10, 10, 10) cm  position (-0.5, 0, 0.05) m  mass 1 kg  elasticity rigid }
control { time 0.12 s  frames 25 fps  friction 0.5 }
record top.contact.z(mid)
record mid.contact.z(low)
record low.contact.z(mid)
record low.contact.z(ground)
record low.contact.z(walls)
record top.contact(lid)
record post.contact.z(lid)
record left.contact(right)
"""


def test_force_between_two_of_a_stack(tmp_path):
    """Each bears what lies on it; the ground bears all; what is held gets the opposite; a ring over the ground is not told."""
    run = Scene.from_text(STACK, "stack").run(tmp_path / "r")
    last = {name: run.records[name][-1] for name in run.records}
    assert last["top.contact.z(mid)"] == pytest.approx(1 * G, rel=2e-3)
    assert last["mid.contact.z(low)"] == pytest.approx(3 * G, rel=2e-3)
    assert last["low.contact.z(ground)"] == pytest.approx(6 * G, rel=2e-3)
    assert last["post.contact.z(lid)"] == pytest.approx(-G, rel=2e-3)
    assert last["top.contact(lid)"] == last["low.contact.z(walls)"] == 0.0
    np.testing.assert_array_equal(run.records["low.contact.z(mid)"], -run.records["mid.contact.z(low)"])
    assert np.isnan(last["left.contact(right)"])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("record top.contact(ceiling)", "no object is called ceiling"),
        ("record top.contact(top)", "and itself is 0"),
        ("record world.contact.z(top)", "world.contact.z has nothing in brackets"),
        ("record top.contact(walls", "a ) is missing"),
        ("record post.contact.z", "the force of contact on post is not known"),
        ("record post.contact.z(ground)", "the force of contact on post is not known"),
    ],
)
def test_a_partner_that_there_is_not(line, message):
    """Is refused, with the names that there are."""
    with pytest.raises(SceneError, match=message.replace("(", r"\(").replace(")", r"\)")):
        _ = Scene.from_text(STACK + line + "\n", "stack").certificate


COLUMN = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object column { shape box (20, 20, 40) cm  position (0, 0, 0.2) m  mass 5 kg  elasticity 1 MPa  damping 1 }
object load   { shape box (20, 20, 10) cm  position (0, 0, 0.45) m  mass 10 kg  elasticity rigid }
control { time 0.5 s  frames 10 fps  resolution 10 cm  friction 0.5 }
record column.stress.z
record column.stress.x
record column.stress.max
"""


def test_stress_of_a_column(tmp_path):
    """Its mean is the load and half of its own weight over its section, F/A; across it is small, the largest is above it."""
    run = Scene.from_text(COLUMN, "column").run(tmp_path / "r")
    mean = (10.0 + 2.5) * G / 0.04
    assert run.records["column.stress.z"][-1] == pytest.approx(-mean, rel=5e-3)
    assert abs(run.records["column.stress.x"][-1]) < 0.1 * mean
    assert mean < run.records["column.stress.max"][-1] < 4.0 * mean


MOTOR = """
object wheel { shape cylinder 20 cm 5 cm  position (0, 0, 0) m  mass 2 kg  elasticity rigid }
joint hinge wheel world { axis (0, 0, 1)  motor speed 20 rad/s torque 0.2 N*m }
control { time 0.5 s  frames 20 fps }
record wheel.joint.drive(world)
record wheel.joint.power(world)
record wheel.spin.z
record energy.work
record energy.power
"""


def test_power_of_a_motor(tmp_path):
    """M w, and its work is the energy of the wheel, I w^2/2."""
    records = Scene.from_text(MOTOR, "motor").run(tmp_path / "r").records
    spin = records["wheel.spin.z"]
    np.testing.assert_allclose(records["wheel.joint.drive(world)"], 0.2)
    np.testing.assert_allclose(records["wheel.joint.power(world)"][1:], 0.2 * spin[1:], rtol=0.02)
    np.testing.assert_allclose(records["energy.work"], 0.5 * (0.5 * 2 * 0.2**2) * spin**2, rtol=1e-3, atol=1e-6)
    np.testing.assert_allclose(records["energy.power"][1:], 0.2 * 0.5 * (spin[1:] + spin[:-1]), rtol=2e-3)


DAM = """
gravity (0, 0, -9.81) m/s^2
liquid water {
  basin   from (-1, -0.1, 0) m to (1, 0.1, 0.8) m
  density 1000 kg/m^3
  fill    from (-1, -0.1, 0) m to (0, 0.1, 0.8) m
  level   0.4 m
}
control { time 0.3 s  frames 50 fps  resolution 4 cm }
record liquid.flow.x(0 m)
record liquid.flow.y(0 m)
"""


def test_flow_of_a_dam(tmp_path):
    """Ritter: 8/27 h sqrt(g h) for each metre of the dam, by the theory of shallow water; nothing goes across it."""
    records = Scene.from_text(DAM, "dam").run(tmp_path / "r").records
    flow = records["liquid.flow.x(0 m)"]
    assert np.mean(flow[6:]) == pytest.approx(8 / 27 * 0.4 * np.sqrt(G * 0.4) * 0.2, rel=0.1)
    np.testing.assert_allclose(records["liquid.flow.y(0 m)"][1:], 0.0, atol=1e-6)
    with pytest.raises(SceneError, match="the plane at 3 m lies outside the basin"):
        _ = Scene.from_text(DAM + "record liquid.flow.x(3 m)\n", "dam").certificate
    fed = DAM.replace("level   0.4 m", "level   0.4 m\n  current -x speed 20 cm/s")
    with pytest.raises(SceneError, match="waves or a current come to both"):
        _ = Scene.from_text(fed, "dam").certificate


def test_colours_tell_stress(tmp_path):
    """From 0 to a value that few exceed."""
    from mdanim_lammps.picture.tones import Tones
    from mdanim_lammps.scene.shown import ColorBy

    trajectory = Scene.from_text(COLUMN.replace("time 0.5 s", "time 0.1 s"), "column").run(tmp_path / "r").trajectory
    tones = Tones((trajectory, None), ColorBy.STRESS)
    assert tones.unit == "Pa" and 1e3 < tones.most < 1e5
    assert (tones.of_particles(1)[trajectory.metadata.object_of == 1] == 0.0).all()


def test_stress_of_a_rigid_object_is_refused():
    """It has no springs, so what is in it is not known: it is not 0."""
    brick = (
        "object brick { shape box (10, 10, 10) cm  position (0, 0, 0) m  mass 1 kg  elasticity rigid }\ncontrol { time 0.1 s }\n"
    )
    for quantity in ("stress.max", "stress.x"):
        with pytest.raises(SceneError, match="brick is rigid: its stress is not known"):
            _ = Scene.from_text(brick + f"record brick.{quantity}\n", "brick").certificate
