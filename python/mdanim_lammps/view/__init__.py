# SPDX-License-Identifier: GPL-2.0-only
"""Seeing a run in a browser, while it goes on and after, and as one file (docs/view.md)."""
