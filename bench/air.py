# SPDX-License-Identifier: GPL-2.0-only
"""Objects in air against closed forms: ``python bench/air.py [closed|cost]``.

The tables are those of docs/physics-air.md; scenes and closed forms are in tests/lab/air_cases.py.
"""

import sys
from pathlib import Path

from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import air_cases


def closed() -> tuple[list[str], list[list]]:
    """All cases that have a closed form."""
    rows = []
    for name, (case, most) in air_cases.CASES.items():
        found, expected = case()
        rows.append([name, f"{found:.4g}", f"{expected:.4g}", f"{100 * (found / expected - 1):+.2f} %", f"{100 * most:g} %"])
    return ["case", "found", "closed form", "off by", "at most"], rows


TABLES = {"closed": closed}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
