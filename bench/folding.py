# SPDX-License-Identifier: GPL-2.0-only
"""The least speed of a landing over c after which cells stay inside out: prints the table of docs/physics-solids.md.

python bench/folding.py [ROW ...]    rows out of ball, ellipsoid, cylinder, edge, corner, cone; without one all, ten minutes
"""

from __future__ import annotations

import math
import sys
import tempfile
from pathlib import Path

from mdanim_lammps.errors import DivergedError
from mdanim_lammps.results.files import read_json
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

H, C, MOST = 0.03, math.sqrt(1.2 * 360e3 / 1000), 30
"""Spacing [m], wave speed [m/s], fastest landing tried [c/100]."""

# Rows: numbers of cells across, then for a width d the shape, the height of its middle at a touch, its orientation.
ROWS = {
    "ball": ((4, 5, 6, 7, 8, 9, 10, 12, 14, 16), lambda d: (f"sphere {d / 2}", d / 2, "euler (0, 0, 0) deg")),
    "ellipsoid": ((4, 5, 6, 7), lambda d: (f"ellipsoid ({d / 2}, {d / 2}, {d})", d, "euler (0, 0, 0) deg")),
    "cylinder": ((4, 6, 8), lambda d: (f"cylinder {d / 2} {2 * d}", d / 2, "euler (90, 0, 0) deg")),
    "edge": ((4, 6, 8), lambda d: (f"box ({d}, {d}, {d})", d / math.sqrt(2.0), "euler (45, 0, 0) deg")),
    "corner": ((4, 6, 8), lambda d: (f"box ({d}, {d}, {d})", d * math.sqrt(0.75), "euler (45, 35.2644, 0) deg")),
    "cone": ((4, 6, 8), lambda d: (f"cone {d / 2} {d}", 0.75 * d, "euler (180, 0, 0) deg")),
}

SCENE = """ground z 0
object body {{
  shape {shape}
  position (0, 0, {height})
  orientation {orientation}
  density 1000
  elasticity 360 kPa
  velocity (0, 0, -{speed})
}}
control {{ time 0.6 s  frames 100 fps  resolution {h} m }}
"""


def folds(make, cells: int, speed: float) -> bool:
    """Whether cells stay inside out after a landing at this part of the wave speed."""
    shape, height, orientation = make(cells * H)
    text = SCENE.format(shape=shape, height=height + 2.0 * H, orientation=orientation, speed=speed * C, h=H)
    with tempfile.TemporaryDirectory() as folder:
        try:
            simulate(prepare(parse_scene(text)), Path(folder))
        except DivergedError:  # a body is crumpled
            return True
        return bool(read_json(Path(folder) / "summary.json")["dents"])


if __name__ == "__main__":
    for row in sys.argv[1:] or ROWS:
        counts, make = ROWS[row]
        print(f"| {row} |", end="", flush=True)
        for cells in counts:
            least = next((s for s in range(3, MOST + 1) if folds(make, cells, s / 100)), None)
            print(f" {cells}: {f'{least / 100:.2f}' if least else f'> {MOST / 100}'} |", end="", flush=True)
        print()
