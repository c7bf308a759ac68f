# SPDX-License-Identifier: GPL-2.0-only
"""Joints that connect objects with each other and with the world: welds, balls, hinges, sliders and springs."""
