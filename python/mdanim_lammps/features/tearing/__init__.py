# SPDX-License-Identifier: GPL-2.0-only
"""Tearing: springs that are gone for good where they are stretched too far (docs/physics-ropes.md, "Tearing")."""
