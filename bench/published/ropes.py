# SPDX-License-Identifier: GPL-2.0-only
"""Ropes, chains and cloth that hang and fall."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad
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
    return Found(
        [
            Row("sag", a * (math.cosh(0.5 * span / a) - 1.0), float(np.ptp(last[:, 2])), 0.003, "m"),
            Row("pull at its end", weight * a * math.cosh(0.5 * span / a), float(pull), 0.002, "N"),
        ]
    )


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
            {"found": (time[:whole], fallen[:whole]), "free fall": (time[:whole], 0.5 * G * time[:whole] ** 2)},
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
    return Found(rows)


CASES = [
    Case(
        "catenary",
        "A hanging chain",
        "Closed form: L = 2a sinh(S/2a), sag a (cosh(S/2a) − 1), pull at the ends w a cosh(S/2a).",
        "0.3 % of the sag, 0.2 % of the pull: the chain stretches by 0.1 %, which lowers it by 1.3 mm.",
        "",
        hangs,
    ),
    Case(
        "folded_chain",
        "A folded chain falls faster than a ball",
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
        "Closed form with the masses of rope and roller, x'' = ((M − m) + 2 λ x) g/(M + m + λ L + I/r²) with the mass of"
        " rope per length λ; P.-T. Brun, B. Audoly, A. Goriely and D. Vella (arXiv:1605.03714) have it without these"
        " masses, after Atwood (1784).",
        "1 %: the rope lies around the roller as a polygon of links of 2 cm, and stretches by 1 %.",
        "",
        pulled_over,
    ),
]
