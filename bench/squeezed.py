# SPDX-License-Identifier: GPL-2.0-only
"""Stress of a cube that is squeezed by a given way: ``python bench/squeezed.py``.

The table is that of docs/physics-contact.md, "Squeezed by a given way".
"""

import itertools
import sys
import tempfile

from mdanim_lammps import Scene
from mdanim_lammps.features.contact.squeezed import borne
from timing import print_tables

YOUNG, SIDE = 1e6, 10.0
"""[Pa], [cm]"""
CUBE = f"object cube {{ shape box (10, 10, 10) cm  position (0, 0, 5) cm  mass 1 kg  elasticity {YOUNG} Pa  damping 0.5 }}"
PLATE = "object plate {{ shape box (20, 20, 2) cm  position (0, 0, 11) cm  hold all  key {rise} s at (0, 0, {z}) cm }}"
RISE, PARTS = 0.3, (0.01, 0.05)
"""Time in which the plate comes down [s], by parts of the side."""


def stress(cells: int, stiffness: float, part: float) -> float:
    """Mean stress along z at the end [Pa], tension above 0, where the plate comes down by a part of the side."""
    text = (
        f"ground z 0 m\n{CUBE}\n{PLATE.format(rise=RISE, z=11.0 - part * SIDE)}\n"
        f"control {{ time {2 * RISE} s  frames 10 fps  resolution {SIDE / cells} cm  contact-stiffness {stiffness} }}\n"
        "record cube.stress.z\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        run = Scene.from_text(text).run(f"{folder}/out", movie=False, progress=False)
        return float(run.records["cube.stress.z"][-1])


def squeezed() -> tuple[list[str], list[list]]:
    """Stress over Young's modulus times the strain that the plate asks for, and by the formula."""
    rows = []
    for cells, stiffness in itertools.product((4, 8), (1, 4, 16)):
        shares = ((-stress(cells, stiffness, part) / (YOUNG * part), borne(part, cells, stiffness)) for part in PARTS)
        rows.append([cells, stiffness, *(f"{x:.2f}" for pair in shares for x in pair)])
    return ["cells", "contact-stiffness", "by 1 %", "formula", "by 5 %", "formula"], rows


TABLES = {"squeezed": squeezed}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
