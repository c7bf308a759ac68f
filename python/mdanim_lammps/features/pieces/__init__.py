# SPDX-License-Identifier: GPL-2.0-only
"""Rigid objects that are cut into pieces, which glue holds together until its strength is reached (docs/physics-pieces.md)."""
