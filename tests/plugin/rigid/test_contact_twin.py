# SPDX-License-Identifier: GPL-2.0-only
"""The plugin's rigid bodies in touch beside their slow twin."""

import numpy as np
import pytest
import rigid_lab as lab
from twin.rigid import TwinBody, TwinWorld, rotated_freely


def twin_of(body: lab.Rigid) -> TwinBody:
    """The same body."""
    turn = lab.matrix(body.q)
    is_ball = body.shape.startswith("ball")
    points = np.zeros((1, 3)) if is_ball else lab.SIGNS * body.spread
    radius = body.thin / 2 if is_ball else 0.0
    angular = turn @ (body.moments * (turn.T @ body.spin))
    found = TwinBody(
        body.mass, body.moments, body.at, body.v, turn, angular, points, radius, body.mu, body.beta, yields=1.0 / body.mass
    )
    if not is_ball:  # the largest over corners and faces
        found.yields = max(1.0 / body.mass + (np.cross(p, n) ** 2 / body.moments).sum() for p in points for n in np.eye(3))
    return found


CASES = {
    "box": [lab.box((0.1, 0.12, 0.2), at=(0, 0, 0.14), q=lab.about((1, 2, 0.5), 0.4), v=(0.8, 0, -1), spin=(1, 2, 3), beta=0.2)],
    "balls": [
        lab.ball(0.05, at=(0, 0, 0.06), v=(1, 0.1, -0.5), spin=(0, -20, 5)),
        lab.ball(0.08, 900, at=(0.16, 0.01, 0.085), mu=0.3, beta=0.1),
    ],
}


@pytest.mark.parametrize("case", CASES)
def test_bodies_move_as_their_twins(tmp_path, case):
    """Through 400 steps with blows, friction that sticks and slips, dashpots. The plugin's rotations are of second order."""
    bodies = CASES[case]
    frequency = lab.frequency_of(2.0, 0.1)
    with lab.World(tmp_path, bodies, frequency=frequency, thin=0.1) as world:
        twin = TwinWorld([twin_of(b) for b in bodies], frequency, 5e-4, (0, 0, -9.81), world.dt)
        touched = 0
        for _ in range(8):
            world.run(50)
            touched += bool(world.number("deepest"))
            for _ in range(50):
                twin.step()
            rows = world.rows()
            assert rows[:, :3] == pytest.approx(np.array([b.x for b in twin.bodies]), abs=1e-6)
            assert rows[:, 3:6] == pytest.approx(np.array([b.v for b in twin.bodies]), abs=1e-4)
        assert touched > 4 and world.number("friction_heat") > 0.0


def test_the_twin_turns_freely_as_it_should():
    """Against a step that is divided finer."""
    moments, angular = np.array([1.0, 2.0, 3.0]), np.array([0.3, 1.0, -0.7])
    turn = lab.matrix(lab.about((1, 2, 3), 0.7))
    assert rotated_freely(turn, angular, moments, 0.05) == pytest.approx(
        rotated_freely(turn, angular, moments, 0.05, 64), abs=1e-10
    )
