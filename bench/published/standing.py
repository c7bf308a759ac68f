# SPDX-License-Identifier: GPL-2.0-only
"""Standing by friction, and rocking: two cards that lean on each other, a block on its edge."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import quad

from .case import Case, Curve, Found, Row, Runs

G = 9.81
"""[m/s^2]"""


def least(stands: Callable[[float], bool], low: float, high: float, looks: int) -> float:
    """The least value at which it stands, between one at which it falls and one at which it stands, by halving so often.

    NaN where it fell, or stood, at all values that were tried.
    """
    ends = low, high
    for _ in range(looks):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stands(middle) else (middle, high)
    return 0.5 * (low + high) if ends[0] < low and high < ends[1] else math.nan


def leaning(runs: Runs) -> Found:
    """Cards of 40 cm and 1 cm at 30 degrees from upright: the moment about a foot."""

    def stands(mu: float) -> bool:
        z = runs.run("leaning", mu=mu).trajectory.objects["card[0]"].center_of_mass[:, 2]
        return bool(abs(z[-1] - z[0]) < 0.01)

    leans = np.linspace(5.0, 50.0, 50)
    needed = 0.5 * (np.tan(np.radians(leans)) - 1.0 / 40.0)
    row = Row("least friction", 0.5 * (math.tan(math.radians(30.0)) - 1.0 / 40.0), least(stands, 0.2, 0.6, 6), 0.012)
    curve = Curve("lean from upright [°]", "least friction", {"statics": (leans, needed)}, {"here": ((30.0,), (row.found,))})
    return Found([row], curve)


def rocking(runs: Runs) -> Found:
    """A block of 20 x 80 cm let go at 8 degrees."""
    b, h, tilt = 0.2, 0.8, math.radians(8.0)
    alpha, half = math.atan2(b, h), 0.5 * math.hypot(b, h)
    p2, keeps = 0.75 * G / half, 1.0 - 1.5 * math.sin(alpha) ** 2

    def swing(top: float) -> tuple[float, float]:
        """Time from the top of a swing to the blow, and the speed there."""
        speed = lambda q: math.sqrt(2.0 * p2 * (math.cos(alpha - top) - math.cos(alpha - q)))
        smooth = lambda s: 2.0 * top * s / speed(top * (1.0 - s * s))
        return quad(smooth, 0.0, 1.0)[0], speed(0.0)

    first, speed = swing(tilt)
    second_top = alpha - math.acos(math.cos(alpha) + (keeps * speed) ** 2 / (2.0 * p2))
    second, _ = swing(second_top)
    run = runs.run("rocking").trajectory
    spin = np.abs(run.objects["block"].spin[:, 1])
    # The first frame that is as fast as all within a tenth of a second.
    fastest = [k for k in range(100, len(spin) - 100) if spin[k - 100 : k].max() < spin[k] >= spin[k : k + 100].max()][:2]
    times = run.times[fastest]
    rows = [
        Row("time to the first blow", first, float(times[0]), 0.01, "s"),
        Row("speed at the first blow", speed, float(spin[fastest[0]]), 0.01, "rad/s"),
        Row("time to the second blow", 2.0 * second, float(times[1] - times[0]), 0.01, "s"),
        Row("speed left by a blow, 1 − 3/2 sin² α", keeps, float(spin[fastest[1]] / spin[fastest[0]]), 0.01),
    ]
    blows = ((first, first, first + 2.0 * second), (speed, keeps * speed, keeps * speed))
    shown = run.times < 1.2
    curve = Curve(
        "time [s]", "spin [rad/s]", {"here": (run.times[shown], spin[shown])}, {"Housner, before and after blows": blows}
    )
    return Found(rows, curve)


CASES = [
    Case(
        "leaning",
        "Two cards lean on each other",
        "statics",
        "Statics: the foot needs μ = (tan α − d/L)/2 at the angle α from upright; 60° from the ground as in IPC's house of cards "
        "(Li et al. 2020, 5_hitCardHouse).",
        "1.2 %: found by halving an interval of friction six times, to 1.1 % of the figure; they stand where they have sunk by "
        "less than 1 cm after a second of their whole weight.",
        "Weight grows from nothing in half a second. Cards that are put down at once slip a little at the first moment.",
        leaning,
        peers=True,
    ),
    Case(
        "rocking",
        "A slender block rocks from edge to edge",
        "Housner 1963",
        "Housner, Bull. Seismol. Soc. Am. 53 (1963) 403: θ'' = −p² sin(α − θ) with p² = 3g/4R, and a blow leaves 1 − 3/2 sin² α "
        "of the speed.",
        "1 %: times are exact by a quadrature without the small angles of the paper; a blow takes some milliseconds here, none "
        "there.",
        "Housner's block touches along its two edges only. Real bases, and finer contact, leave more of the speed.",
        rocking,
        peers=True,
    ),
]
