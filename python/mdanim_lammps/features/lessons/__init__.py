# SPDX-License-Identifier: GPL-2.0-only
"""A question that a scene asks, and its answer, for the page of a lesson."""
