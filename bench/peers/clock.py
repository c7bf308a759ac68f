# SPDX-License-Identifier: GPL-2.0-only
"""Common parts of peers: steps until the simulated time or the limit is over, and the figures as JSON."""

import json
import sys
import time
from collections.abc import Callable


def run(step: Callable[[int], None], dt: float, duration: float, limit: float, chunk: int) -> dict:
    """Take steps in chunks; processor seconds of all threads per simulated second.

    ``extrapolated`` tells that the limit came before the duration.
    """
    step(1)  # what a program does once, compiling included, is not counted
    total, done, start = max(2, round(duration / dt)) - 1, 0, time.process_time()
    while done < total and time.process_time() - start < limit:
        count = min(chunk - (1 + done) % chunk, total - done)  # to the next whole number of chunks, where frames end
        step(count)
        done += count
    spent = time.process_time() - start
    return {"dt": dt, "steps": done, "cost": spent / (done * dt), "extrapolated": done < total}


def tell(**figures) -> None:
    """The last line of a peer's output."""
    print(json.dumps(figures))


def words() -> tuple[str, dict]:
    """Scene and its numbers, from the command line: ``NAME.py SCENE JSON``."""
    return sys.argv[1], json.loads(sys.argv[2])
