# SPDX-License-Identifier: GPL-2.0-only
"""Friction and rolling: how far a block slides, on which slope it stays, what skids and what rolls."""

from __future__ import annotations

import math

import numpy as np

from .case import Case, Curve, Found, Row, Runs

G = 9.81
"""[m/s^2]"""


def slide(runs: Runs) -> Found:
    """Slides at two speeds."""
    rows, lines, points = [], {}, {}
    for mu, v in ((0.5, 2.0), (0.2, 1.0)):
        run = runs.run("slide", mu=mu, v=f"{v} m/s")
        times, x = run.trajectory.times, run.trajectory.objects["block"].center_of_mass[:, 0]
        rows.append(Row(f"slides at {v:g} m/s, friction {mu:g}", v**2 / (2.0 * mu * G), float(x[-1]), 0.005, "m"))
        lines[f"here, friction {mu:g}"] = (times, x)
        some = np.linspace(0.0, times[-1], 25)
        slides = np.minimum(some, v / (mu * G))
        points[f"closed form, friction {mu:g}"] = (some, v * slides - 0.5 * mu * G * slides**2)
    return Found(rows, Curve("time [s]", "way [m]", lines, points))


def incline(runs: Runs) -> Found:
    """One block at the limit of friction, one just beyond it."""
    slope, time = math.atan(0.5), 2.0
    way = 0.5 * G * time**2 * (math.sin(slope) - 0.49 * math.cos(slope))
    run = runs.run("incline").trajectory
    stays, slides = (
        (run.objects[name].center_of_mass - run.objects[name].center_of_mass[0])[:, 0] / math.cos(slope)
        for name in ("stays", "slides")
    )
    rows = [
        Row("way with friction 0.5", 0.0, float(stays[-1]), 0.005, "m", scale=way),
        Row("way with friction 0.49", way, float(slides[-1]), 0.005, "m"),
    ]
    some = np.linspace(0.0, time, 21)
    lines = {"here, friction 0.5": (run.times, stays), "here, friction 0.49": (run.times, slides)}
    points = {"Coulomb, 0.5": (some, 0.0 * some), "Coulomb, 0.49": (some, way * (some / time) ** 2)}
    return Found(rows, Curve("time [s]", "way down the slope [m]", lines, points))


def skid(runs: Runs) -> Found:
    """Speed and place after it has come to roll, at two frictions."""
    rows, lines, points = [], {}, {}
    for mu in (0.2, 0.4):
        v, time = 3.0, 1.2
        run = runs.run("skid", mu=mu).trajectory
        ball = run.objects["ball"]
        skids = 2.0 * v / (7.0 * mu * G)
        place = v * skids - 0.5 * mu * G * skids**2 + 5.0 / 7.0 * v * (time - skids)
        rows.append(Row(f"speed at last, friction {mu:g}", 5.0 / 7.0 * v, float(ball.velocity[-1, 0]), 0.0005, "m/s"))
        rows.append(Row(f"way in {time:g} s, friction {mu:g}", place, float(ball.center_of_mass[-1, 0]), 0.0005, "m"))
        some = np.linspace(0.0, time, 25)
        lines[f"here, friction {mu:g}"] = (run.times, ball.velocity[:, 0])
        points[f"closed form, friction {mu:g}"] = (some, np.maximum(v - mu * G * some, 5.0 / 7.0 * v))
    return Found(rows, Curve("time [s]", "speed [m/s]", lines, points))


def rolls(runs: Runs) -> Found:
    """Ways down a slope of 20 degrees in 1.2 s."""
    run, time = runs.run("rolls").trajectory, 1.2
    falls, some = 0.5 * G * time**2 * math.sin(math.radians(20.0)), np.linspace(0.0, time, 13)
    inertia = {"ball": 2.0 / 5.0, "disc": 1.0 / 2.0, "ring": 0.8**2 + 0.75 * 0.2**2}
    rows, lines, points = [], {}, {}
    for name, share in inertia.items():
        c = run.objects[name].center_of_mass
        lines[f"{name} here"] = (run.times, np.linalg.norm(c - c[0], axis=1))
        points[f"{name}, closed form"] = (some, falls / (1.0 + share) * (some / time) ** 2)
        rows.append(Row(f"way of the {name}", falls / (1.0 + share), float(np.linalg.norm(c[-1] - c[0])), 0.0005, "m"))
    return Found(rows, Curve("time [s]", "way [m]", lines, points))


def green(runs: Runs) -> Found:
    """Where it stops, with two arms of the torque that resists."""
    rows, lines, points = [], {}, {}
    for arm in (1.5, 3.0):
        run = runs.run("green", arm=f"{arm} mm").trajectory
        x, way = run.objects["ball"].center_of_mass[:, 0], 0.7 * 1.8**2 * 21.35 / (G * arm)
        rows.append(Row(f"rolls at 1.8 m/s, arm {arm:g} mm", way, float(x[-1]), 0.0005, "m"))
        some = np.linspace(0.0, run.times[-1], 26)
        rest = np.maximum(0.0, 1.0 - some * 1.8 / (2.0 * way))
        lines[f"here, arm {arm:g} mm"] = (run.times, x)
        points[f"closed form, arm {arm:g} mm"] = (some, way * (1.0 - rest**2))
    return Found(rows, Curve("time [s]", "way [m]", lines, points))


CASES = [
    Case(
        "slide",
        "A block slides to a stop",
        "Coulomb, as in Project Chrono's test",
        "Closed form v²/(2μg); Project Chrono's unit test of sliding friction (src/tests/unit_tests/smc_contact) allows 0.5 %.",
        "Within what Chrono's own test allows.",
        "The block is rigid: friction of an elastic one acts where its sole bears weight.",
        slide,
        quick=True,
        peers=True,
    ),
    Case(
        "incline",
        "Blocks on a slope of one half",
        "Coulomb, as in IPC's test (Li et al. 2020)",
        "Coulomb: a block stays up to μ = tan θ and slides by g t²/2 (sin θ − μ cos θ) beyond; IPC (Li et al. 2020) has it as "
        "slopeTest_highSchoolPhysics with μ = 0.5 and 0.49.",
        "0.5 %. The way of the first block is over that of the second. All of its friction is in use, so it slips while it sinks "
        "in at the start, and keeps 0.25 mm/s of that, as nothing takes it off: 0.5 mm in 2 s.",
        "Rigid blocks, put down without a bounce. With the damping that contacts with friction have by default "
        "(`--set e=0.45`) they come back once while they sink in, and slip meanwhile: the first then goes on at "
        "3.5 mm/s, 7 mm in 2 s, and the second slides 3.5 % too far. Elastic ones of 1 GPa, as IPC's, get 1.3 mm/s "
        "while they settle (`scenes/validation/incline_soft.txt`): they swing up and down, gain speed while their load is low, "
        "and while it is high friction stops them, but drives none up the slope, so a part of it is left. Where the friction is "
        "that of the slope nothing takes it off them: the first goes on for 2.5 mm in 2 s (3.1 mm at `preview`), and the second "
        "slides 1.3 % too far. With `friction 0.505` the first stays, to 0.02 mm (at `preview`).",
        incline,
        peers=True,
    ),
    Case(
        "skid",
        "A bowling ball skids until it rolls",
        "Coriolis 1835",
        "Newton's second law with Coulomb friction: a full ball rolls at 5/7 of its speed, after 2v/(7μg), whatever the friction "
        "(Coriolis 1835; a test of the Newton physics engine, test_kamino_solvers_dvi.py).",
        "0.05 %: both are closed forms; the ball sinks in by a part of its radius and so turns with a shorter arm.",
        "No resistance to rolling, which `rolling` adds.",
        skid,
        quick=True,
        peers=True,
    ),
    Case(
        "rolls",
        "A ball, a disc and a ring roll down a slope",
        "Newton's law",
        "Closed form g sin θ t²/2 over 1 + I/(m R²), with I/(m R²) = 2/5, 1/2, and 0.67 of a ring of the radii 8 and 2 cm.",
        "0.05 %: closed forms without slip, where friction 0.5 is above all that rolling needs.",
        "Rigid. Elastic balls lose 1 to 2.5 % of their way by the points on which they roll (`scenes/race.txt`).",
        rolls,
        peers=True,
    ),
    Case(
        "green",
        "A golf ball stops on the green",
        "Newton's law",
        "Closed form 7 v² R/(10 g r) of a full ball with the arm r of the resistance; 1.8 m/s is what a stimpmeter gives it.",
        "0.05 %: a closed form, as in [how rolling resistance is computed](physics-rigid.md#rolling-resistance).",
        "The arm of a real lawn depends on speed; the model has one number.",
        green,
        peers=True,
    ),
]
