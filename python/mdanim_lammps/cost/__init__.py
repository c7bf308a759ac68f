# SPDX-License-Identifier: GPL-2.0-only
"""What a run will cost on this machine, and what executors will bring."""
