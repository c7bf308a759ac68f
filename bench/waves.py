# SPDX-License-Identifier: GPL-2.0-only
"""Waves against closed forms, and what an update costs: ``python bench/waves.py [forms|bodies|coupling|cost]``.

Printed are the tables of docs/physics-liquid.md. Cell, g and the density of the liquid are 1. Costs are times of one core, the
least of several rounds, for a small swell in an open basin; `obstacles` has a block, a shelf and porous cells in it, the ground
of `rough` rubs.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lab"))
import heave
import waves_forms as forms
import waves_lab as lab
from timing import markdown

STANDING = [(64, 4, 1), (64, 10, 1), (64, 20, 1), (40, 20, 1), (64, 20, 2), (40, 40, 1), (64, 20, 4), (64, 20, 8)]
BOBBING = [
    ("cube of 6 cells, density 0.5", (6, 6, 6), 0.5, False, 32, 1),
    ("box 6 × 6 × 5, density 0.4", (6, 6, 5), 0.4, False, 32, 1),
    ("plate 16 × 16 × 4, density 0.5", (16, 16, 4), 0.5, False, 40, 1),
    ("endless beam 6 × 6, density 0.5", (6, 6, 6), 0.5, True, 96, 2),
]
VESSELS = [(8, 16, 4, 16), (8, 32, 4, 16), (16, 8, 4, 16), (4, 48, 4, 12), (1, 64, 1, 12)]


def closed_forms() -> list[tuple]:
    """Rows of what, found, and the closed form."""
    rows = []
    for cells, depth, mode in STANDING:
        found = forms.standing(cells, depth, mode, periods=10)
        wave = f"standing wave {2 * cells // mode} cells long, {depth} deep, kh = {mode * np.pi / cells * depth:.2f}"
        rows.append(
            (f"{wave}: period over 2π/√(k tanh kh); crest after 10 periods", f"{found.period:.3f}; {found.left:.2f}", "1; 1")
        )
    for depth in (8, 16, 32):
        dry = forms.dam_on_dry_ground(depth)
        what = f"dam of {depth} cells on dry ground (Ritter): L1 error of the depth; front (1 % of D) over 2√D; depth at the dam"
        rows.append((what, f"{100 * dry.error:.1f} %; {dry.front:.2f}; {dry.at_dam:.3f}", "0; 0.85; 0.444"))
    for name, settings in (("", {}), (", no dispersion", {"inertia": 0.0})):
        bore = forms.dam_on_wet_ground(16, **settings)
        what = f"dam onto a tenth of its depth (Stoker){name}: speed of the bore; plateau; highest point"
        rows.append((what, f"{bore.speed:.3f}; {bore.plateau:.3f}; {bore.highest:.2f}", "1; 1; 1"))
    for radius, depth in ((20, 6), (40, 12)):
        found = forms.dish(radius, depth)
        what = f"slosh in a dish {2 * radius} wide (Thacker): period; swing after 3 to 4 periods"
        rows.append((what, f"{found.period:.3f}; {found.left:.2f}", "1; 1"))
    for arm, wall, gap, depth in VESSELS:
        found = forms.vessels(arm, wall, gap, depth)
        tube = f"U-tube, arms {arm} wide and {depth} high, duct {wall} × {gap}"
        rows.append((f"{tube}: period over 2π√inertia", f"{found.period:.3f}", "1"))
    return rows


def bodies() -> list[tuple]:
    """The same for rigid bodies that shift."""
    rows = []
    for density in (0.3, 0.5, 0.7, 0.9):
        on, off = forms.draft(density), forms.draft(density, (16.3, 16.1))
        rows.append(("draft of a cube of 6 cells over its side; off the grid", f"{on:.4f}; {off:.4f}", f"{density}"))
    for name, size, density, flat, width, fine in BOBBING:
        exact = forms.swings(heave.bobbing(size[0], size[2] * density, width, 12, flat=flat, fine=fine), size[2] * density)
        found = forms.bobbing(density, size, cells=width, flat=flat, updates=240)
        told = [
            f"{one.fall:.2f}; {one.period:.2f}; " + ", ".join(f"{turn:.2f}" for turn in one.turns[:2]) for one in (found, exact)
        ]
        rows.append((f"{name} bobbing: first fall and period over those of its mass alone; turning points of 1", *told))
    lift, inside = forms.hull()
    rows.append(
        ("dry hull, bottom 6 below the surface: lift over Archimedes'; liquid inside", f"{lift:.5f}; {inside:.0f}", "1; 0")
    )
    along, aside = forms.carried()
    rows.append(("bore of 6 over 8 cells carries a float in 20: cells along; aside", f"{along:.1f}; {aside:.2f}", ""))
    stone = forms.stone()
    rows.append(("stone of radius 5, fallen from 12 into 20: crest; trough", f"{stone.crest:.1f}; {stone.trough:.1f}", ""))
    rows.append(("the same: units lost", f"{stone.lost}", "0"))
    return rows


def growth(
    inertia: float, turn: float, yielding: float, dt: float = 0.1, overfull: float = 0.15, mean_over: float = 16.0
) -> float:
    """Growth in an update of a roof of mass 1 on a spring, above a full span, by (W6).

    Args:
        inertia: of the liquid that it moves.
        turn: frequency of the roof times dt.
        yielding: 1/M of (W6).
    """

    def update(state):
        down, speed, moved, excess, flow, rest = state
        phi = ((overfull * excess + moved - flow * dt) / dt**2 + yielding * rest) / (1 / inertia + yielding)
        flow += phi * dt / inertia
        if turn > 0:
            middle = -phi * dt**2 / turn**2
            there, swing = (down - middle) * np.cos(turn), speed * dt / turn * np.sin(turn)
            now = middle + there + swing
            speed = speed * np.cos(turn) - (down - middle) * turn / dt * np.sin(turn)
        else:
            now = down + speed * dt - 0.5 * phi * dt**2
            speed -= phi * dt
        return now, speed, now - down, excess - flow * dt + now - down, flow, rest + (phi - rest) / mean_over

    return float(np.abs(np.linalg.eigvals(np.array([update(row) for row in np.eye(6)]).T)).max())


def coupling() -> list[tuple]:
    """Rows of how a vibrating roof grows in an update."""
    return [
        (yielding, inertia, " ".join(f"{growth(inertia, turn, yielding):.3f}" for turn in (0, 0.1, 0.5, 1, 2, 3, 5, 10)))
        for yielding in (1, 4, 16)
        for inertia in (0.1, 1, 10, 100)
    ]


def basin(cells: int, depth: int, obstacles: bool) -> lab.Waves:
    """A basin of cells^2 columns with a small swell from its middle."""
    w = lab.Waves((64, cells, cells))
    if obstacles:
        part = np.zeros(w.shape, int)
        third, sixth = cells // 3, cells // 6
        part[: depth // 2, third : third + sixth, third : third + sixth] = 4096
        part[depth - 2 : depth + 2, :sixth, :third] = 4096
        part[:depth, -sixth:, -sixth:] = 1500
        w.solids(part)
    x = np.arange(cells) + 0.5 - cells / 2
    w.pour(depth + 0.3 * np.exp(-(x[None, :] ** 2 + x[:, None] ** 2) / 30))
    w.update(5)
    return w


def cost(rounds: int = 5) -> list[tuple]:
    """Rows of basin, milliseconds of an update, nanoseconds a column, iterations of the solver."""
    rows = []
    for cells in (128, 512):
        for depth in (5, 20):
            for name, obstacles, bed in (("", False, 0.0), (", rough", False, 0.02), (", obstacles", True, 0.0)):
                w = basin(cells, depth, obstacles)
                w.set(bed=bed)
                count = 20 if cells == 128 else 3
                before = w.counts
                seconds = min(w.update(count) / count for _ in range(rounds))
                iterations = (w.counts.iterations - before.iterations) / (w.counts.solutions - before.solutions)
                goal = {128: "≤ 2", 512: "≤ 40"}[cells]
                rows.append((f"{cells}², depth {depth}{name}", 1e3 * seconds, goal, 1e9 * seconds / cells**2, iterations))
    w = basin(128, 20, False)
    w.set(calm=1.0)
    while not w.at_rest:
        w.update(50)
    rows.append(("128², at rest", 1e3 * min(w.update(1000) for _ in range(rounds)) / 1000, "", 0.0, 0.0))
    return rows


TABLES = {
    "forms": (["what", "found", "closed form"], closed_forms),
    "bodies": (["what", "found", "expected"], bodies),
    "coupling": (["1/M", "a", "growth for ωΔt = 0, 0.1, 0.5, 1, 2, 3, 5, 10"], coupling),
    "cost": (["columns", "ms an update", "goal", "ns a column", "iterations"], cost),
}


def table(which: str, *arguments) -> str:
    """One of them, measured now."""
    head, rows = TABLES[which]
    return markdown(head, rows(*arguments))


def main(which: str = "") -> None:
    """Measure and print."""
    for name in [which] if which else TABLES:
        print(table(name), end="\n\n", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
