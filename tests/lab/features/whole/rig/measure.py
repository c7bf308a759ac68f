# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of the rig for ``expect``."""

from mdanim_lammps.effects.measured import Measurable

MEASURES = {("rig", "work"): Measurable(lambda m, of: m.ledger("work"))}
