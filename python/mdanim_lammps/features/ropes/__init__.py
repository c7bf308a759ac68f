# SPDX-License-Identifier: GPL-2.0-only
"""Ropes and chains: lines of particles that pull, bend and touch (docs/physics-ropes.md)."""
