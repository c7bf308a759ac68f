# SPDX-License-Identifier: GPL-2.0-only
"""Blows: how high rigid objects come back, and Newton's cradle."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from .case import Case, Curve, Found, Row, Runs


def bounce(runs: Runs) -> Found:
    """Speeds after over before, from heights, of balls, of logs that fall flat and of boxes."""
    rows, points = [], {}
    for scene, kinds in (("bounce", ("ball",)), ("bounce_flat", ("log", "box"))):
        objects = runs.run(scene).trajectory.objects
        for kind in kinds:
            for k, e in enumerate((0.4, 0.6, 0.8, 1.0), 1):
                height = objects[f"{kind}[{k}]"].center_of_mass[:, 2] - 0.05
                lowest = int(height[:60].argmin())
                back = math.sqrt(float(height[lowest:].max()) / float(height[0]))
                rows.append(Row(f"{kind}, {e:g}", e, back, 0.03, scale=1.0))
            points[f"{kind} here"] = ((0.4, 0.6, 0.8, 1.0), [row.found for row in rows[-4:]])
    line = {"as it is asked for": ((0.3, 1.0), (0.3, 1.0))}
    return Found(rows, Curve("restitution in the scene", "speed after over before", line, points))


def clacks(runs: Runs) -> Found:
    """Five balls on strings of 50 cm, 2 mm apart; the first is let go at 40 degrees."""
    run = runs.run("clacks").trajectory
    rise, speed = 0.5 * (1.0 - math.cos(math.radians(40.0))), math.sqrt(2.0 * 9.81 * 0.5 * (1.0 - math.cos(math.radians(40.0))))
    after = (run.times > 0.45) & (run.times < 0.6)
    objects = run.objects
    last = float(objects["ball[5]"].center_of_mass[:, 2].max()) - 0.5
    rows = [
        Row("speed of the first ball", speed, float(abs(objects["ball[1]"].velocity[:, 0]).max()), 0.001, "m/s"),
        Row("height of the last ball", rise, last, 0.005, "m"),
    ]
    for k in (1, 3):
        left = float(abs(objects[f"ball[{k}]"].velocity[after, 0]).max())
        rows.append(Row(f"speed left to ball {k}", 0.0, left, 0.01, "m/s", scale=speed))
    some, struck = np.linspace(0.0, 0.95, 39), math.radians(40.0)
    swing = solve_ivp(lambda _, s: (s[1], -9.81 / 0.5 * math.sin(s[0])), (0.0, 0.95), (struck, 0.0), t_eval=some, rtol=1e-9)
    angle = swing.y[0]
    down = int(np.argmax(angle < 0.0))
    lines = {f"ball {k} here": (run.times, objects[f"ball[{k}]"].center_of_mass[:, 2] - 0.5) for k in (1, 3, 5)}
    high = 0.5 * (1.0 - np.cos(angle))
    points = {
        "pendulum that strikes": (some[:down], high[:down]),
        "pendulum that is struck": (some[down:] + 4.0 * 0.002 / speed, high[down:]),
    }
    return Found(rows, Curve("time [s]", "height [m]", lines, points))


CASES = [
    Case(
        "bounce",
        "Balls, logs and boxes bounce",
        "Newton's law of restitution",
        "The coefficient of restitution, speed after a blow over the speed before it; Project Chrono has it as a unit test "
        "(utest_SMC_cor_normal).",
        "*off* is the difference of both coefficients. [Restitution](physics-rigid.md#restitution) promises 0.03 from 0.4 on.",
        "A blow is a damped spring that does not pull, over some nine steps. A log of which one end "
        "comes first has each end damped as if it fell alone, and keeps more.",
        bounce,
        peers=True,
    ),
    Case(
        "clacks",
        "Newton's cradle",
        "Newton's law of restitution",
        "Equal masses exchange their velocities. Balls that touch do not: Herrmann and Seitz, Am. J. Phys. 50 (1982) 977.",
        "Balls are 2 mm apart, so that they strike one after the other, and a blow goes up to 1 mm deep: a ball that has handed "
        "on its speed is up to 3 mm from its place, and swings about it with 0.9 % of the speed, hence 1 %. 0.1 % of the first "
        "speed, which only the string sets, and 0.5 % of the last height.",
        "Strings are stiff and have no mass. Balls that touch from the beginning share the blow, and all of them move.",
        clacks,
        peers=True,
    ),
]
