# SPDX-License-Identifier: GPL-2.0-only
"""What the view costs a run, and how soon it answers: python bench/view.py [scene ...]

Processor time of the run's own process, the least of several runs each: alone, while a page asks for all frames of another run
(what another process on the same cores costs anyway), and while the page asks for this run's; what progress.jsonl takes of it;
time from a page's "pause" to the page's knowing.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

from websockets.sync.client import connect

SCENES = Path(__file__).parents[1] / "scenes"
RUNS = 5
PAUSES = 15

RUN = """
import resource, sys, time
from pathlib import Path
from mdanim_lammps import Scene
from mdanim_lammps.results.progress import ProgressLog
spent, plain = [0.0], ProgressLog._write
def timed(self, line):
    start = time.thread_time()
    plain(self, line)
    spent[0] += time.thread_time() - start
ProgressLog._write = timed
scene = Scene.load(sys.argv[1])
scene.prepared
before = resource.getrusage(resource.RUSAGE_SELF)
scene.run(Path(sys.argv[2]))
after = resource.getrusage(resource.RUSAGE_SELF)
print(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, spent[0])
"""


def started(folder: Path) -> tuple[subprocess.Popen, object]:
    """A server of a folder, and a page of it."""
    server = subprocess.Popen(
        [sys.executable, "-m", "mdanim_lammps.view", str(folder)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    origin, _, secret = server.stdout.readline().split()[0].rpartition("/?t=")
    return server, connect(f"{origin.replace('http', 'ws')}/socket?t={secret}", origin=origin, max_size=None).__enter__()


def watch(folder: Path, ended: threading.Event, seen: list[int]) -> None:
    """Ask for all frames that are there, 30 a second, again and again until the run has ended."""
    while not (folder / "progress.jsonl").exists():
        time.sleep(0.01)
    server, page = started(folder)
    asked = count = 0
    try:
        while not ended.is_set():
            with suppress(TimeoutError):
                while isinstance(said := page.recv(0), str):
                    count = json.loads(said)["news"].get("count", count)
                seen[0] += 1
            if count:
                page.send(json.dumps({"get": asked % count, "layers": 0}))
                asked += 1
            time.sleep(1 / 30)
    finally:
        page.close()
        server.terminate()
        server.wait()


def cost_of_watching(scene: Path) -> None:
    kinds, lines, seen = {"alone": [], "other": [], "watched": []}, [], {"other": [0], "watched": [0]}
    with tempfile.TemporaryDirectory() as place:
        other = Path(place) / "other"
        subprocess.run([sys.executable, "-c", RUN, str(scene), str(other)], stdout=subprocess.PIPE, check=True)
        for turn in range(3 * RUNS):
            kind = list(kinds)[turn % 3]
            folder, ended = Path(place) / f"out{turn}", threading.Event()
            target = other if kind == "other" else folder
            looker = None if kind == "alone" else threading.Thread(target=watch, args=(target, ended, seen[kind]))
            process = subprocess.Popen([sys.executable, "-c", RUN, str(scene), str(folder)], stdout=subprocess.PIPE, text=True)
            if looker:
                looker.start()
            total, spent = map(float, process.communicate()[0].split())
            kinds[kind].append(total)
            lines.append(spent / total)
            ended.set()
            if looker:
                looker.join()
    alone, elsewhere, watched = (min(times) for times in kinds.values())
    print(
        f"{scene.stem:<10} alone {alone:.3f} s, page at another run {elsewhere:.3f} s, watched {watched:.3f} s "
        f"({100 * (watched / elsewhere - 1):+.1f} %), {seen['watched'][0] / RUNS:.0f} frames seen; "
        f"progress.jsonl {100 * min(lines):.2f} % of it",
        flush=True,
    )


def answer_to_pause(scene: Path) -> None:
    """Time from asking to knowing [s]."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "out"
        run = subprocess.Popen([sys.executable, "-m", "mdanim_lammps", str(scene), "--no-movie", "-q", "-o", str(folder)])
        while not (folder / "progress.jsonl").exists():
            time.sleep(0.01)
        server, page = started(folder)
        state, times = "", []

        def until(wanted: str) -> None:
            nonlocal state
            while state != wanted:
                said = page.recv(20)
                state = json.loads(said)["news"].get("state", state) if isinstance(said, str) else state

        try:
            until("running")
            for _ in range(PAUSES):
                for what, wanted in (("pause", "paused"), ("go", "running")):
                    begun = time.perf_counter()
                    page.send(json.dumps({"do": what}))
                    until(wanted)
                    times += [time.perf_counter() - begun] if what == "pause" else []
                    time.sleep(0.05)
        finally:
            page.close()
            for process in (run, server):
                process.terminate()
                process.wait()
    print(
        f"{scene.stem:<10} pause: median {1e3 * statistics.median(times):.0f} ms, worst {1e3 * max(times):.0f} ms of {len(times)}"
    )


if __name__ == "__main__":
    for given in sys.argv[1:] or ("float", "beam"):
        cost_of_watching(SCENES / f"{given}.txt")
    answer_to_pause(SCENES / "beam.txt")
