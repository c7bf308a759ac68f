# SPDX-License-Identifier: GPL-2.0-only
"""Solids as particles and springs."""
