# SPDX-License-Identifier: GPL-2.0-only
"""Objects in air against closed forms: ``python bench/air.py [closed|cost]``.

The tables are those of docs/physics-air.md; scenes and closed forms are in tests/lab/air_cases.py.
"""

import sys
from pathlib import Path

from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import air_cases

TABLES = {"closed": lambda: air_cases.closed_rows(air_cases.CASES)}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
