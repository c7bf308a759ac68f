# SPDX-License-Identifier: GPL-2.0-only
"""How long elastic balls touch what they hit."""

from __future__ import annotations

import math
import sys

import numpy as np

from .case import ROOT, Case, Curve, Found, Row, Runs

sys.path.insert(0, str(ROOT / "tests" / "lab"))
import ball_on_plane

SPEEDS = (0.05, 0.1, 0.2, 0.4)
RADIUS, SOUND = 0.1, math.sqrt(1e6 / 1000.0)
"""Radius of the ball of hertz.txt, and sqrt(E/rho) there [m, m/s]."""


def touches(speed: float) -> float:
    """Time of contact of a ball with a rigid plane [ms]."""
    return 1e3 * ball_on_plane.contact_time(speed / SOUND) * RADIUS / SOUND


def half_space(speed: float) -> float:
    """The same by Hertz [ms]."""
    mass = 4.0 / 3.0 * math.pi
    return 1e3 * 2.868 * (mass**2 * (1.0 - ball_on_plane.POISSON**2) ** 2 * SOUND / speed) ** 0.2 * RADIUS / SOUND


def blow(runs: Runs) -> Found:
    """Times of contact at several speeds, and the power of the speed that they go with."""
    found = []
    for speed in SPEEDS:
        run = runs.run("hertz", v=speed)
        time = run.trajectory.times
        force = np.gradient(run.trajectory.objects["ball"].velocity[:, 2], time)
        pushed = time[force > 0.005 * force.max()]
        found.append(1e3 * float(pushed[-1] - pushed[0]))
    known = [touches(speed) for speed in SPEEDS]
    rows = [
        Row(f"time of contact at {speed:g} m/s", one, time, 0.1, "ms")
        for speed, one, time in zip(SPEEDS, known, found, strict=True)
    ]
    powers = [float(np.polyfit(np.log(SPEEDS), np.log(times), 1)[0]) for times in (known, found)]
    rows.append(Row("power of the speed", *powers, 0.05, scale=1.0))
    speeds = np.geomspace(SPEEDS[0], SPEEDS[-1], 50)
    return Found(
        rows,
        Curve(
            "speed [m/s]",
            "time of contact [ms]",
            {
                "of a ball": (speeds, list(map(touches, speeds))),
                "Hertz, of a half-space": (speeds, list(map(half_space, speeds))),
            },
            {"here": (SPEEDS, found)},
        ),
    )


CASES = [
    Case(
        "hertz",
        "How long an elastic ball touches the floor",
        "Hertz 1882, of a ball",
        "H. Hertz (1882), 2.868 (m²/R E*² v)^⅕ of a ball that is a half-space where it is dented. The figures are those"
        " of his pressure on a ball, by a series without a half-space (with A. E. H. Love's solutions for a sphere;"
        " tests/lab/ball_on_plane.py): 3 to 7 % less, and the power of the speed −0.22 in place of −0.2. D. Gugan,"
        " Inelastic collision and the Hertz theory of impact, American Journal of Physics 68 (2000) 920–924, finds times"
        " of contact of balls as Hertz says, also of those that lose 40 % of their energy.",
        "10 %, and 0.05 of the power: the ball has four cells across, and its dent is a fifth to half of a cell wide.",
        "A dent much narrower than a cell has few points of the surface in it, and bears as a bed of springs, whose times"
        " go with v^(−⅓). *Tried:* pressure that is harder at first, with which times are within 1 %, for a fifth more steps"
        " ([figures](decisions/contact-stiffness.md)). A ball of two cells, as at `preview`, touches 13 to 16 % too long.",
        blow,
    )
]
