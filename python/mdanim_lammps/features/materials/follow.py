# SPDX-License-Identifier: GPL-2.0-only
"""Consequences of materials: settings of objects, and texts of ``explain``."""

from __future__ import annotations

from .page import explained
from .resolve import fill

__all__ = ["explained", "fill"]
