# SPDX-License-Identifier: GPL-2.0-only
"""The goals of docs/performance.md beside all processors that were measured: ``python bench/processors.py``.

``python bench/all.py --write`` keeps what it found on a processor in docs/performance.json, under the processor's name.
"""

import json
from collections.abc import Callable
from pathlib import Path

from timing import markdown

FIGURES = Path(__file__).resolve().parent.parent / "docs" / "performance.json"
CUBE = "cube of 30^3"


def row(found: dict, part: str, **wanted: object) -> dict:
    """The first row of a part that has all of these values; empty if none has."""
    rows = found.get(part, {}).get("rows", [])
    return next((r for r in rows if all(r.get(k) == v for k, v in wanted.items())), {})


def fastest(found: dict, scene: str) -> dict:
    """The row of our fastest instruction set in a scene."""
    rows = [r for r in found.get("step", {}).get("rows", []) if r["scene"] == scene and r["contender"].startswith("ours, ")]
    return min(rows, key=lambda r: r["least"], default={})


def over_limit(found: dict, limit: str) -> float | None:
    """Least time of the cube's step over a limit of the machine."""
    cube = fastest(found, CUBE)
    return cube["least"] / cube["limits"][limit] if limit in cube.get("limits", {}) else None


def beside_cube(found: dict, scene: str) -> float | None:
    """Times as fast as stock in a scene, over the cube's."""
    cube, other = fastest(found, CUBE), fastest(found, scene)
    return other["faster"]["medians"] / cube["faster"]["medians"] if cube and other else None


def alone(found: dict, effect: str) -> float | None:
    """Least time of a step with an effect over one of springs alone."""
    return row(found, "alone", effect=effect).get("over", {}).get("minima")


def pressed(found: dict, meeting: str) -> float | None:
    """Time of a step of two pressed blocks of 12³ cells over that of the same apart, by the law of surfaces."""
    return row(found, "pressed", cells=12, law="surface", meeting=meeting).get("ratio", {}).get("medians")


LINES: dict[str, tuple[str, Callable[[dict], float | None]]] = {
    "cube of 30³: ns per particle-step, minimum": ("", lambda f: fastest(f, CUBE).get("least")),
    "times as fast as stock, by medians": ("6.5 Zen 4, 5.5 Intel", lambda f: fastest(f, CUBE).get("faster", {}).get("medians")),
    "times as fast as stock, by minima": ("", lambda f: fastest(f, CUBE).get("faster", {}).get("minima")),
    "over the limit of roots": ("≤ 1.6", lambda f: over_limit(f, "roots")),
    "over the limit of loads and stores": ("", lambda f: over_limit(f, "loads and stores")),
    "sphere's times as fast as stock, over the cube's": ("≥ 0.9", lambda f: beside_cube(f, "sphere of 27 000")),
    "the same of 27 blocks": ("≥ 0.9", lambda f: beside_cube(f, "27 blocks of 10^3")),
    "damping, over springs alone": ("≤ 1.4", lambda f: alone(f, "+ damping")),
    "air drag": ("≤ 1.15", lambda f: alone(f, "+ air drag")),
    "ground": ("≤ 1.1", lambda f: alone(f, "+ gravity, ground")),
    "walls": ("≤ 1.2", lambda f: alone(f, "+ gravity, walls")),
    "liquid with `surface`": ("≤ 2", lambda f: alone(f, "+ gravity, liquid, buoyancy")),
    "blocks of 12³ pressed by weight, over apart": ("≤ 1.4", lambda f: pressed(f, "rest")),
    "the same pressed by a blow": ("≤ 1.6", lambda f: pressed(f, "blow")),
}
"""Lines of the table: the goal, and where the figure is found."""


def table(processors: dict[str, dict]) -> str:
    """In Markdown: a line for each goal, a column for each processor."""
    found = [[line(parts) for parts in processors.values()] for _, line in LINES.values()]
    return markdown(
        ["", "goal", *processors],
        [
            (name, goal, *("not told" if v is None else v for v in values))
            for (name, (goal, _)), values in zip(LINES.items(), found)
        ],
    )


if __name__ == "__main__":
    print(table(json.loads(FIGURES.read_text())))
