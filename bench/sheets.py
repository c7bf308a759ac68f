# SPDX-License-Identifier: GPL-2.0-only
"""Sheets against closed forms, and the energy of a fall: ``python bench/sheets.py [closed|falls]``.

The tables are those of docs/physics-sheets.md; scenes and closed forms are in tests/lab/sheet_cases.py.
"""

import sys
from pathlib import Path

from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import sheet_cases


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


TABLES = {"closed": closed, "falls": falls}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
