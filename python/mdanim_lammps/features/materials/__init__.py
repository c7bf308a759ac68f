# SPDX-License-Identifier: GPL-2.0-only
"""Materials by name: settings of objects that follow from what they are made of (docs/materials.md)."""
