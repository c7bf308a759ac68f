# SPDX-License-Identifier: GPL-2.0-only
"""Runs on several executors: `plan` decides, `runtime` starts processes and carries states and messages."""
