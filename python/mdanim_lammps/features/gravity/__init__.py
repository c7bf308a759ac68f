# SPDX-License-Identifier: GPL-2.0-only
"""A uniform field."""
