# SPDX-License-Identifier: GPL-2.0-only
"""Internal damping: dashpots along the springs of a solid."""
