# SPDX-License-Identifier: GPL-2.0-only
"""The scene fixture of all that distribute runs."""

from distribution_lab import scene

__all__ = ["scene"]
