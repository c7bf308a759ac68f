# SPDX-License-Identifier: GPL-2.0-only
"""Machines and buildings of several parts: a ball on a rope, a crank with a piston, a beam of glued stones."""

from __future__ import annotations

import math

import numpy as np

from .case import Case, Curve, Found, Row, Runs

G = 9.81
"""[m/s^2]"""


def string(runs: Runs) -> Found:
    """Period of a ball of steel on a rope that stretches by its weight, with the mass of the rope and the ball's size."""
    run = runs.run("string").trajectory
    time, x = run.times, run.objects["ball"].center_of_mass[:, 0]
    before = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    passed = time[before] - x[before] * (time[before + 1] - time[before]) / (x[before + 1] - x[before])
    rope, radius, swing = 0.008, 0.03, math.radians(10.0)
    ball = 7800.0 * 4.0 / 3.0 * math.pi * radius**3
    length = 1.0 + (ball + 0.5 * rope) * G / (1e8 * math.pi / 4.0 * 0.004**2)
    centre = length + radius
    inertia = ball * (centre**2 + 0.4 * radius**2) + rope * length**2 / 3.0
    period = 2.0 * math.pi * math.sqrt(inertia / (ball * centre + 0.5 * rope * length) / G) * (1.0 + swing**2 / 16.0)
    row = Row("period of 10°", period, float(passed[-1] - passed[0]) / (len(passed) - 1), 0.001, "s")
    some = np.arange(0.0, time[-1], period / 12.0)
    points = {"closed form": (some, centre * swing * np.cos(2.0 * math.pi * some / period))}
    return Found([row], Curve("time [s]", "x of the ball [m]", {"here": (time, x)}, points))


def piston(runs: Runs) -> Found:
    """Where the piston is in two turns of the crank."""
    run, r, length = runs.run("piston").trajectory, 0.2, 0.6
    turn = 2.0 * math.pi * run.times
    known = r * np.cos(turn) + np.sqrt(length**2 - (r * np.sin(turn)) ** 2)
    found = run.objects["piston"].center_of_mass[:, 0]
    rows = [Row("farthest from its place, over the stroke", 0.0, float(abs(found - known).max()), 0.002, "m", scale=2.0 * r)]
    for degrees in (90, 180):
        at = int(np.argmin(abs(run.times - 1.0 - degrees / 360.0)))
        rows.append(Row(f"place with the crank at {degrees}°", float(known[at]), float(found[at]), 0.002, "m", scale=2.0 * r))
    curve = Curve(
        "time [s]", "place of the piston [m]", {"here": (run.times, found)}, {"closed form": (run.times[::5], known[::5])}
    )
    return Found(rows, curve)


def lintel(runs: Runs) -> Found:
    """Stress in the middle of a beam on two posts, and the strength from which on it stays whole."""
    long, span, thick = 1.2, 1.0, 0.1
    moment = 2500.0 * G * thick**2 * (long * span / 4.0 - long**2 / 8.0)
    stress = moment / (thick**3 / 6.0) / 1e3
    whole, broken = 2.0 * stress, 0.5 * stress
    bore, tries = runs.run("lintel").outcomes[0].found / 1e3, []
    for _ in range(6):
        strength = 0.5 * (whole + broken)
        tries.append((strength, runs.run("lintel", strength=strength / 1e3).outcomes[1].found))
        if tries[-1][1] > 1:
            broken = strength
        else:
            whole = strength
    rows = [
        Row("largest stress, M/W", stress, bore, 0.01, "kPa"),
        Row("strength with which it stays whole", stress, 0.5 * (whole + broken), 0.02, "kPa"),
    ]
    line = {"statics": ((0.5 * stress, stress, stress, 1.5 * stress), (1.0, 1.0, 0.0, 0.0))}
    points = {"here": ([strength for strength, _ in tries], [float(pieces > 1) for _, pieces in tries])}
    return Found(rows, Curve("strength of the glue [kPa]", "0: stays whole, 1: breaks", line, points))


CASES = [
    Case(
        "string",
        "A ball on a rope swings",
        "pendulum",
        "The pendulum of a lesson, 2π √(I/(M g d)) (1 + φ²/16), with the mass of the rope, the size of the ball, and the rope"
        " longer by its load over E A.",
        "0.1 %: the next term of the amplitude is 3e-6; the ball turns a little against the rope, which begins without a load.",
        "As 2π √(L/g) of the rope as it is written it is 2 % slow: 1.5 % are the ball's radius, 0.3 % the"
        " stretch of a rope of 100 MPa, 0.2 % the amplitude.",
        string,
        quick=True,
    ),
    Case(
        "piston",
        "A crank pushes a piston",
        "kinematics",
        "Kinematics of a slider-crank: x = r cos ωt + √(l² − r² sin² ωt).",
        "0.2 % of the stroke: hinges give way a little under the forces of the masses.",
        "With `stiffness 4e6 N/m` in its hinges, as in `scenes/crank.txt`, it is within 0.06 %.",
        piston,
        quick=True,
        peers=True,
    ),
    Case(
        "lintel",
        "A beam of glued stones",
        "statics",
        "Statics: M/W in the middle of a beam on two supports, with M = w (L S/4 − L²/8) for the weight w of a metre, W = t³/6"
        " (Galileo 1638 has the dependence on length and thickness).",
        "1 % of the stress, 2 % of the strength, which is found by halving an interval six times.",
        "Glue breaks by pull and bending, or by shear, in the joints between stones alone.",
        lintel,
    ),
]
