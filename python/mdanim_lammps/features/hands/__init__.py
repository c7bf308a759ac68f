# SPDX-License-Identifier: GPL-2.0-only
"""Hands that pull at points of objects: as a scene says, or as a page asks while the run goes on."""
