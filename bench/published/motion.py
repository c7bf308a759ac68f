# SPDX-License-Identifier: GPL-2.0-only
"""Pendulums, and what falls in air."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from .case import Case, Curve, Found, Row, Runs

G = 9.81
"""[m/s^2]"""


def swings(runs: Runs) -> Found:
    """Rods of 1 m and 4 cm; the double pendulum is let go stretched out level."""
    run = runs.run("swings").trajectory
    about_end = 1.0 / 3.0 + 0.04**2 / 12.0
    rows = []
    for name, angle in (("small", 5.0), ("large", 120.0)):
        period = 4.0 * ellipk(math.sin(0.5 * math.radians(angle)) ** 2) * math.sqrt(2.0 * about_end / G)
        x = run.objects[name].center_of_mass[:, 0]
        k = np.flatnonzero((x[:-1] > 0.0) != (x[1:] > 0.0))
        through = run.times[k] + x[k] / (x[k] - x[k + 1]) * (run.times[k + 1] - run.times[k])
        found = 2.0 * float(through[-1] - through[0]) / (len(through) - 1)
        rows.append(Row(f"period of a rod, {angle:g}°", period, found, 0.0005, "s"))
    own = (run.objects["upper"].center_of_mass - (0.0, 0.5, 2.5), run.objects["lower"].center_of_mass - (0.0, 0.5, 2.5))
    until = run.times <= 2.0
    places = double_pendulum(run.times[until])
    for time in (1.0, 2.0):
        at = int(np.argmin(abs(run.times - time)))
        off = max(float(np.hypot(*(places[k][:, at] - own[k][at, [0, 2]]))) for k in (0, 1))
        rows.append(Row(f"double pendulum, off its place at {time:g} s", 0.0, off, 0.002, "m", scale=1.0))
    curve = Curve(
        "x of the lower rod [m]",
        "z [m]",
        {"here": (own[1][until, 0], own[1][until, 2])},
        {"Lagrange's equations": (places[1][0, ::12], places[1][1, ::12])},
    )
    return Found(rows, curve)


def double_pendulum(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centres of both rods by Lagrange's equations, shape (2, T) each: x and z from the upper hinge [m].

    Angles are those from straight down. Each rod has the mass 1 and the length 1; d is its side.
    """
    inertia = (1.0 + 0.04**2) / 12.0

    def turns(_, state: np.ndarray) -> np.ndarray:
        a, b, va, vb = state
        c, s = 0.5 * math.cos(a - b), 0.5 * math.sin(a - b)
        mass = np.array([[inertia + 0.25 + 1.0, c], [c, inertia + 0.25]])
        push = [-s * vb**2 - 1.5 * G * math.sin(a), s * va**2 - 0.5 * G * math.sin(b)]
        return np.array([va, vb, *np.linalg.solve(mass, push)])

    way = solve_ivp(turns, (0.0, times[-1]), [0.5 * math.pi, 0.5 * math.pi, 0.0, 0.0], "DOP853", times, rtol=1e-11, atol=1e-11)
    a, b = way.y[:2]
    upper = np.array([np.sin(a), -np.cos(a)])
    return 0.5 * upper, upper + 0.5 * np.array([np.sin(b), -np.cos(b)])


def diver(runs: Runs) -> Found:
    """A ball of 20 cm and 60 kg/m^3, and a plate of 80 x 80 x 2 cm and 100 kg/m^3."""
    run = runs.run("diver").trajectory
    ball = math.sqrt(2.0 * 60.0 * 4.0 / 3.0 * 0.2 * G / (1.2 * 0.6))
    plate = math.sqrt(2.0 * 100.0 * 0.02 * G / (1.2 * 1.2))
    rows, lines, points = [], {}, {}
    for name, last in (("ball", ball), ("plate", plate)):
        some = np.linspace(0.0, 4.0, 21)
        lines[f"{name} here"] = (run.times, -run.objects[name].velocity[:, 2])
        points[f"{name}, closed form"] = (some, last * np.tanh(G * some / last))
        for time in (1.0, 4.0):
            at = int(np.argmin(abs(run.times - time)))
            speed = last * math.tanh(G * run.times[at] / last)
            rows.append(Row(f"{name} after {time:g} s", speed, -float(run.objects[name].velocity[at, 2]), 0.0005, "m/s"))
    return Found(rows, Curve("time [s]", "speed [m/s]", lines, points))


CASES = [
    Case(
        "swings",
        "Pendulums",
        "elliptic integral; Lagrange's equations",
        "A rod on its end: 4 K(sin φ/2) √(I/(m g L/2)) with the elliptic integral K; the double pendulum by Lagrange's "
        "equations, integrated to 1e-11.",
        "0.05 % of the periods, by joints that give way a little. Off its place is the distance of a centre from where it must "
        "be, over the length of a rod: 0.2 %, as a double pendulum makes small differences grow.",
        "A double pendulum is chaotic: from the third second on the smallest difference decides.",
        swings,
        peers=True,
    ),
    Case(
        "diver",
        "A ball and a plate fall in air",
        "Newton 1687",
        "Quadratic drag: v tanh(g t/v) with v = √(2 m g/(ρ C A)) (Newton 1687, book II).",
        "0.05 %: closed forms; cases of [air](physics-air.md#measured) are within 0.5 %.",
        "C is 0.6 of a ball and 1.2 of a plate unless `coefficient` says otherwise, at all Reynolds numbers; measured are 0.4 to "
        "0.5 of smooth balls, and 0.1 to 0.2 above the crisis of drag.",
        diver,
    ),
]
