# SPDX-License-Identifier: GPL-2.0-only
"""All hard cases: the one table that tests, `make soak` and bench/stability.py go through."""

import contacts
import liquids
import solids

CASES = [*contacts.CASES, *solids.CASES, *liquids.CASES]
