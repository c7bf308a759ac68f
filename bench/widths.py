# SPDX-License-Identifier: GPL-2.0-only
"""Time of vectors of each width, beside the limit of this machine: ``python bench/widths.py [rounds]``.

Bodies in free fall with drag of air, as in bench/step.py, and damped ones. All widths take turns. Told is the least processor
time of a particle's step in any of them, what the widest one, which passes take, takes over the best one (the median of ratios of
the same round), and over the limit: the square roots and divisions alone (bench/limits.py), 9 in a particle's step, 18 with
dashpots.
"""

from __future__ import annotations

import statistics
import sys
import time
from contextlib import ExitStack

import limits
from step import HEAD, SCENES, SOLID, WIDTHS, ours, runs_here
from timing import markdown

SOFT = f"{SOLID} damping 0.05"
BALLS = [f"object b{x}{y} {{ shape sphere 4 cm position ({12 * x}, {12 * y}, 0) cm " for x in range(5) for y in range(5)]
BODIES = {
    **SCENES,
    "25 balls of 461": "".join(f"{ball} {SOLID} }}\n" for ball in BALLS),
    "damped cube of 20^3": f"object a {{ shape box (19, 19, 19) cm position (0, 0, 0) {SOFT} }}",
    "25 damped balls of 461": "".join(f"{ball} {SOFT} }}\n" for ball in BALLS),
}
ROUNDS, PARTICLE_STEPS = 31, 1_500_000


def measure(text: str, rounds: int) -> dict[str, list[float]]:
    """Nanoseconds of a particle's step for each width in every round."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    plan = prepare(parse_scene(HEAD + text)).plan
    particles = plan.system.particles
    steps = max(20, PARTICLE_STEPS // particles)
    with ExitStack() as stack:
        run = {w: stack.enter_context(ours(plan, f"verlet/mdanim width {w}")) for w in WIDTHS if runs_here(w)}
        found = {width: [] for width in run}
        for _ in range(rounds):
            for width, go in run.items():
                start = time.process_time()
                go(steps)
                found[width].append(1e9 * (time.process_time() - start) / steps / particles)
    return found


def main(rounds: int = ROUNDS) -> None:
    """Print the table in Markdown."""
    times, roots, rows = {}, float("inf"), []
    for name, text in BODIES.items():
        times[name] = measure(text, rounds)
        roots = min(roots, limits.measure()[0]["roots"])  # at several times, as that of others
    for name, found in times.items():
        damped = "damped" in name
        chosen = next(iter(found))
        least, limit = {width: min(ns) for width, ns in found.items()}, roots * (2 if damped else 1)
        over = max(statistics.median(own / other for own, other in zip(found[chosen], found[width])) for width in found)
        rows.append(
            (
                name,
                *(f"{ns:.1f}" for ns in least.values()),
                chosen,
                f"{100 * (over - 1):.1f} %",
                f"{limit:.1f}",
                f"{least[chosen] / limit:.2f}",
            )
        )
    print("ns per particle-step\n")
    print(markdown(["bodies", *found, "taken", "over the best", "limit", "taken over the limit"], rows))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
