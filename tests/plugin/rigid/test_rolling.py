# SPDX-License-Identifier: GPL-2.0-only
"""Rolling resistance: a torque up to the arm r times the force of the contact, against closed forms.

What rolls at v = omega R without slipping has m dv/dt = -f and I domega/dt = f R - r N, so it loses c g r/R of its speed in a
second on level ground, with c = 1/(1 + I/(m R^2)): 5/7 of a ball, 2/3 of a cylinder.
"""

import numpy as np
import pytest
import rigid_lab as lab
import rigid_meshes
from rigid_samples import G, rolled, tilted

R = 0.1
LYING = lab.about((1, 0, 0), np.pi / 2)
BODIES = {
    "ball": lab.ball(R, at=(0, 0, R)),
    "cylinder": lab.cylinder(R, 0.15, at=(0, 0, R), q=LYING),
    "ellipsoid": lab.ellipsoid((R, R, 0.07), at=(0, 0, R), q=LYING),
    "torus": lab.torus(0.07, 0.03, at=(0, 0, R), q=LYING),
}
HOSTS = {
    "plane": None,
    "box": lab.box((8, 2, 0.5), at=(0, 0, -0.25), held=True),
    "mesh": lab.mesh(*rigid_meshes.slab((8, 2), 0.5, 40), 0.5),
}


def share(body: lab.Rigid) -> float:
    """1/(1 + I/(m R^2)) about the axis on which it rolls, y in space."""
    moment = body.moments[0] if body.shape.startswith("ball") else body.moments[2]
    return 1 / (1 + moment / (body.mass * R**2))


def world(tmp_path, body, host, arm, speed=2.0, **more) -> lab.World:
    """The body on its host; both have this arm."""
    held = HOSTS[host]
    bodies, words = [body], f"rolling 1 plane1 {arm!r}"
    if held is not None:
        bodies, words, more = [body, held], f"rolling 1 2 {arm!r}", more | {"planes": []}
    frequency = lab.frequency_of(speed, 0.06)
    return lab.World(tmp_path, bodies, frequency=frequency, thin=0.06, words=words, **more)


@pytest.mark.parametrize(
    ("name", "host"),
    [("ball", "plane"), ("ball", "box"), ("ball", "mesh"), ("cylinder", "plane"), ("cylinder", "box"), ("ellipsoid", "plane"),
     ("torus", "plane")],
)  # fmt: skip
@pytest.mark.parametrize("arm", [5e-3, 2e-2])
def test_it_stops_where_it_should(tmp_path, name, host, arm):
    """After v^2/(2 c g r/R), and stays; all that it had is heat."""
    body, v = BODIES[name], 0.5
    body = body.put(v=(v, 0, 0), spin=(0, v / R, 0), mu=1.0)
    slows = share(body) * G * arm / R
    with world(tmp_path, body, host, arm) as run:
        energy = run.energy()
        run.run(round(0.5 * v / slows / run.dt))
        assert run.rows()[0, 3] == pytest.approx(0.5 * v, rel=5e-3)
        run.run(round((0.5 * v / slows + 0.2) / run.dt))
        rested = run.rows()[0]
        run.run(round(0.2 / run.dt))
        row = run.rows()[0]
        assert run.number("friction_heat") + run.number("damping_loss") == pytest.approx(
            0.5 * body.mass * v**2 / share(body), rel=5e-3
        )
        assert run.energy() == pytest.approx(energy, abs=1e-4 * body.mass * v**2)
    assert row[0] == pytest.approx(v**2 / (2 * slows), rel=5e-3)
    assert abs(row[0] - rested[0]) < 1e-6 and abs(row[3]) < 1e-5


@pytest.mark.parametrize("host", ["plane", "box"])
@pytest.mark.parametrize("lean", [0.04, 0.06, 0.2])
def test_a_ball_on_a_slope(tmp_path, host, lean):
    """It begins to roll where the slope is steeper than r/R, and goes at 5/7 g (sin - r/R cos)."""
    arm = 0.05 * R
    gravity, sine, cosine = tilted(lean)
    body = BODIES["ball"].put(mu=1.0)
    with world(tmp_path, body, host, arm, gravity=gravity) as run:
        if lean < 0.05:
            run.run(round(1.0 / run.dt))
            assert abs(run.rows()[0, 0]) < 1e-5
        else:
            acceleration, _ = rolled(run)
            assert acceleration == pytest.approx(5 / 7 * G * (sine - 0.05 * cosine), rel=2e-3)


def test_two_balls_that_roll_over_each_other(tmp_path):
    """The torques on both are opposite: angular momentum stays to rounding, and rolling ends."""
    two = [lab.ball(R, at=(0, 0, -R + 1e-4), v=(0, 0, 0.2), spin=(0, 3, 0), mu=1.0),
           lab.ball(R, at=(0, 0, R - 1e-4), v=(0, 0, -0.2), spin=(0, -1, 0.5), mu=1.0)]  # fmt: skip
    with lab.World(tmp_path, two, frequency=100.0, planes=[], gravity=(0, 0, 0), words="rolling 1 2 0.02") as run:
        about = lambda rows: sum(b.mass * np.cross(r[:3], r[3:6]) + b.moments[0] * r[10:13] for b, r in zip(two, rows))
        before, energy = about(run.rows()), run.energy(0)
        run.run(200)
        assert about(run.rows()) == pytest.approx(before, abs=1e-13)
        assert run.number("friction_heat") > 0.0 and run.energy(0) == pytest.approx(energy, rel=2e-3)


@pytest.mark.parametrize("words", ["rolling 1 9 0.1", "rolling 1 plane1 -1", "rolling 1 plane7 0.1", "rolling 1 1 0.1"])
def test_pairs_that_there_are_not(tmp_path, words):
    """Are refused by the fix."""
    with (
        pytest.raises(Exception, match=r"rolling|planes|pair"),
        lab.World(tmp_path, [BODIES["ball"]], frequency=100.0, words=words),
    ):
        pass
