# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of contact that ``expect`` can ask for."""

MEASURES = {("penetration", "max"): lambda m, e: m.penetration}
