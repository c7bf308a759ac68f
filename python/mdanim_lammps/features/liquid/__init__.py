# SPDX-License-Identifier: GPL-2.0-only
"""A liquid in its basin, lift, push and drag of it on solids."""
