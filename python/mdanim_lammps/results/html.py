# SPDX-License-Identifier: GPL-2.0-only
"""What notebooks show of scenes and runs."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence

THUMBNAIL = (480, 270)
"""Pixels of pictures in notebooks."""


def html_table(title: str, heads: Sequence[str], rows: Iterable[Sequence], picture: bytes | None = None, most: int = 20) -> str:
    """A table with a title, and a PNG before it; of many rows the first ones."""
    rows = list(rows)
    line = lambda cells, tag: "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"
    more = f"<p>… and {len(rows) - most} more</p>" if len(rows) > most else ""
    image = f'<img src="data:image/png;base64,{base64.b64encode(picture).decode()}"/>' if picture else ""
    body = "".join(line(row, "td") for row in rows[:most])
    return f"<p><b>{html.escape(title)}</b></p>{image}<table>{line(heads, 'th')}{body}</table>{more}"
