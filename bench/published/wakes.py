# SPDX-License-Identifier: GPL-2.0-only
"""The wake of what is towed, beside linear waves of the same body as a pressure on the water."""

from __future__ import annotations

import numpy as np
from mdanim_lammps import Run
from scipy.optimize import brentq

from .case import Case, Curve, Found, Row, Runs
from .linear_wakes import ANGLES, BEHIND, BUOY, DEEP, LATE, SPEED, G, Y, by_direction, mean_pattern
from .linear_wakes import wake as linear_wake


def _here(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """The pattern of a run, and its y [m]."""
    t, liquid = run.trajectory, run.trajectory.liquid
    late = [(float(t.times[n]), np.nan_to_num(t.liquid_raw(n).astype(float) - DEEP)) for n in np.flatnonzero(t.times > LATE)]
    y, x = (liquid.low[k] + (np.arange(n) + 0.5) * (liquid.high[k] - liquid.low[k]) / n for k, n in zip((1, 0), late[0][1].shape))
    return mean_pattern(late, x), y


def wake(runs: Runs) -> Found:
    """Where its waves are highest, and how long those are that run behind."""
    pattern, y = _here(runs.run("kelvin"))
    here, linear = by_direction(pattern, y), by_direction(linear_wake(BUOY)[0], Y)
    k = brentq(lambda k: k * np.tanh(k * DEEP) - G / SPEED**2, 0.1, 100.0)
    behind = (BEHIND > -2.2) & (BEHIND < -0.5)
    line, place = pattern[np.abs(y) < 0.1].mean(axis=0)[behind], BEHIND[behind]
    turns = np.flatnonzero(line[:-1] * line[1:] < 0.0)
    rows = [
        Row("angle of the highest waves from the course", ANGLES[linear.argmax()], ANGLES[here.argmax()], 0.05, "°"),
        Row("length of the waves behind it", 2.0 * np.pi / k, 2.0 * np.diff(place[turns]).mean(), 0.03, "m"),
    ]
    lines = {"here": (ANGLES, here), "linear waves": (ANGLES, linear), "Kelvin, 19.47°": ((19.47, 19.47), (0.0, 1.0))}
    return Found(rows, Curve("angle from the course [°]", "height of waves over the highest", lines, {}))


CASES = [
    Case(
        "kelvin",
        "The wake of what is towed",
        "Kelvin 1887",
        "Lord Kelvin 1887: the wake of a small body has a half angle of 19.47°, and behind it run waves of the length 2πv²/g, "
        "here with that of the depth, v²k = g tanh kd. Published is the angle at which linear waves of the same buoy, as a "
        "pressure on the water, are highest at the same time.",
        "5 %, a degree. 3 % of the length, of which two are measured.",
        "Two causes. The water around the buoy, and in the hollow behind it, is steeper than 0.3, so that it loses its inertia "
        "as a front that breaks does (W5); without it, water that is slower than √(gd) carries no waves. *Tried:* nothing "
        "breaks. The arms are then at 22° in place of 25.25°, with cells half as wide at 26.5° in place of 32.25°, and waves "
        "are 2.4 times as high. The other cause is the law, which is within 1.4 % of the frequency up to kd = 4, but lets "
        "groups of waves run too fast where they are short: at kd = 3 by a tenth, at kd = 5 by a quarter. Linear waves by this "
        "law, without cells, are highest at 20.75° behind the buoy as a pressure, and at 31.5° behind a hull that the water "
        "follows, where potential flow has 19° and 19.75° (`python bench/published/linear_wakes.py`). Finer cells have shorter "
        "waves and steeper water, so both causes grow, at `reference`. Heights and resistance are off, too: a flat dish 2 cm "
        "deep (`--set radius=30 --set high=12 --set up=0.1`) has waves 0.30 times as high as linear ones of its hull, and 1.75 "
        "times its resistance; where nothing breaks it has 0.97 and 0.94 of them. Other limits were tried, and cost floods and "
        "bores too much ([figures](decisions/liquid.md#waves)).",
        wake,
    )
]
