# SPDX-License-Identifier: GPL-2.0-only
"""A box that objects never leave."""
