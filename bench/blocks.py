# SPDX-License-Identifier: GPL-2.0-only
"""Blocks that bodies are cut into for passes: ``python bench/blocks.py [lanes]``, counted by the classes of plugin/passes.

Entries for each particle; lanes of entries that have springs; shares of all entries that have a spring in one lane only, that are
in strips, that are three in one go there, and that push some particles the entry before pushes, too. Builds the test library.
"""

import sys
from itertools import pairwise
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import engine_lab
import numpy as np
from step import HEAD
from timing import markdown
from widths import BODIES

LANES = 8
COLUMNS = ("entries a particle", "lanes in use", "one lane", "in strips", "in threes", "overlapping")


def count(text: str, lanes: int) -> list[float]:
    """The figures of one scene, in the order of COLUMNS."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    plan = prepare(parse_scene(HEAD + text)).plan
    particles, springs = plan.system.particles, np.sort(plan.bonds, 1)
    blocks = engine_lab.cut(lanes, particles, springs, np.ones((len(springs), 3)), plan.system.object + 1)
    used, one, strips, threes, overlapping, strip = 0, 0, 0, 0, 0, 1
    for block in blocks:
        strip = block.strip or strip
        lanes_of = [int(np.count_nonzero(entry.coeffs[0])) for entry in block.entries]
        used, one = used + sum(lanes_of), one + lanes_of.count(1)
        steps = [a.offset - b.offset for a, b in pairwise(block.entries)]
        overlapping += sum(step < lanes for step in steps)
        if strip > 1:
            strips += len(block.entries)
            threes += 3 * sum(pair == (1, 1) for pair in pairwise(steps))
    entries = sum(len(block.entries) for block in blocks)
    return [entries / particles, used / (entries * lanes), *(n / entries for n in (one, strips, threes, overlapping))]


def main(lanes: int = LANES) -> None:
    """Print the table in Markdown."""
    bodies = {name: text for name, text in BODIES.items() if "damped" not in name and "60" not in name}
    print(markdown(["bodies", *COLUMNS], [(name, *count(text, lanes)) for name, text in bodies.items()]))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
