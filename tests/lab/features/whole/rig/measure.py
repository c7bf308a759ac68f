# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of the rig for ``expect``."""

MEASURES = {("rig", "work"): lambda m, e: m.at(m.ledger("work"), e.time)}
