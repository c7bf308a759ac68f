# SPDX-License-Identifier: GPL-2.0-only
"""How a colour is written: a name of CSS (CSS Color Module Level 4, sec. 6.1), or ``#rrggbb``."""

from __future__ import annotations

import re

from .keywords import did_you_mean


def color(text: str) -> str:
    """A colour as ``#rrggbb``; raises ValueError(message, hint)."""
    if re.fullmatch(r"#[0-9a-fA-F]{6}", text):
        return text.lower()
    from PIL import ImageColor  # loaded for names alone: a tenth of the time to a plan

    if text.lower() in ImageColor.colormap:
        return "#{:02x}{:02x}{:02x}".format(*ImageColor.getrgb(text.lower()))
    hint = did_you_mean(text, ImageColor.colormap) or 'write a CSS name such as steelblue, or "#rrggbb"'
    raise ValueError(f"'{text}' is not a colour", hint)
