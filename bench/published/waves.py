# SPDX-License-Identifier: GPL-2.0-only
"""Waves in tanks and on a beach, and what swings between two arms."""

from __future__ import annotations

import sys

import numpy as np

from .case import ROOT, Case, Curve, Found, Row, Runs, series
from .surface import along_x, crossings

sys.path.insert(0, str(ROOT / "tests" / "lab"))
from arms import inertia_of_arm

G = 9.81


def sway(runs: Runs) -> Found:
    """A tank that is pushed aside once, at two shapes."""
    rows, lines, points = [], {}, {}
    for long, depth in ((1.73, 0.6), (1.0, 1.0)):
        run = runs.run("sway", long=long, depth=depth)
        times, (x, heights) = run.trajectory.times, along_x(run)
        k, later = np.pi / long, times > 0.3
        mode = heights @ np.cos(k * x)
        zeros = crossings(times[later], mode[later])
        period = 2.0 * np.pi / np.sqrt(G * k * np.tanh(k * depth))
        rows.append(Row(f"period, {long:g} m long, {depth:g} m deep", period, 2.0 * np.diff(zeros).mean(), 0.015, "s"))
        some, name = zeros[0] + period * np.arange(0.25, 4.0, 0.25), f"{long:g} m long"
        sign = np.sign(mode[np.searchsorted(times, some[0])])
        lines[f"here, {name}"] = (times[later], mode[later] / abs(mode[later]).max())
        points[f"linear, {name}"] = (some, sign * np.sin(2.0 * np.pi * (some - zeros[0]) / period))
    return Found(rows, Curve("time [s]", "longest wave over its largest", lines, points))


LONG, DEEP, WAY, TURN = 1.73, 0.6, 0.032, 2.0 * np.pi / 1.3
"""Length and depth of the shaken tank [m], and how it is shaken [m], [1/s]."""
TURNS = (
    ("crest near 1.2 s", 0.9, 1.5, np.max),
    ("crest near 2.6 s", 2.2, 3.0, np.max),
    ("trough near 3.3 s", 2.9, 3.7, np.min),
    ("crest near 4.0 s", 3.7, 4.4, np.max),
    ("crest near 7.7 s", 7.3, 8.1, np.max),
    ("crest near 9.2 s", 8.7, 9.6, np.max),
)


def low_waves(times: np.ndarray, modes: int = 15) -> np.ndarray:
    """Elevation at the left wall by linear waves [m]: of each mode b'' + ω² b = ω² (4l/n²π²) a/g, with a the acceleration."""
    n = np.arange(1, 2 * modes, 2)[:, None]
    k = n * np.pi / LONG
    own = np.sqrt(G * k * np.tanh(k * DEEP))
    most = -(own**2) * 4.0 * LONG / (n * np.pi) ** 2 * WAY * TURN**2 / G / (own**2 - TURN**2)
    return (most * (np.cos(TURN * times) - np.cos(own * times))).sum(axis=0)


def shaken(runs: Runs) -> Found:
    """A tank that is shaken for beats, and the same by a quarter of the way."""
    measured, part = series("faltinsen"), 0.25

    def elevation(share: float) -> tuple[np.ndarray, np.ndarray]:
        run = runs.run("shaken_tank", share=share)
        return run.trajectory.times, (along_x(run, crests=True)[1][:, 0] - DEEP) / share

    times, here = elevation(1.0)
    slow, low = elevation(part)
    linear = low_waves(times)
    rows = []
    for name, first, last, turn in TURNS:
        of = [turn(y[(t > first) & (t < last)]) for t, y in (measured, (times, here))]
        rows.append(Row(name, *of, 0.08, "m", scale=0.142))
    lull = [np.ptp(y[(t > 5.1) & (t < 5.9)]) for t, y in (measured, (times, here))]
    rows.append(Row("height of the waves in the lull from 5.1 to 5.9 s", *lull, 0.08, "m", scale=0.142))
    for name, first, last, turn in TURNS[1:3]:
        of = [turn(y[(t > first) & (t < last)]) for t, y in ((times, linear), (slow, low))]
        rows.append(Row(f"linear waves: {name}, here by a quarter of the way, times 4", *of, 0.08, "m"))
    lines = {"here": (times, here), "linear waves": (times, linear)}
    return Found(rows, Curve("time [s]", "elevation at the wall [m]", lines, {"Faltinsen et al.": tuple(measured)}))


def beach(runs: Runs) -> Found:
    """Solitary waves on a beach."""
    measured, d = series("synolakis"), 0.3
    rows, highs, ups = [], (0.039, 0.094, 0.298), []
    for high in highs:
        run = runs.run("beach", high=high)
        x, heights = along_x(run, crests=True)
        floor = np.clip((x - 12.0 * d) / 19.85, 0.0, None)
        wet = heights - floor > 0.003 * d
        up = max(floor[np.flatnonzero(row).max()] for row in wet) / d - 1.0
        near = np.abs(measured[0] / high - 1.0) < 0.12
        ups.append(up)
        runs_up = measured[1, near]
        mean = runs_up.mean()
        spread = float(np.abs(runs_up / mean - 1.0).max())
        rows.append(Row(f"run-up over depth, wave of {high:g} of the depth", mean, up, round(spread, 3)))
    points = {"Synolakis": tuple(measured[:2]), "here": (highs, ups)}
    curve = Curve("height of the wave over the depth", "run-up over the depth", {}, points)
    return Found(rows, curve)


def utube(runs: Runs) -> Found:
    """A U-tube."""
    run = runs.run("utube")
    times, (x, heights) = run.trajectory.times, along_x(run)
    left, right = heights[:, x < -0.4].mean(1), heights[:, x > 0.4].mean(1)
    small, wide = times > 2.0, 0.1
    zeros = crossings(times[small], (left - right)[small])
    found = 2.0 * np.diff(zeros).mean() if len(zeros) > 1 else np.nan
    level, swing = 0.5 * (left + right)[small].mean(), 0.5 * np.ptp((left - right)[small]) / 2.0
    inertia = 0.8 / wide + 2.0 * inertia_of_arm(level - wide, wide, wide)
    rows = [
        Row("period, 2π√(L/2g)", 2.0 * np.pi * np.sqrt((0.9 + 2.0 * level - wide) / 2.0 / G), found, 0.05, "s"),
        Row("period with the corners by potential flow", 2.0 * np.pi * np.sqrt(inertia * wide / 2.0 / G), found, 0.025, "s"),
    ]
    exact = rows[1].published
    some = zeros[0] + exact * np.arange(0.0, 2.4, 1.0 / 12.0) if len(zeros) else np.array([])
    sign = np.sign(np.interp(some[1], times, left) - level) if len(some) else 1.0
    points = {"left arm, closed form": (some, level + sign * swing * np.sin(2.0 * np.pi * (some - some[:1]) / exact))}
    curve = Curve("time [s]", "level [m]", {"left arm here": (times, left), "right arm here": (times, right)}, points)
    return Found(rows, curve)


def bore(runs: Runs) -> Found:
    """A wall that moves into water at rest."""
    from scipy.optimize import brentq

    run, deep, speed = runs.run("bore"), 0.3, 1.2
    times, (x, heights) = run.trajectory.times, along_x(run)

    def behind(c: float) -> float:
        return deep * c / (c - speed)

    c = brentq(lambda c: 0.5 * G * (behind(c) ** 2 - deep**2) - deep * c * speed, 1.01 * speed, 10.0)
    middle = 0.5 * (behind(c) + deep)
    late = times > 0.4 * times[-1]
    front = np.array([x[row > middle].max() for row in heights[late]])
    plateau = (x > speed * times[-1] + 0.5) & (x < c * times[-1] - 1.0)
    rows = [
        Row("speed of the bore", c, np.polyfit(times[late], front, 1)[0], 0.015, "m/s"),
        Row("depth behind it", behind(c), heights[-1][plateau].mean(), 0.015, "m"),
        Row(
            "Bélanger, (√(1 + 8F²) − 1)/2 with the Froude number F of the bore found, over the depths found",
            1.0,
            0.5
            * (np.sqrt(1.0 + 8.0 * np.polyfit(times[late], front, 1)[0] ** 2 / (G * deep)) - 1.0)
            / (heights[-1][plateau].mean() / deep),
            0.015,
        ),
    ]
    step = [np.array([speed, c, c, 10.0 / times[-1]]) * times[-1], np.array([behind(c), behind(c), deep, deep])]
    return Found(rows, Curve("x [m]", "depth [m]", {"here": (x, heights[-1])}, {"Bélanger": (step[0], step[1])}))


def backwater(flow: float, n: float, fall: float, x: np.ndarray, last: float) -> np.ndarray:
    """Depths of a gradually varied flow at places x [m], upstream from a depth at the last one, by steps through their middles:
    dh/dx = (S - n²q²/h^(10/3))/(1 - F²) with the Froude number F, F² = q²/gh³."""

    def steepness(h: float) -> float:
        return (fall - (n * flow) ** 2 / h ** (10.0 / 3.0)) / (1.0 - flow**2 / (G * h**3))

    depths = [last]
    for step in np.diff(x)[::-1]:
        depths.append(depths[-1] - step * steepness(depths[-1] - 0.5 * step * steepness(depths[-1])))
    return np.array(depths[::-1])


def river(runs: Runs) -> Found:
    """A river down a rough channel: uniform above, a backwater behind the sill at its end."""
    run, flow, n, fall, long, pit = runs.run("river"), 0.06, 0.05, 0.02, 12.0, 0.1
    x, heights = along_x(run)
    uniform = (flow * n / np.sqrt(fall)) ** 0.6
    depth = heights[-5:].mean(0) - pit - fall * (long - x)
    high, swollen = (x > 1.0) & (x < 3.5), (x > 1.0) & (x < long - 0.6)
    exact = backwater(flow, n, fall, x[swollen], depth[swollen][-1])
    end, error = x[swollen][-1], np.abs(depth[swollen] / exact - 1.0).mean()
    reach = [end - float(np.interp(1.2 * uniform, of, x[swollen])) for of in (exact, depth[swollen])]
    rows = [
        Row("depth of the uniform flow, (qn/√S)^⅗", uniform, depth[high].mean(), 0.01, "m"),
        Row("reach of the backwater, to where it is 1.2 times as deep", *reach, 0.02, "m"),
        Row("mean error of the depth along the channel, over its own", 0.0, error, 0.01, "", 1.0),
    ]
    some = slice(None, None, 20)
    lines, points = {"here": (x[swollen], depth[swollen])}, {"gradually varied flow": (x[swollen][some], exact[some])}
    return Found(rows, Curve("x [m]", "depth [m]", lines, points))


def weir(runs: Runs) -> Found:
    """A flow over a broad weir, its fall, and the jump below it: means over the frames in which the jump is on its way."""
    run, flow, high, end = runs.run("weir"), 0.1, 0.2, 2.1
    times, (x, heights) = run.trajectory.times, along_x(run)
    below = (x > end + 0.2) & (x < 5.2)
    found = []
    for time, row in zip(times, heights):
        steep = x[below][:-1][np.argmax(np.diff(row[below]))]
        before, behind = (x > end + 0.2) & (x < steep - 0.2), (x > steep + 0.3) & (x < 5.0)
        if 2.8 < steep < 4.5 and time > 4.0:
            found.append((time, steep, row[before].mean(), row[behind].mean()))
    when, where, shallow, deep = np.array(found).T
    speed = np.polyfit(when, where, 1)[0]
    froude = (flow / shallow - speed) / np.sqrt(G * shallow)
    up = heights[-1][(x > 0.7) & (x < 1.2)].mean()
    critical = (flow**2 / G) ** (1.0 / 3.0)
    rows = [
        Row("head of the river over the weir, 3/2 (q²/g)^⅓", 1.5 * critical, up - high + flow**2 / (2.0 * G * up**2), 0.03, "m"),
        Row("depth below the fall", 0.54 * high * (flow**2 / (G * high**3)) ** 0.425, shallow.mean(), 0.1, "m"),
        Row(
            "Bélanger, (√(1 + 8F²) − 1)/2 with the Froude number F before the jump, over the depths found",
            1.0,
            (0.5 * (np.sqrt(1.0 + 8.0 * froude**2) - 1.0) * shallow / deep).mean(),
            0.015,
        ),
    ]
    middle = heights[np.searchsorted(times, when[len(when) // 2])]
    floor = np.where((x > 1.5) & (x < end), high, np.where((x > 5.3) & (x < 5.7), 0.05, 0.0))
    jump = 0.5 * rows[1].published * (np.sqrt(1.0 + 8.0 * flow**2 / (G * rows[1].published ** 3)) - 1.0)
    points = {
        "energy on the weir, 3/2 (q²/g)^⅓": ((1.0,), (high + rows[0].published,)),
        "critical depth there": ((1.8,), (high + critical,)),
        "Rand, below the fall": ((2.6,), (rows[1].published,)),
        "Bélanger, a jump from there": ((4.6,), (jump,)),
    }
    return Found(rows, Curve("x [m]", "height [m]", {"here": (x, middle), "weir and sill": (x, floor)}, points))


CASES = [
    Case(
        "sway",
        "The longest wave of a tank",
        "linear waves",
        "Linear waves: ω² = gk tanh kd, k = π/l. The second row is the standing wave of SPHinXsys's "
        "test_2d_standing_wave, half of it.",
        "1.5 %: what the law of the model leaves of the closed form up to kd = 4, 1.4 %, and 32 cells along the tank.",
        "",
        sway,
    ),
    Case(
        "bore",
        "A bore before a wall that moves",
        "Bélanger 1828",
        "J.-B. Bélanger 1828: mass and momentum at a hydraulic jump, here one that a wall at 1.2 m/s pushes into water "
        "0.3 m deep.",
        "1.5 %: undulations behind the bore, and its width of some cells.",
        "",
        bore,
        sph=True,
    ),
    Case(
        "weir",
        "A weir and a hydraulic jump",
        "Rand 1955, experiment; Bélanger 1828",
        "J.-B. Bélanger 1828 for the jump and for a broad weir, on which the flow is critical; W. Rand, Flow geometry at "
        "straight drop spillways, Proc. ASCE 81 (1955) 791, as in V. T. Chow, Open-Channel Hydraulics: below a fall of the "
        "height z the depth is 0.54 z (q²/gz³)^0.425.",
        "3 % of the head: a crest of 60 cm is 48 cells. 10 % of the depth below the fall, for which Rand's formula is a fit. "
        "1.5 % of the jump, as of a bore; it wanders upstream at a few cm/s, as the water behind the sill is deeper than a jump "
        "that stands needs.",
        "Behind the foot of a real fall stands a pool, which pushes the flow on. Here what falls has the momentum that it had on "
        "the crest, no pool pushes it, and it runs off by a quarter slower and a third deeper.",
        weir,
    ),
    Case(
        "river",
        "A river down a rough channel",
        "closed form",
        "Uniform flow after Manning, q = h^(5/3) √S/n, and the backwater curve of gradually varied flow, M1, as in V. T. Chow, "
        "Open-Channel Hydraulics (1959), from the depth found at its lower end.",
        "1 %, and 2 % of the place: six cells in the depth.",
        "",
        river,
    ),
    Case(
        "shaken_tank",
        "A tank is shaken",
        "Faltinsen et al. 2000, experiment",
        "Faltinsen et al. 2000, Fig. 7, digitised in PySPH (pysph/examples/st_exp_data.py).",
        "8 %, of the experiment relative to the highest crest: the 1.4 % of the period that the law of the model leaves are 4 % "
        "of the height of waves that are shaken at 0.78 of it, and as much is left to 32 cells. The times of crests and troughs "
        "are those of the experiment.",
        "Waves are half as high as the water is deep. Linear waves, without what makes real ones smaller, would be as high: "
        "0.156 m at the second crest and −0.140 m at the trough after it, and a quarter of the way, times 4, gives them here "
        "within a tenth. Higher waves are shifted up besides, as the square of their height (0.046 m here, 0.025 m in the "
        "experiment, whose waves are 24 % lower). So the cause is not the dispersion here: the waves of the experiment have "
        "less than linear ones.",
        shaken,
        sph=True,
    ),
    Case(
        "beach",
        "Solitary waves on a beach",
        "Synolakis 1987, experiment",
        "Synolakis 1987, 77 runs in a laboratory; NTHMP benchmark problem 4. Published is the mean of the runs "
        "within 12 % of the wave's height.",
        "The most by which one of these runs in the laboratory differs from their mean. Twelve cells in the depth.",
        "The ground has Manning's n = 0.01, that of glass and of smooth metal (V. T. Chow, Open-Channel Hydraulics, 1959, "
        "Table 5-6: 0.009 to 0.013), as the tank was smooth. Without friction (`--set n=0.0001`) these waves run up by 0.144, "
        "0.316 and 0.677 of the depth, with n = 0.0125 by 0.123, 0.236 and 0.451. What is missing is due to cells: it is 22, "
        "11 and 5 % at most with 6, 12 and 24 of them in the depth. The beach is a tilted box: the cells of a mesh would make "
        "steps of its slope.",
        beach,
    ),
    Case(
        "utube",
        "A U-tube",
        "closed form",
        "Closed form for arms that are narrow: L is the length of the middle line.",
        "5 %: how short the flow cuts its two corners of 10 cm leaves a tenth of L open; with the corners 2.5 %, as swings are "
        "high.",
        "In an arm that is narrower than deep the water goes up and down as one, and more of it than in a column whose speed "
        "falls off to the floor. The mouth of the duct has what is missing ([how](physics-liquid.md#waves)); before, this "
        "U-tube swung 19 % fast. An arm twice as wide as deep is 7 % slow beside potential flow, in which it sloshes.",
        utube,
        sph=True,
    ),
]
