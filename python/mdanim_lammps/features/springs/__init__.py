# SPDX-License-Identifier: GPL-2.0-only
"""Elasticity: springs between neighbours in a solid, and what a lattice of them bears."""
