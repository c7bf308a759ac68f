# SPDX-License-Identifier: GPL-2.0-only
"""Turning freely or about a point: tops that precess and nod, and a block that tips over about its middle axis."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad
from scipy.special import ellipj, ellipk

from .case import Case, Curve, Found, Row, Runs

G = 9.81
"""[m/s^2]"""


def minima(times: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of the minima of a curve, by parabolas through three points each."""
    k = np.flatnonzero((values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:])) + 1
    before, at, after = values[k - 1], values[k], values[k + 1]
    shift = 0.5 * (before - after) / (before - 2.0 * at + after)
    return times[k] + shift * (times[1] - times[0]), at - 0.25 * (before - after) * shift


def gyro(runs: Runs) -> Found:
    """Two tops of gyro.txt: radius 6 cm, height 5 cm, axis 30 degrees off upright, 120 rad/s."""
    r, h, spin, lean = 0.06, 0.05, 120.0, math.radians(30.0)
    arm, about, across = 0.75 * h, 0.3 * r**2, 0.15 * r**2 + 0.6 * h**2
    b = (across - about) * math.cos(lean)
    steady = (about * spin - math.sqrt((about * spin) ** 2 - 4.0 * b * G * arm)) / (2.0 * b)
    # u = cos of the lean: u'^2 = f(u) = (u_0 - u) (w (1 - u^2) - a^2 (u_0 - u)).
    a, w, u0 = about * spin / across, 2.0 * G * arm / across, math.cos(lean)
    low = (a**2 - math.sqrt(a**4 - 4.0 * w * (a**2 * u0 - w))) / (2.0 * w)
    other = a**2 / w - low
    # With u = (u_0 + low)/2 + (u_0 - low)/2 sin s the ends are smooth.
    middle, half = 0.5 * (u0 + low), 0.5 * (u0 - low)
    nod = quad(lambda s: 1.0 / math.sqrt(w * (other - middle - half * math.sin(s))), -0.5 * math.pi, 0.5 * math.pi)[0] * 2.0
    run = runs.run("gyro").trajectory
    even = run.objects["even"].center_of_mass + (0.1, 0.0, 0.0)
    goes = np.unwrap(np.arctan2(even[:, 1], even[:, 0]))
    times, depth = minima(run.times, run.objects["nods"].center_of_mass[:, 2])
    rate = float((goes[-1] - goes[0]) / (run.times[-1] - run.times[0]))
    lowest = math.degrees(math.acos(float(np.mean(depth)) / arm))
    rows = [
        Row("steady precession", steady, rate, 0.0005, "rad/s"),
        Row("period of nodding", nod, float(np.mean(np.diff(times))), 0.0005, "s"),
        Row("lean when lowest", math.degrees(math.acos(low)), lowest, 0.0005, "°"),
    ]
    leans = np.degrees(np.arccos(np.clip(run.objects["nods"].center_of_mass[:, 2] / arm, -1.0, 1.0)))
    turns = nod * np.arange(0.0, run.times[-1] / nod, 0.5)
    ends = np.where(np.arange(len(turns)) % 2, math.degrees(math.acos(low)), math.degrees(lean))
    points = {"elliptic integral": (turns, ends)}
    return Found(rows, Curve("time [s]", "lean from upright [°]", {"here": (run.times, leans)}, points))


def flip(runs: Runs) -> Found:
    """A block of 30 x 20 x 6 cm that turns by 10 rad/s about y and 0.05 rad/s about x."""
    sides, start = np.array([0.3, 0.2, 0.06]), np.array([0.05, 10.0, 0.0])
    inertia = (sides @ sides - sides**2) / 12.0
    order = np.argsort(inertia)[::-1]
    (big, middle, small), (w3, w2, w1) = inertia[order], start[order]
    energy, square = big * w3**2 + middle * w2**2 + small * w1**2, (big * w3) ** 2 + (middle * w2) ** 2 + (small * w1) ** 2
    # Landau and Lifshitz, Mechanics, 37, with I3 the largest where L^2 > 2 E I2.
    if square > energy * middle:
        rate = math.sqrt((big - middle) * (square - energy * small) / (small * middle * big))
        k2 = (middle - small) * (energy * big - square) / ((big - middle) * (square - energy * small))
    else:
        rate = math.sqrt((middle - small) * (energy * big - square) / (small * middle * big))
        k2 = (big - middle) * (square - energy * small) / ((middle - small) * (energy * big - square))
    turn = 2.0 * ellipk(k2) / rate
    run = runs.run("flip").trajectory
    spin = np.linalg.norm(run.objects["block"].spin, axis=1)
    times, _ = minima(run.times, spin)
    highest, _ = minima(run.times, -spin)
    fastest = math.sqrt(_largest_square(inertia, energy, square))
    found = float(np.mean(np.diff(highest)))
    rows = [
        Row("time from one turn-over to the next", turn, found, 0.0005, "s"),
        Row("fastest spin on the way", fastest, float(spin.max()), 0.0005, "rad/s"),
    ]
    # w2 = w_most sn(rate (t - t0)) along the middle axis; the other two by 2 E and L^2. It begins near the turn of w2.
    first = float(highest[0]) if len(highest) else 0.0
    some = np.linspace(0.0, run.times[-1], 61)
    sn, cn, dn, _ = ellipj(rate * (some - first), k2)
    points = {}
    if square <= energy * middle:
        most = (
            math.sqrt((square - energy * small) / (big * (big - small))),
            math.sqrt((square - energy * small) / (middle * (middle - small))),
            math.sqrt((energy * big - square) / (small * (big - small))),
        )
        points = {"Euler's equations": (some, np.sqrt((most[0] * cn) ** 2 + (most[1] * sn) ** 2 + (most[2] * dn) ** 2))}
    curve = Curve("time [s]", "spin [rad/s]", {"here": (run.times, spin)}, points)
    return Found(rows, curve if len(times) else None)


def _largest_square(inertia: np.ndarray, energy: float, square: float) -> float:
    """Largest |w|^2 on the way, where w is in the plane of the largest and the smallest moment: both squares by 2 E and L^2."""
    big, small = inertia.max(), inertia.min()
    w3 = (square - energy * small) / (big * (big - small))
    return float(w3 + (energy - big * w3) / small)


CASES = [
    Case(
        "gyro",
        "A heavy top precesses and nods",
        "Klein and Sommerfeld 1897",
        "Steady precession of a symmetric top, (I₁ − I₃) cos θ Ω² − I₃ s Ω + m g l = 0, and its nutation by an elliptic integral "
        "(Klein and Sommerfeld 1897; Goldstein, Classical Mechanics, 5.7).",
        "0.05 %: the joint that holds the tip gives way by a part of the size of the top.",
        "Air and friction of the bearing are left out. `scenes/tops.txt` has tops that stand on the ground by friction.",
        gyro,
        peers=True,
    ),
    Case(
        "flip",
        "A block turns over about its middle axis",
        "Euler's equations",
        "Euler's equations: 2K(k)/λ from one turn-over to the next (Landau and Lifshitz, Mechanics, § 37).",
        "0.05 %: rotations are exact to rounding; the time depends on the logarithm of how far off the axis it starts.",
        "A rigid block. One that deforms ends up about the axis of its largest moment, as its `damping` takes energy.",
        flip,
        peers=True,
    ),
]
