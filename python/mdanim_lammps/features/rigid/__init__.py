# SPDX-License-Identifier: GPL-2.0-only
"""Rigid bodies: objects that move as a whole and do not deform."""
