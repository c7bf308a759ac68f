# SPDX-License-Identifier: GPL-2.0-only
"""Processes, messages and live instances of a run on several executors."""
