# SPDX-License-Identifier: GPL-2.0-only
"""The log of a run on executors in the Trace Event Format, which Perfetto (ui.perfetto.dev) and chrome://tracing open."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from ..errors import OutputError
from .files import write_whole
from .overwriting import MADE
from .timeline import Timeline

EXECUTORS, OBJECTS = 1, 2
"""Numbers of the two processes of the trace: its threads are the executors, and the objects."""


def write_trace(timeline: Timeline, path: Path, title: str = "") -> None:
    """Write the trace. Raises OutputError when it cannot be written, or a run ended before it began."""
    if not timeline.frames:
        raise OutputError(f"{path.parent}: the run ended before its first frame, there is nothing to show")
    about = {"title": title, "executors": timeline.executors, "control": timeline.control, "software": MADE}
    # Event by event: a long run has millions.
    events = ",\n".join(json.dumps(event, ensure_ascii=False) for event in trace_events(timeline))
    write_whole(path, f'{{"otherData": {json.dumps(about)}, "displayTimeUnit": "ms", "traceEvents": [\n{events}\n]}}\n')


def trace_events(timeline: Timeline) -> Iterator[dict]:
    """Names of executors and objects; spans of executors and of owners; frames, objects moved and windows begun
    again over time."""
    yield _name("process_name", EXECUTORS, 0, "executors")
    yield _name("process_name", OBJECTS, 0, "owners of objects")
    for executor, busy in enumerate(timeline.busy()):
        yield _name("thread_name", EXECUTORS, executor, f"executor {executor}: simulating {100 * busy:.0f} %")
    for executor, kind, frame, begin, end in timeline.spans:
        yield _span(EXECUTORS, executor, kind, begin, end) | {"args": {"frame": frame}}
    ends = timeline.frame_ends()
    for frame, moves, retries in zip(timeline.frames, timeline.moves, timeline.retries):
        at = {"pid": EXECUTORS, "tid": 0, "ts": _ticks(ends.get(frame, 0.0))}
        yield {"ph": "i", "s": "p", "name": f"end of frame {frame}", **at}
        for name, count in (("objects moved", moves), ("windows begun again", retries)):
            yield {"ph": "C", "name": name, "args": {name: count}, **at}
    yield from _owners(timeline, ends)


def _owners(timeline: Timeline, ends: dict[int, float]) -> Iterator[dict]:
    """For each object the stretches of time in which it was one executor's, from the end of a frame to that of another."""
    changes: dict[int, list[tuple[float, int]]] = {}
    for frame, m, executor in timeline.owners:
        changes.setdefault(m, []).append((ends.get(frame, 0.0), executor))
    for m, stretches in changes.items():
        yield _name("thread_name", OBJECTS, m, timeline.names[m])
        for (begin, executor), (end, _) in pairwise([*stretches, (timeline.seconds, -1)]):
            if executor >= 0:
                yield _span(OBJECTS, m, f"executor {executor}", begin, end)


def _name(what: str, process: int, thread: int, name: str) -> dict:
    return {"ph": "M", "name": what, "pid": process, "tid": thread, "args": {"name": name}}


def _span(process: int, thread: int, name: str, begin: float, end: float) -> dict:
    return {"ph": "X", "name": name, "pid": process, "tid": thread, "ts": _ticks(begin), "dur": _ticks(end) - _ticks(begin)}


def _ticks(seconds: float) -> int:
    """Whole microseconds: spans that follow each other meet, as viewers ask."""
    return round(1e6 * seconds)
