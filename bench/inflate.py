# SPDX-License-Identifier: GPL-2.0-only
"""Inflated sheets against closed forms: ``python bench/inflate.py [closed]``.

The table is that of docs/physics-inflate.md; scenes and closed forms are in tests/lab/inflate_cases.py.
"""

import sys
from pathlib import Path

from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import inflate_cases
from air_cases import closed_rows

TABLES = {"closed": lambda: closed_rows(inflate_cases.CASES)}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
