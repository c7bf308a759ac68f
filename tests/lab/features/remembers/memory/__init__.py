# SPDX-License-Identifier: GPL-2.0-only
"""A feature that only tests know: forces depend on the history of particles and of pairs of objects (tests/lab/plugin)."""
