# SPDX-License-Identifier: GPL-2.0-only
"""Cost of the view for a run, how soon it answers and how fast the page is: python bench/view.py [--only PART] [scene ...]

page: in Chromium without a graphics card, from the address to the first picture that is drawn; pictures a second while the film
plays, and processor time of the browser for each. pause: from a page's "pause" to the page's knowing. cost: processor time of the
run's own process, the least of several runs each: alone, while a page asks for all frames of another run (what another process on
the same cores costs anyway), and while the page asks for this run's; and what progress.jsonl takes of it.

Beside each figure stands the load of the machine. All of beam.txt takes two to three minutes.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

import one_thread  # noqa: F401
from websockets.sync.client import connect

ROOT = Path(__file__).parents[1]
SCENES = ROOT / "scenes"
RUNS = 5
PAUSES = 15
LOADS = 3
"""How often the page is opened."""
PLAYED = 8.0
"""For how long pictures are counted [s]."""
ENDED = ("done", "stopped", "failed", "killed")

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


def load() -> str:
    """How busy the machine is."""
    return f"load {os.getloadavg()[0]:.1f}"


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
        f"progress.jsonl {100 * min(lines):.2f} % of it, {load()}",
        flush=True,
    )


def answer_to_pause(scene: Path) -> None:
    """Time from asking to knowing [s], in a run that is long enough for all pauses."""
    with tempfile.TemporaryDirectory() as place:
        folder, long = Path(place) / "out", Path(place) / "long.txt"
        long.write_text(longer(scene.read_text()))
        run = subprocess.Popen([sys.executable, "-m", "mdanim_lammps", str(long), "--no-movie", "-q", "-o", str(folder)])
        while not (folder / "progress.jsonl").exists():
            time.sleep(0.01)
        server, page = started(folder)
        state, times = "", []

        def until(wanted: str) -> None:
            nonlocal state
            while state != wanted:
                if state in ENDED:
                    raise RuntimeError(f"the run is {state}, and was to be {wanted}")
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
        f"{scene.stem:<10} pause: median {1e3 * statistics.median(times):.0f} ms, worst {1e3 * max(times):.0f} ms "
        f"of {len(times)}, {load()}",
        flush=True,
    )


def longer(text: str) -> str:
    """A scene whose control block asks for ten times as much time and expects nothing."""
    kept = [line for line in text.splitlines() if not line.lstrip().startswith("expect")]
    return re.sub(r"(?m)^(\s*time\s+)([\d.]+)", lambda found: f"{found[1]}{10 * float(found[2]):g}", "\n".join(kept)) + "\n"


def browser_seconds(driver: int) -> float:
    """Processor time of all processes below a driver so far."""
    seconds, tick = {}, os.sysconf("SC_CLK_TCK")
    parents = {}
    for entry in Path("/proc").iterdir():
        with suppress(OSError, ValueError):
            number = int(entry.name)
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            parents[number], seconds[number] = int(fields[1]), (int(fields[11]) + int(fields[12])) / tick
    below = {driver}
    while more := {child for child, parent in parents.items() if parent in below} - below:
        below |= more
    return sum(seconds[child] for child in below - {driver})


def page_in_a_browser(scene: Path) -> None:
    """First picture, and pictures a second of a finished run whose film plays again and again."""
    sys.path.insert(0, str(ROOT / "tests" / "lab"))
    from browser import Browser

    first = []
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "out"
        subprocess.run([sys.executable, "-c", RUN, str(scene), str(folder)], stdout=subprocess.PIPE, check=True)
        browser = Browser(1280, 720)
        try:
            for _ in range(LOADS):
                server = subprocess.Popen(
                    [sys.executable, "-m", "mdanim_lammps.view", str(folder)],
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    text=True,
                )
                browser.go(server.stdout.readline().split()[0])
                browser.until("window.mdanim && mdanim.drawn")
                # Reading a pixel waits until it is drawn.
                first.append(
                    browser.js(
                        "const gl = mdanim.stage.renderer.getContext();"
                        "gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));"
                        "return performance.now()"
                    )
                )
                busy = load()
                if len(first) < LOADS:
                    server.terminate()
                    server.wait()
            again = "setInterval(() => mdanim.player.playing || (mdanim.player.go(0), mdanim.player.play(true)), 20)"
            browser.js(again)
            time.sleep(PLAYED / 2)
            counted = "return [mdanim.drawn, performance.now() / 1000, mdanim.ease]"
            spent, (drawn, begun, _) = browser_seconds(browser.process.pid), browser.js(counted)
            time.sleep(PLAYED)
            more, (pictures, ended, ease) = browser_seconds(browser.process.pid), browser.js(counted)
            server.terminate()
            server.wait()
        finally:
            browser.close()
    pictures -= drawn
    print(
        f"{scene.stem:<10} page: first picture {min(first) / 1e3:.2f} s (least of {LOADS}, {busy}); "
        f"{pictures / (ended - begun):.1f} pictures a second, eased by {ease}, "
        f"{1e3 * (more - spent) / max(1, pictures):.0f} ms of processor time each, {load()}",
        flush=True,
    )


PARTS = {"page": page_in_a_browser, "pause": answer_to_pause, "cost": cost_of_watching}


def main() -> None:
    """Measure what is asked for; everything of beam.txt by default."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="*", default=["beam"])
    parser.add_argument("--only", choices=PARTS)
    given = parser.parse_args()
    for name in given.scene:
        for part in [given.only] if given.only else PARTS:
            PARTS[part](SCENES / f"{name}.txt")


if __name__ == "__main__":
    main()
