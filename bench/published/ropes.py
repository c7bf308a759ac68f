# SPDX-License-Identifier: GPL-2.0-only
"""Ropes, chains and cloth that hang and fall."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad, solve_bvp
from scipy.optimize import brentq

from .case import Case, Curve, Found, Row, Runs, places

G = 9.81


def hangs(runs: Runs) -> Found:
    """Sag and pull of a chain whose ends have been drawn apart."""
    run = runs.run("catenary")
    span, length, weight = 1.6, 2.0, 2000.0 * math.pi / 4.0 * 0.01**2 * G
    a = brentq(lambda a: 2.0 * a * math.sinh(0.5 * span / a) - length, 0.1, 10.0)
    last = run.trajectory.objects["chain"].position(len(run.trajectory) - 1)
    pull = run.outcomes[0].found
    rows = [
        Row("sag", a * (math.cosh(0.5 * span / a) - 1.0), float(np.ptp(last[:, 2])), 0.003, "m"),
        Row("pull at its end", weight * a * math.cosh(0.5 * span / a), float(pull), 0.002, "N"),
    ]
    some = np.linspace(-0.5 * span, 0.5 * span, 33)
    points = {"catenary": (some, a * (np.cosh(some / a) - math.cosh(0.5 * span / a)))}
    lines = {"here": (last[:, 0] - 0.5 * (last[:, 0].min() + last[:, 0].max()), last[:, 2] - last[:, 2].max())}
    return Found(rows, Curve("x from the middle [m]", "height [m]", lines, points))


def falls(share: float, length: float) -> float:
    """When the end of a folded chain has fallen by a share of its length [s]: v² = g x (2L − x)/(L − x)."""
    return quad(lambda s: math.sqrt((1.0 - s) / (s * (2.0 - s))), 0.0, share)[0] * math.sqrt(length / G)


def folded(runs: Runs) -> Found:
    """Time of the free end at shares of its fall."""
    run, length = runs.run("folded_chain"), 2.0
    time = run.trajectory.times
    fallen = 2.2 - places(run, "chain")[:, -1, 2]
    whole = int(fallen.argmax()) + 1
    rows = [
        Row(
            f"time in which its end falls by {share:g} of its length",
            1e3 * falls(share, length),
            1e3 * float(np.interp(share * length, fallen[:whole], time[:whole])),
            0.005,
            "ms",
        )
        for share in (0.3, 0.6, 0.9)
    ]
    rows.append(
        Row(
            "time of the whole fall over that of a ball",
            falls(1.0, length) / math.sqrt(2.0 * length / G),
            float(time[whole - 1] / math.sqrt(2.0 * length / G)),
            0.01,
        )
    )
    shares = np.linspace(0.02, 0.999, 60)
    return Found(
        rows,
        Curve(
            "time [s]",
            "fall of the end [m]",
            {"here": (time[:whole], fallen[:whole]), "free fall": (time[:whole], 0.5 * G * time[:whole] ** 2)},
            {"energy kept": ([falls(share, length) for share in shares[::4]], length * shares[::4])},
        ),
    )


def pulled_over(runs: Runs) -> Found:
    """How far the heavier weight has gone down after it was let go, against the lighter one."""
    run = runs.run("atwood")
    time = run.trajectory.times
    left, right = (run.trajectory.objects[name].center_of_mass[:, 2] for name in ("left", "right"))
    heavy, light, rope, roller, radius, at = 1.3, 1.0, 0.1, 0.4, 0.1, 0.1102
    of_length = rope / 1.6
    mass = heavy + light + rope + 0.5 * roller * (radius / at) ** 2
    rate = math.sqrt(2.0 * of_length * G / mass)  # the longer side of the rope weighs more
    begun = int(np.abs(time - 1.0).argmin())
    way = 0.5 * ((right - right[begun]) - (left - left[begun]))
    rows = []
    for after in (0.5, 0.7):
        found = float(np.interp(1.0 + after, time, way))
        rows.append(
            Row(
                f"way after {after:g} s",
                100.0 * (heavy - light) / (2.0 * of_length) * (math.cosh(rate * after) - 1.0),
                100.0 * found,
                0.01,
                "cm",
            )
        )
    some = np.linspace(0.0, 0.7, 15)
    known = 100.0 * (heavy - light) / (2.0 * of_length) * (np.cosh(rate * some) - 1.0)
    lines = {"here": (time[begun:] - time[begun], 100.0 * way[begun:])}
    return Found(rows, Curve("time from the release [s]", "way [cm]", lines, {"closed form": (some, known)}))


def heavy(long: float) -> float:
    """Angle by which the end of a strip is below where it sticks out [deg], with its free length over (B/w)^(1/3): the rigidity B
    and the weight w of a length. θ'' = −(L³ w/B) (1 − s) cos θ with θ = 0 at s = 0 and θ' = 0 at s = 1."""
    at = np.linspace(0.0, 1.0, 100)
    found = solve_bvp(
        lambda s, y: np.array([y[1], -(long**3) * (1.0 - s) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]),
        lambda start, end: np.array([start[0], end[1], start[2], start[3]]),
        at,
        np.array([at, 0.0 * at, at, 0.0 * at]),
        tol=1e-6,
    )
    return math.degrees(math.atan2(*found.sol(1.0)[:1:-1]))


def peirce(angle: float) -> float:
    """Free length over (B/w)^(1/3) at an angle [deg], by Peirce's formula."""
    return 2.0 * (math.tan(math.radians(angle)) / math.cos(0.5 * math.radians(angle))) ** (1.0 / 3.0)


def droops(runs: Runs) -> Found:
    """Angles of three strips: from the middle between the columns of particles that are held to the end."""
    run, c, rows = runs.run("droop"), (1.177e6 * 0.005**2 / (12.0 * 250.0 * G)) ** (1.0 / 3.0), []
    shown = []
    for k in (1, 2, 3):
        x = places(run, f"strip[{k}]")[[0, -1]]
        columns = np.unique(x[0, :, 0].round(6))
        clamp, end = columns[:2].mean(), np.isclose(x[0, :, 0], x[0, :, 0].max())
        tip, long = x[1, end].mean(axis=0), (x[0, end, 0].mean() - clamp) / c
        angle = math.degrees(math.atan2(-tip[2], tip[0] - clamp))
        rows.append(Row(f"droop of a free length of {0.9 + 0.5 * k:.1f} (B/w)^⅓", heavy(long), angle, 0.01, "°"))
        shown.append((long, angle))
    angles, longs = np.linspace(2.0, 62.0, 40), np.linspace(0.6, 2.6, 40)
    lines = {"heavy elastica": (longs, [heavy(long) for long in longs]), "Peirce": ([peirce(a) for a in angles], angles)}
    return Found(rows, Curve("free length over (B/w)^⅓", "droop [°]", lines, {"here": tuple(zip(*shown))}))


CASES = [
    Case(
        "catenary",
        "A hanging chain",
        "catenary",
        "Closed form: L = 2a sinh(S/2a), sag a (cosh(S/2a) − 1), pull at the ends w a cosh(S/2a).",
        "0.3 % of the sag, 0.2 % of the pull: the chain stretches by 0.1 %, which lowers it by 1.3 mm.",
        "",
        hangs,
    ),
    Case(
        "folded_chain",
        "A folded chain falls faster than a ball",
        "Calkin and March 1989",
        "M. G. Calkin and R. H. March, The dynamics of a falling chain I, American Journal of Physics 57 (1989) 154–157,"
        " by C. W. Wong and K. Yasui, Falling chains, American Journal of Physics 74 (2006) 490–496: energy is kept, so"
        " the free end falls with v² = g x (2L − x)/(L − x). M. Schagerl, A. Steindl, W. Steiner and H. Troger, On the"
        " paradox of the free falling folded chain, show by experiment that it is faster than free fall.",
        "0.5 % of times, 1 % of the last: the fold is 6 cm wide, the closed form's has no width, and frames are 5 ms apart.",
        "Ropes do not resist twist, so Michell's ring, which buckles under twist, cannot be shown.",
        folded,
        quick=True,
    ),
    Case(
        "atwood",
        "Atwood's machine",
        "Atwood 1784",
        "Closed form with the masses of rope and roller, x'' = ((M − m) + 2 λ x) g/(M + m + λ L + I/r²) with the mass of"
        " rope per length λ; P.-T. Brun, B. Audoly, A. Goriely and D. Vella (arXiv:1605.03714) have it without these"
        " masses, after Atwood (1784).",
        "1 %: the rope lies around the roller as a polygon of links of 2 cm, and stretches by 1 %.",
        "",
        pulled_over,
    ),
    Case(
        "droop",
        "A strip of cloth droops over an edge",
        "Bickley 1934, Peirce 1930",
        "W. G. Bickley, The heavy elastica, Phil. Mag. 17 (1934) 603, computed anew by `heavy` in bench/published/ropes.py; the"
        " test of cloth is F. T. Peirce's, The handle of cloth as a measurable quantity, J. Textile Inst. 21 (1930) T377, ASTM"
        " D1388, whose formula is an approximation to it.",
        "1 %: strips have 24 to 41 links along their free length.",
        "",
        droops,
    ),
]
