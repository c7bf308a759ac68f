# SPDX-License-Identifier: GPL-2.0-only
"""What the view costs a run, and how soon it answers: python bench/view.py [scene ...]

Processor time of the run's own process, with a page that asks for every frame and without one, the least of several runs each;
what progress.jsonl takes of it; time from a page's "pause" to the page's knowing.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import threading
import time
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


def watch(folder: Path, seen: list[int]) -> None:
    """Ask for every frame as soon as it is there, until the run has ended."""
    while not (folder / "trajectory.h5.part").exists():
        time.sleep(0.01)
    server, page = started(folder)
    asked = count = 0
    try:
        while True:
            said = page.recv()
            if isinstance(said, bytes):
                seen[0] += 1
            elif news := json.loads(said).get("news"):
                count = news.get("count", count)
                if news.get("state") in ("done", "killed", "failed"):
                    return
            if asked < count and asked <= seen[0]:
                page.send(json.dumps({"get": asked, "layers": 0}))
                asked += 1
    finally:
        page.close()
        server.terminate()
        server.wait()


def cost_of_watching(scene: Path) -> None:
    alone, watched, lines, seen = [], [], [], [0]
    for turn in range(2 * RUNS):
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "out"
            looker = threading.Thread(target=watch, args=(folder, seen)) if turn % 2 else None
            process = subprocess.Popen([sys.executable, "-c", RUN, str(scene), str(folder)], stdout=subprocess.PIPE, text=True)
            if looker:
                looker.start()
            total, spent = map(float, process.communicate()[0].split())
            (watched if turn % 2 else alone).append(total)
            lines.append(spent / total)
            if looker:
                looker.join()
    a, w = min(alone), min(watched)
    print(
        f"{scene.stem:<10} alone {a:.3f} s, watched {w:.3f} s ({100 * (w / a - 1):+.1f} %), {seen[0] / RUNS:.0f} frames seen; "
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
