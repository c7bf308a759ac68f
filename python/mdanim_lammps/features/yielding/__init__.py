# SPDX-License-Identifier: GPL-2.0-only
"""Yielding: springs whose rest length follows where they bear too much (docs/physics-yielding.md)."""
