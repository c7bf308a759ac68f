# SPDX-License-Identifier: GPL-2.0-only
"""What follows from materials: settings of objects, and what ``explain`` says of each."""

from __future__ import annotations

from .page import explained
from .resolve import fill

__all__ = ["explained", "fill"]
