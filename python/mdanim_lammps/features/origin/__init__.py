# SPDX-License-Identifier: GPL-2.0-only
"""Objects from files, placed by the origin of the file."""
