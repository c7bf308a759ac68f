# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of the wind for ``expect``."""

MEASURES = {("wind", "work"): lambda m, e: m.at(m.ledger("wind")[0] - m.ledger("wind"), e.time)}
