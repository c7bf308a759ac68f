# SPDX-License-Identifier: GPL-2.0-only
"""Forces and torques on objects as a whole, in windows of time."""
