# SPDX-License-Identifier: GPL-2.0-only
"""A bar that turns about a plastic hinge."""

from __future__ import annotations

import math

import numpy as np

from .case import Case, Curve, Found, Row, Runs, places

LONG, THICK, YOUNG, YIELDS = 0.12, 0.02, 2e6, 0.01
"""Length and side of the bar of collapse.txt [m], its modulus [Pa] and the strain at which it yields."""


def under(load: float) -> float:
    """Deflection at the end of the bar [m], under a load over that of the plastic hinge, 1.5 times that of the first yield.

    The curvature of a section is that of its first yield over the part of its height that is elastic (Prager and Hodge).
    """
    first = 2.0 / 3.0 * YIELDS * LONG**2 / THICK  # P L^3/3 E I at the load of the first yield
    over = 1.5 * load
    if over <= 1.0:
        return first * over
    return first * (5.0 - (3.0 + over) * math.sqrt(3.0 - 2.0 * over)) / over**2


def hinge(runs: Runs) -> Found:
    """The force on the end of the bar as it is pulled down."""
    run = runs.run("collapse")
    x = places(run, "bar")
    end = np.isclose(x[0, :, 0], x[0, :, 0].max())
    way = x[0, end, 2].mean() - x[:, end, 2].mean(axis=1)
    force = run.records["hand.joint.force(bar)"]
    most = YOUNG * YIELDS * THICK**3 / 4.0 / LONG
    loads = np.linspace(0.0, 0.999, 400)
    ways = [under(load) for load in loads]
    rows = [
        Row(
            f"force at {1e3 * at:g} mm over that of the hinge",
            float(np.interp(at, ways, loads)),
            float(np.interp(at, way, force)) / most,
            0.05,
        )
        for at in (0.004, 0.006, 0.008)
    ]
    late = way > 0.7 * way.max()
    rows.append(Row("force of the plastic hinge, M/L", most, float(force[late].mean()), 0.05, "N"))
    some = slice(None, None, 20)
    points = {"Prager and Hodge": ([*(1e3 * np.array(ways[some])), 1e3 * way.max()], [*loads[some], 1.0])}
    curve = Curve("way of the end [mm]", "force over that of the hinge", {"here": (1e3 * way, force / most)}, points)
    return Found(rows, curve)


CASES = [
    Case(
        "collapse",
        "A bar turns about a plastic hinge",
        "Prager and Hodge 1951",
        "W. Prager and P. G. Hodge, Theory of Perfectly Plastic Solids (1951): a section that yields all through bears"
        " M = σ b t²/4, 1.5 times what it bears when its faces begin to yield; deflections between both in closed form.",
        "5 %: the bar has four cells in its thickness, and Euler's theory leaves out its shear, 2 % of its deflection.",
        "Ideal plasticity: metals harden, and bear more as they bend on. With two cells in its thickness, as at `preview`,"
        " the bar gives way a fifth too early.",
        hinge,
    )
]
