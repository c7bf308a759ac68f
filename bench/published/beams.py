# SPDX-License-Identifier: GPL-2.0-only
"""Bars and strips that bend, swing, stretch and twist."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from .case import Case, Curve, Found, Row, Runs, places

ELASTICA = {1.0: (0.30172, 0.05643), 3.0: (0.60325, 0.25442), 10.0: (0.81061, 0.55500)}
"""Deflection and shortening of the end over the length, at P L^2/(E I)."""
LENGTH = 0.5
"""Free length of the strips [m]."""
POISSON = 0.25
"""Poisson's ratio of the lattice."""


def elastica(alpha: float) -> tuple[float, float]:
    """Deflection and shortening of the end of a cantilever over its length, at P L^2/(E I), from Euler's integrals.

    With the angle a at the end ds = sqrt(E I/2P) da'/sqrt(sin a - sin a'); a' = arcsin(sin a - q^2) takes the root away.
    """

    def over(angle: float, what) -> float:
        top = math.sin(angle)

        def at(q: float) -> float:
            slope = top - q * q
            return 2.0 * what(slope) / math.sqrt(max(1.0 - slope * slope, 1e-300))

        return quad(at, 0.0, math.sqrt(top), limit=200)[0] / math.sqrt(2.0)

    angle = brentq(lambda a: over(a, lambda slope: 1.0) - math.sqrt(alpha), 1e-6, 0.5 * math.pi - 1e-9)
    root = math.sqrt(alpha)
    down, along = over(angle, lambda slope: slope) / root, over(angle, lambda slope: math.sqrt(1.0 - slope * slope)) / root
    return down, 1.0 - along


def tip_force(runs: Runs) -> Found:
    """The strip under three forces, one after the other."""
    run = runs.run("elastica")
    time, tip = run.trajectory.times, run.trajectory.objects["tip"].center_of_mass
    rows = []
    for (alpha, known), end in zip(ELASTICA.items(), (1.6, 2.8, 3.8), strict=True):
        last = tip[np.flatnonzero(time <= end + 1e-9)[-1]]
        for value, figure, what in zip((-last[2], LENGTH - last[0]), known, ("deflection", "shortening"), strict=True):
            rows.append(Row(f"{what} over length, P L²/EI = {alpha:g}", figure, float(value) / LENGTH, 0.01))
    alphas = np.linspace(0.2, 11.0, 40)
    known = np.array([elastica(alpha) for alpha in alphas]).T
    lines = {"deflection, elastica": (alphas, known[0]), "shortening, elastica": (alphas, known[1])}
    points = {
        f"{what} here": (list(ELASTICA), [row.found for row in rows[k::2]]) for k, what in enumerate(("deflection", "shortening"))
    }
    return Found(rows, Curve("P L²/EI", "over the length", lines, points))


def arc(runs: Runs) -> Found:
    """The strip under two torques."""
    rows, ends = [], []
    for degrees in (90, 180):
        tip = runs.run("elastica_circle", turn=degrees).trajectory.objects["tip"].center_of_mass[-1] / LENGTH
        turn = math.radians(degrees)
        ends.append(tip[[0, 2]])
        rows += [
            Row(
                f"height of the end over length, turned by {degrees}°",
                (1.0 - math.cos(turn)) / turn,
                float(tip[2]),
                0.02,
                scale=1.0,
            ),
            Row(
                f"way of the end over length, turned by {degrees}°",
                round(math.sin(turn) / turn, 12),
                float(tip[0]),
                0.02,
                scale=1.0,
            ),
        ]
    turns = np.linspace(1e-6, 1.2 * math.pi, 80)
    line = {"closed form": (np.sin(turns) / turns, (1.0 - np.cos(turns)) / turns)}
    points = {"here, turned by 90° and 180°": tuple(zip(*ends))}
    return Found(rows, Curve("way of the end over the length", "its height over the length", line, points))


def sag(slender: float, thickness: float = 0.1, young: float = 2e6, weight: float = 1000.0) -> tuple[float, float]:
    """Deflection of the end of a clamped square bar under its weight per volume [m]: of bending, and of shear with Cowper's
    coefficient."""
    length, shear = slender * thickness, 10.0 * (1.0 + POISSON) / (12.0 + 11.0 * POISSON)
    bend = 1.5 * weight * length**4 / (young * thickness**2)
    return bend, weight * length**2 / (2.0 * shear * young / (2.0 * (1.0 + POISSON)))


def timoshenko(runs: Runs) -> Found:
    """Bars of two lengths."""
    rows = []
    for slender in (4, 10):
        run = runs.run("timoshenko", n=slender)
        x = places(run, "bar")
        end = np.isclose(x[0, :, 0], x[0, :, 0].max())
        bend, shear = sag(slender)
        rows.append(
            Row(
                f"deflection, length {slender} times the thickness",
                bend + shear,
                float(-x[-1, end, 2].mean()),
                0.03 if slender == 4 else 0.02,
                "m",
            )
        )
    long = np.linspace(3.0, 11.0, 40)
    of_bending = [sum(sag(n)) / sag(n)[0] for n in long]
    lines = {"Timoshenko": (long, of_bending), "Euler, without shear": ((3.0, 11.0), (1.0, 1.0))}
    found = [row.found / sag(n)[0] for row, n in zip(rows, (4, 10), strict=True)]
    return Found(rows, Curve("length over thickness", "deflection over that of bending", lines, {"here": ((4, 10), found)}))


def swings(runs: Runs) -> Found:
    """Time between passages of the end through the middle."""
    run = runs.run("gray")
    time, x = run.trajectory.times, places(run, "beam")
    along = x[0, :, 0] / 0.2
    k, sigma = 1.87510407, 0.73409551
    mode = np.cosh(k * along) - np.cos(k * along) - sigma * (np.sinh(k * along) - np.sin(k * along))
    height = (x[..., 2] - x[0, :, 2]) @ mode  # the first mode alone
    before = np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0))
    passed = time[before] - height[before] * (time[before + 1] - time[before]) / (height[before + 1] - height[before])
    period = float(passed[-1] - passed[0]) / (len(passed) - 1)
    some, most = np.arange(0.0, time[-1], 0.2541 / 16.0), height.max()
    points = {"Euler's period": (some, np.sin(2.0 * math.pi * some / 0.2541))}
    curve = Curve("time [s]", "first mode over its largest", {"here": (time, height / most)}, points)
    return Found([Row("period", 0.2541, period, 0.01, "s")], curve)


def _first_mode(time: np.ndarray, x: np.ndarray, value: np.ndarray) -> float:
    """Period of the wave with a quarter of its length in the bar [s]: of the part of `value` in this mode, which swings about
    where it would rest, by a fit of a sine."""
    mode = np.sin(0.5 * math.pi * x / x.max())
    part = value @ mode

    def off(period: float) -> float:
        base = np.stack([np.ones_like(time), np.cos(2.0 * math.pi * time / period), np.sin(2.0 * math.pi * time / period)], 1)
        return float(np.linalg.lstsq(base, part, rcond=None)[1][0])

    guess = np.linspace(0.5, 2.0, 601) * time[-1] / 3.0
    best = guess[np.argmin([off(period) for period in guess])]
    fine = np.linspace(0.995, 1.005, 201) * best
    return float(fine[np.argmin([off(period) for period in fine])])


def waves(runs: Runs) -> Found:
    """Speeds by the periods of the first modes of two bars."""
    run = runs.run("bar_waves")
    time, length = run.trajectory.times, 1.0
    pulled, twisted = places(run, "pulled"), places(run, "twisted")
    stretch = 4.0 * length / _first_mode(time, pulled[0, :, 0], pulled[..., 0] - pulled[0, :, 0])
    y, z = twisted[0, :, 1] - 0.2, twisted[0, :, 2]
    turn = (y * (twisted[..., 2] - z) - z * (twisted[..., 1] - 0.2 - y)) / 0.1**2
    twist = 4.0 * length / _first_mode(time, twisted[0, :, 0], turn)
    shear = math.sqrt(1e6 / 2.0 / (1.0 + POISSON) / 1000.0 * 6.0 * 0.140577)
    rows = [
        Row("speed of stretching, √(E/ρ)", math.sqrt(1000.0), stretch, 0.01, "m/s"),
        Row("speed of twist, √(G J/ρ I)", shear, twist, 0.02, "m/s"),
    ]
    end, lines = pulled[0, :, 0] > 0.999 * length, {}
    for name, value, speed in (("stretching", pulled[..., 0] - pulled[0, :, 0], math.sqrt(1000.0)), ("twist", turn, shear)):
        way = value[:, end].mean(1)
        lines[f"{name} here"] = (time * speed / length, way / way.mean())
    # The end of a bar under an even load goes there and back in parabolas, by 2 about its mean.
    some = np.arange(0.0, 12.0, 0.25)
    phase = np.abs((some + 2.0) % 4.0 - 2.0)
    points = {"closed form": (some, np.where(phase < 1.0, phase**2, 0.0) + np.where(phase < 1.0, 0.0, 2.0 - (2.0 - phase) ** 2))}
    return Found(rows, Curve("time over L/c, of the closed form", "way of the end over its mean", lines, points))


CASES = [
    Case(
        "elastica",
        "A strip that a force bends far",
        "Bisshopp and Drucker 1945",
        "K. E. Bisshopp and D. C. Drucker, Large deflection of cantilever beams, Quarterly of Applied Mathematics 3"
        " (1945) 272–275; figures are Euler's integrals, computed anew to five digits by `elastica` in"
        " bench/published/beams.py.",
        "1 %: the strip has fifty links along its length, and is held at one and a half rows of particles.",
        "The strip is a sheet, 6 cm wide: where it is clamped it cannot narrow, and is stiffer by up to 1 %. Its"
        " particles are as far apart as it is thick at any `accuracy`.",
        tip_force,
    ),
    Case(
        "elastica_circle",
        "A strip that a torque bends to an arc",
        "Euler's elastica",
        "Closed form: height (1 − cos t)/t and way sin t/t of the end over the length, t = M L/(E I); case v04.138 of"
        " Code_Aster, test CantileverIntoCircle of MuJoCo (test/plugin/elasticity/elasticity_test.cc).",
        "2 % of the length: by 180° it is turned by 3.4° too little, as a strip that is clamped cannot narrow and is held at one "
        "and a half rows of particles.",
        "",
        arc,
    ),
    Case(
        "timoshenko",
        "A short bar bends and shears by its weight",
        "Timoshenko's beam",
        "Timoshenko's beam, ρ g A L⁴/8EI + ρ g L²/2kG with Cowper's k; Project Chrono's test of beams"
        " (utest_FEA_beams_static.cpp) allows 5 %.",
        "3 %, and 2 % of the longer one: the clamp keeps the cross section from narrowing, which the theory of beams does not "
        "know; the shorter the bar, the more it matters.",
        "Bars of one cell are 1.9 times too stiff; `check` warns of fewer than two cells.",
        timoshenko,
        quick=True,
    ),
    Case(
        "gray",
        "A beam that swings",
        "Gray et al. 2001",
        "Gray, Monaghan and Swift (2001): the beam of length 0.2 m and thickness 0.02 m that SPHinXsys has as"
        " test_2d_oscillating_beam. Its period by Euler's theory is 2π/ω with ω² = E H² k⁴/12ρ(1 − ν²), k L = 1.875.",
        "1 %: shear and inertia of turning, which Euler's theory leaves out, make a beam of ten times its thickness"
        " slower by 0.9 %.",
        "Poisson's ratio of solids is 1/4 here; the beam has E/(1 − ν²) of theirs in place of E.",
        swings,
    ),
    Case(
        "bar_waves",
        "Waves of stretching and of twist in a bar",
        "Saint-Venant",
        "Closed forms: √(E/ρ), and Saint-Venant's √(G J/ρ I) with J = 0.1406 a⁴ and I = a⁴/6 of a square.",
        "1 % of stretching; 2 % of twist. The held end keeps the cross section from warping, as if the bar were shorter"
        " by a part of its thickness.",
        "Bars of few cells are too stiff against twist: 1.59 times with two cells across, 1.165 with four, 1.04 with eight."
        " Waves are faster by half of that, 25 %, 8 % and 2 % at `preview`, `balanced` and `reference`. That is all of the"
        " error: the same springs by Saint-Venant's problem for one layer, `python bench/lattice_modes.py twist`, give 8.2 %"
        " where the wave is 8.1 % fast, and the polar moment is right to 0.4 %. *Tried:* other parts for springs of outer"
        " faces, which make bending and twist right together; Poisson's ratio of the outer faces of a pulled bar then falls"
        " from 0.25 to 0.22 ([why](physics-solids.md#masses)). Where a bar is to twist, write a finer `resolution` in it.",
        waves,
    ),
]
