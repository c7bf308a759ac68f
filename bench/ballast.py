# SPDX-License-Identifier: GPL-2.0-only
"""Solids with ballast against closed forms: ``python bench/ballast.py [closed]``.

The table is that of docs/physics-solids.md, "Ballast"; scenes and closed forms are in tests/lab/ballast_cases.py.
"""

import sys
from pathlib import Path

from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import ballast_cases
from air_cases import closed_rows

TABLES = {"closed": lambda: closed_rows(ballast_cases.CASES)}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
