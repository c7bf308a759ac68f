# SPDX-License-Identifier: GPL-2.0-only
"""A run: from a scene to its model, frame by frame, and what stops it."""
