# SPDX-License-Identifier: GPL-2.0-only
"""Ropes against closed forms, and the energy of a fall: ``python bench/ropes.py [closed|falls]``.

The tables are those of docs/physics-ropes.md; scenes and closed forms are in tests/lab/rope_cases.py.
"""

import sys
from pathlib import Path

from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import rope_cases


def closed() -> tuple[list[str], list[list]]:
    """All cases that have a closed form."""
    rows = []
    for name, (case, most) in rope_cases.CASES.items():
        found, expected = case()
        rows.append([name, f"{found:.4g}", f"{expected:.4g}", f"{100 * (found / expected - 1):+.2f} %", f"{100 * most:g} %"])
    return ["case", "found", "closed form", "off by", "at most"], rows


def falls() -> tuple[list[str], list[list]]:
    """Energy that a rope gains or loses where it falls flat on the ground from 0.5 m, over that of the fall."""
    return ["friction", "energy, over that of the fall"], [[mu, f"{rope_cases.fall(mu):+.1e}"] for mu in (0.0, 0.3)]


TABLES = {"closed": closed, "falls": falls}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
