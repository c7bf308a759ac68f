# SPDX-License-Identifier: GPL-2.0-only
"""Sheets against closed forms, and the energy of a fall: ``python bench/sheets.py [closed|bends|stays|falls|cost]``.

The tables are those of docs/physics-sheets.md; scenes and closed forms are in tests/lab/sheet_cases.py.
"""

import sys
import time
from contextlib import ExitStack
from pathlib import Path

from mdanim_lammps.engine.instance import Instance
from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import bend_cases
import sheet_cases
from rope_cases import DOWN, made


def closed() -> tuple[list[str], list[list]]:
    """All cases that have a closed form."""
    rows = []
    for name, (case, most) in sheet_cases.CASES.items():
        found, expected = case()
        off = 100.0 * (found / expected - 1.0 if expected else found)
        rows.append([name, f"{found:.4g}", f"{expected:.4g}", f"{off:+.2f} %", f"{100 * most:g} %"])
        print(rows[-1], flush=True, file=sys.stderr)
    return ["case", "found", "closed form", "off by", "at most"], rows


def falls() -> tuple[list[str], list[list]]:
    """Energy that a sheet gains or loses where it falls flat on the ground from 0.5 m, over that of the fall."""
    return ["friction", "energy, over that of the fall"], [[mu, f"{sheet_cases.fall(mu):+.1e}"] for mu in (0.0, 0.3)]


def bends() -> tuple[list[str], list[list]]:
    """Springs of rods, and an energy of the angle between triangles: how a strip yields, over what a plate does."""
    rows = []
    for size, h in (((0.5, 0.1), 0.01), ((0.5, 0.1), 0.005), ((0.5, 0.05), 0.01)):
        for kind in ("rods", "angles"):
            found = sheet_cases.bends(kind, size, h)
            rows.append([f"{size[0]} m by {size[1]} m, h {h} m", kind, f"{found['force']:.3f}", f"{found['couple']:.3f}"])
    return ["strip", "bending by", "force at its end", "couple about its length"], rows


def stays() -> tuple[list[str], list[list]]:
    """Strips that are bent all at once, and not across, and the curvature that they keep."""
    rows = []
    for e, times in ((0.003, 1.5), (0.003, 2.0), (0.003, 4.0), (0.01, 2.0), (0.01, 4.0)):
        for axis, name in enumerate("xy"):
            yields = bend_cases.plastic(e)
            found = bend_cases.kept(bend_cases.strip(e, axis), times * yields, axis)
            closed = [form(times * yields, yields, axis) for form in (bend_cases.by_law, bend_cases.by_section)]
            turn = 180.0 / 3.141592653589793 * times * yields * 2.5e-3
            off = [f"{100.0 * (found / one - 1.0):+.1f} %" for one in closed]
            rows.append([f"along {name}, e = {e}", f"{times:g} k_p, {turn:.0f} degrees a link", f"{found:.4g}", *off])
    return ["strip", "bent to", "keeps [1/m]", "over the law", "over a section"], rows


def cost() -> tuple[list[str], list[list]]:
    """Processor time of a step per spring of a sheet and a solid of about as many springs, both damped: the least of many."""
    texts = {
        "sheet": sheet_cases.sheet("(1, 1)", "2 mm", "elasticity 1 MPa  damping 0.1  resolution 1.5 cm"),
        "solid": "object block { shape box (1, 0.5, 0.5) m  position (0, 0, 0) m  density 1000 kg/m^3  elasticity 1 MPa"
        "  damping 0.1  resolution 4 cm }\n",
    }
    ready = {name: made(DOWN + text) for name, text in texts.items()}
    with ExitStack() as opened:
        open_ones = {name: opened.enter_context(Instance(one.plan)) for name, one in ready.items()}
        least = dict.fromkeys(texts, float("inf"))
        for instance in open_ones.values():
            instance.setup()
        for _ in range(60):
            for name, instance in open_ones.items():
                begun = time.process_time()
                instance.run(100)
                least[name] = min(least[name], (time.process_time() - begun) / 100)
    springs = {name: len(one.system.spring) for name, one in ready.items()}
    return ["object", "springs", "ns per spring"], [
        [name, springs[name], f"{1e9 * least[name] / springs[name]:.2f}"] for name in texts
    ]


TABLES = {"closed": closed, "bends": bends, "stays": stays, "falls": falls, "cost": cost}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
