# SPDX-License-Identifier: GPL-2.0-only
"""Objects that touch each other, and the law by which planes push them back."""
