# SPDX-License-Identifier: GPL-2.0-only
"""Scenes and runs as notebooks show them."""

from __future__ import annotations

import base64
import html
from collections.abc import Callable, Iterable, Sequence
from typing import Any

THUMBNAIL = (480, 270)
"""Pixels of pictures in notebooks."""


def html_table(title: str, heads: Sequence[str], rows: Iterable[Sequence], picture: bytes | None = None, most: int = 20) -> str:
    """A table with a title, and a PNG before it; of many rows the first ones."""
    rows = list(rows)
    more = f"<p>… and {len(rows) - most} more</p>" if len(rows) > most else ""
    image = f'<img src="data:image/png;base64,{base64.b64encode(picture).decode()}"/>' if picture else ""
    return f"<p><b>{html.escape(title)}</b></p>{image}{plain_table(heads, rows[:most])}{more}"


def plain_table(
    heads: Sequence, rows: Iterable[Iterable], text: Callable[[Any], str] = lambda cell: html.escape(str(cell))
) -> str:
    """A table, without a row of heads where all are empty; ``text`` gives the HTML of a cell."""
    line = lambda cells, tag: "<tr>" + "".join(f"<{tag}>{text(cell)}</{tag}>" for cell in cells) + "</tr>"
    return f"<table>{line(heads, 'th') if any(heads) else ''}{''.join(line(row, 'td') for row in rows)}</table>"


class CellPage:
    """An HTML page that a notebook shows in a cell, in a frame that can reach nothing else of the notebook.

    Args:
        text: the whole page.
        height: of the frame [pixels].
    """

    def __init__(self, text: str, height: int):
        self.text, self.height = text, height

    def __repr__(self) -> str:
        return f"<a page of {len(self.text) / 1e6:.2g} MB, for a cell of a notebook>"

    def _repr_html_(self) -> str:
        frame = f'width="100%" height="{self.height:d}" style="border: 0" sandbox="allow-scripts allow-downloads"'
        return f'<iframe {frame} srcdoc="{html.escape(self.text)}"></iframe>'


class CellPicture:
    """A picture that a notebook shows in a cell.

    Args:
        png: its file.
    """

    def __init__(self, png: bytes):
        self.png = png

    def __repr__(self) -> str:
        return f"<a picture of {len(self.png) / 1e3:.3g} kB, for a cell of a notebook>"

    def _repr_png_(self) -> bytes:
        return self.png
