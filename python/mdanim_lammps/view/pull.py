# SPDX-License-Identifier: GPL-2.0-only
"""Pulling at objects from the page, with ``--hands`` only: what the page says is written into one file of the output folder. The
run reads it before each frame (run/hands.py)."""

from __future__ import annotations

import json
import threading
import time
from contextlib import suppress

import numpy as np

from ..errors import OutputError
from ..results.files import HAND, write_whole
from .tail import Tail

LEAST = 0.01
"""Wall time between two words of a page on its hand [s]: more of them wait."""
FARTHEST = 1e9
"""From the origin [m]."""


class Puller:
    """The hand on a run; one page has it at a time.

    Args:
        tail: of the run.
    """

    def __init__(self, tail: Tail):
        self._tail = tail
        self._turn = threading.Lock()
        self._owner: object = None
        self._last = 0.0

    def pull(self, page: object, asked: dict | None) -> None:
        """Move the hand of a page, or let go with None. What another page asks for meanwhile is left out.

        ``asked`` has ``object``, its number; ``vertex`` and ``weight``, three vertices and the weights with which the point is
        their mean; ``to``, the place of the hand [m]. Raises ValueError, KeyError, TypeError for anything else, OutputError, also
        as long as there is no frame.
        """
        told = None if asked is None else self._told(asked)
        with self._turn:
            if self._owner not in (None, page) or not self._tail.live:
                return
            if told is None:
                if self._owner is page:
                    self._let_go()
                return
            time.sleep(max(0.0, min(LEAST, self._last + LEAST - time.monotonic())))
            self._owner, self._last = page, time.monotonic()
            # The next frame alone reads it.
            write_whole(self._tail.folder / HAND, json.dumps(told, allow_nan=False), lasting=False)

    def gone(self, page: object) -> None:
        """A page is gone: what it held is let go."""
        with self._turn:
            if self._owner is page:
                self._let_go()

    def _let_go(self) -> None:
        self._owner = None
        with suppress(OSError):
            (self._tail.folder / HAND).unlink(missing_ok=True)

    def _told(self, asked: dict) -> dict:
        """For the run: the point is where it is at the start."""
        feed = self._tail.feed()
        m = asked["object"]
        if type(m) is not int or not 0 <= m < len(feed.first):
            raise ValueError(m)
        vertex, weight, to = asked["vertex"], numbers(asked["weight"]), numbers(asked["to"])
        first, count = int(feed.first[m]), int(feed.count[m])
        if (
            not isinstance(vertex, list)
            or len(vertex) != 3
            or any(type(v) is not int or not first <= v < first + count for v in vertex)
        ):
            raise ValueError(vertex)
        if min(weight) < 0.0 or not abs(sum(weight) - 1.0) < 1e-3:
            raise ValueError(weight)
        if (frames := self._tail.count) == 0:
            raise OutputError("there is no frame yet; pull when the first one is seen")
        at = np.array(weight) / sum(weight) @ feed.start[vertex]
        way = feed.way(frames - 1)
        return {"object": feed.metadata.names[m], "at": at.tolist(), "to": (np.array(to) + way).tolist()}


def numbers(value: object) -> list[float]:
    """Three numbers that may be places. Raises ValueError."""
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError(value)
    if not all(type(x) in (int, float) and abs(x) <= FARTHEST for x in value):
        raise ValueError(value)
    return [float(x) for x in value]
