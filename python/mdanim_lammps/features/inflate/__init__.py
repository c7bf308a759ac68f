# SPDX-License-Identifier: GPL-2.0-only
"""Gas in closed sheets: balloons, balls, air mattresses (docs/physics-inflate.md)."""
