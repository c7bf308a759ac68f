# SPDX-License-Identifier: GPL-2.0-only
"""Welds of rigid objects in the file of glue of ``fix mdanim/rigid``."""

from __future__ import annotations

from collections.abc import Iterator

from ...effects.context import Context
from ...scene.formatting import in_full
from .links import links_of
from .welds import hung_by, welds_here


def lines(context: Context) -> Iterator[str]:
    """A line for each weld that the bodies of a context need; one that closes a ring is none."""
    number = {name: m + 1 for m, name in enumerate(context.system.names)}
    solids = context.scene.solids
    needed = hung_by(links_of(context.scene)) if context.scene.joints else {}
    for link in welds_here(context):
        if link.number in needed:
            one, other = sorted(number[solids[m].name] for m in link.ends)
            yield f"{one} {other} weld {in_full(link.begin)}\n"
