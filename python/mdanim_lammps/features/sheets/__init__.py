# SPDX-License-Identifier: GPL-2.0-only
"""Sheets, as cloth, paper and trampolines: layers of particles that pull, bend and touch (docs/physics-sheets.md)."""
