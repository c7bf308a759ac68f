# SPDX-License-Identifier: GPL-2.0-only
"""A feature that only tests know: air that moves presses on everything alike, and a fence that objects are to stay behind."""
