# SPDX-License-Identifier: GPL-2.0-only
"""A feature that only tests know: crates, bodies of as many cells across as they say, whatever the scene has."""
