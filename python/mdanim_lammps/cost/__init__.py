# SPDX-License-Identifier: GPL-2.0-only
"""Forecasts of the cost of a run on this machine, and of the gain by executors."""
