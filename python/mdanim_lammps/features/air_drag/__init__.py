# SPDX-License-Identifier: GPL-2.0-only
"""Drag of air at rest."""
