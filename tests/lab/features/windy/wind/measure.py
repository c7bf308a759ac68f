# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of the wind for ``expect``."""

from mdanim_lammps.effects.measured import Measurable

MEASURES = {("wind", "work"): Measurable(lambda m, of: m.ledger("wind")[0] - m.ledger("wind"))}
