# SPDX-License-Identifier: GPL-2.0-only
"""Cost of accuracy in time: ladders of settings around a scene's own, their errors and seconds (docs/accuracy.md)."""
