# SPDX-License-Identifier: GPL-2.0-only
"""Friction: how far a block slides."""

from __future__ import annotations

from .case import Case, Found, Row, Runs


def slide(runs: Runs) -> Found:
    """Slides at two speeds."""
    rows = []
    for mu, v in ((0.5, 2.0), (0.2, 1.0)):
        run = runs.run("slide", mu=mu, v=f"{v} m/s")
        found = run.trajectory.objects["block"].center_of_mass[-1, 0]
        rows.append(Row(f"slides at {v:g} m/s, friction {mu:g}", v**2 / (2.0 * mu * 9.81), float(found), 0.005, "m"))
    return Found(rows)


CASES = [
    Case(
        "slide",
        "A block slides to a stop",
        "Closed form v²/(2μg); Project Chrono's unit test of sliding friction (src/tests/unit_tests/smc_contact) allows 0.5 %.",
        "Within what Chrono's own test allows.",
        "The block is rigid: friction of an elastic one acts where its sole bears weight.",
        slide,
        quick=True,
    )
]
