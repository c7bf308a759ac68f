# SPDX-License-Identifier: GPL-2.0-only
"""What accuracy costs in time: ladders of settings around a scene's own, their errors and seconds (docs/accuracy.md)."""
