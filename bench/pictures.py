# SPDX-License-Identifier: GPL-2.0-only
"""What a picture costs: python bench/pictures.py FOLDER ... prints seconds of one core per picture of 1280 x 720, in draft and in
final quality, and the memory of the process that draws, for output folders of runs."""

from __future__ import annotations

import os
import resource
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

PICTURES = 8
SIZE = (1280, 720)


def measure(folder: str, quality: str) -> tuple[float, float]:
    """Seconds of processor time per picture, after a first one, and the largest memory [MB]."""
    os.environ["LP_NUM_THREADS"] = "1"
    from mdanim_lammps.api import stored_scene
    from mdanim_lammps.picture.render import Painter
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.scene.render import Quality

    render = replace(stored_scene(Path(folder)).render, quality=Quality(quality))
    with Trajectory(folder) as trajectory, Painter(trajectory, render, size=SIZE) as painter:
        shown = [round(k * (len(trajectory) - 1) / PICTURES) for k in range(PICTURES + 1)]
        painter.frame(shown[0])
        start = time.process_time()
        for index in shown[1:]:
            painter.frame(index)
        return (time.process_time() - start) / PICTURES, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main(folders: list[str]) -> None:
    """Print a line for each folder."""
    print(f"{'folder':<24} draft [s] [MB]   final [s] [MB]")
    for folder in folders:
        found = []
        for quality in ("draft", "final"):
            with ProcessPoolExecutor(1, get_context("spawn")) as pool:
                found.append(pool.submit(measure, folder, quality).result())
        print(f"{Path(folder).name:<24} " + "   ".join(f"{seconds:9.2f} {memory:4.0f}" for seconds, memory in found), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
