# SPDX-License-Identifier: GPL-2.0-only
"""Sheets, ropes and the surfaces of solids touch each other and themselves (docs/physics-folds.md)."""
