# SPDX-License-Identifier: GPL-2.0-only
"""Cost of a picture: python bench/pictures.py FOLDER ... prints seconds of one core per picture of 1280 x 720, in draft and in
final quality, and the memory of the process that draws, for output folders of runs. Without a folder: what the command
``mdanim-lammps picture scenes/beam.txt`` takes."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

SCENE = Path(__file__).parents[1] / "scenes" / "beam.txt"
RUNS = 7
PICTURES = 8
SIZE = (1280, 720)


def measure(folder: str, quality: str) -> tuple[float, float]:
    """Seconds of processor time per picture, after a first one, and the largest memory [MB]."""
    os.environ["LP_NUM_THREADS"] = "1"
    from mdanim_lammps.picture.render import Painter
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.run.folder import stored_scene
    from mdanim_lammps.scene.render import Quality

    render = replace(stored_scene(Path(folder)).render, quality=Quality(quality))
    with Trajectory(folder) as trajectory, Painter(trajectory, render, size=SIZE) as painter:
        shown = [round(k * (len(trajectory) - 1) / PICTURES) for k in range(PICTURES + 1)]
        painter.pixels(shown[0])
        start = time.process_time()
        for index in shown[1:]:
            painter.pixels(index)
        return (time.process_time() - start) / PICTURES, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def picture_command() -> None:
    """Print processor and wall time of the command, the least of several, and the load of the machine."""
    times = []
    with TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "mdanim_lammps", "picture", str(SCENE), "-q", "-o", f"{folder}/beam.png"]
        for _ in range(RUNS):
            before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
            subprocess.run(command, check=True)
            after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - start
            times.append((after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall))
    processor, wall = (min(column) for column in zip(*times))
    print(f"picture {SCENE.name}: {processor:.2f} s of processor time, {wall:.2f} s, load {os.getloadavg()[0]:.1f}")


def main(folders: list[str]) -> None:
    """Print a line for each folder."""
    if not folders:
        picture_command()
        return
    print(f"{'folder':<24} draft [s] [MB]   final [s] [MB]")
    for folder in folders:
        found = []
        for quality in ("draft", "final"):
            with ProcessPoolExecutor(1, get_context("spawn")) as pool:
                found.append(pool.submit(measure, folder, quality).result())
        print(f"{Path(folder).name:<24} " + "   ".join(f"{seconds:9.2f} {memory:4.0f}" for seconds, memory in found), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
