# SPDX-License-Identifier: GPL-2.0-only
"""Held parts that move: drives, and paths through keys."""
