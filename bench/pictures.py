# SPDX-License-Identifier: GPL-2.0-only
"""Cost of a picture: python bench/pictures.py FOLDER ... prints seconds of one core per picture of 1280 x 720, in draft and in
final quality, and the memory of the process that draws, for output folders of runs. Without a folder: what the command
``mdanim-lammps picture scenes/beam.txt`` takes. ``floor FOLDER ...``: what the window of objects takes when it is empty, by VTK's
own shader and by ours, beside a whole draft. ``coding FOLDER ...``: what the encoder takes for a picture of a movie, and for one
that is the same as before. ``tells FOLDER ...``: a draft with what its scene lays over pictures and without, and the functions of
these layers that are called where nothing is asked for."""

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
CODED = 60
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


def floor(folder: str) -> tuple[int, list[float]]:
    """Pixels of the window of objects in the middle of a run, and seconds of processor time of it when it is empty, by VTK's own
    shader and by ours, and of the whole picture; each the least of several."""
    os.environ["LP_NUM_THREADS"] = "1"
    from mdanim_lammps.picture.render import Painter
    from mdanim_lammps.picture.window import rgba
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.run.folder import stored_scene

    def least(work) -> float:
        times = []
        for _ in range(RUNS + 1):  # the first one compiles shaders
            start = time.process_time()
            work()
            times.append(time.process_time() - start)
        return min(times)

    with Trajectory(folder) as trajectory, Painter(trajectory, stored_scene(Path(folder)).render, size=SIZE) as painter:
        middle = len(trajectory) // 2
        whole = least(lambda: painter.pixels(middle))
        window, actors = painter._window, [a for r in painter._renderers for a in r.GetActors() if a.GetVisibility()]

        def drawn() -> float:
            return least(lambda: (window.Render(), rgba(window)))

        ours = drawn()
        for actor in painter._actors:
            actor.GetShaderProperty().ClearAllShaderReplacements()
            actor.GetProperty().RemoveAllTextures()
        plain = drawn()
        for actor in actors:
            actor.VisibilityOff()
        width, height = window.GetSize()
        return width * height, [drawn(), plain, ours, whole]


def print_floors(folders: list[str]) -> None:
    """Print a line for each folder, each measured by a process of its own."""
    print(f"{'folder':<24}  pixels  empty [ms]  VTK's shader  ours  whole picture")
    for folder in folders:
        with ProcessPoolExecutor(1, get_context("spawn")) as pool:
            pixels, seconds = pool.submit(floor, folder).result()
        print(f"{Path(folder).name:<24} {pixels:7d} " + " ".join(f"{1e3 * s:9.1f}" for s in seconds), flush=True)


def coding(folder: str) -> tuple[float, float]:
    """Seconds of processor time of the encoder, and of what makes pictures ready for it, for each picture of a stretch in the
    middle of a run, and for each of as many that are all the same; the least of several."""
    os.environ["LP_NUM_THREADS"] = "1"
    from fractions import Fraction

    from mdanim_lammps.picture.encoder import Yuv, encoder
    from mdanim_lammps.picture.render import Painter
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.run.folder import stored_scene

    def spent() -> float:
        used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return sum(u.ru_utime + u.ru_stime for u in used)

    with Trajectory(folder) as trajectory, Painter(trajectory, stored_scene(Path(folder)).render, size=SIZE) as painter:
        first = max(0, (len(trajectory) - CODED) // 2)
        pictures = [painter.pixels(index).copy() for index in range(first, min(len(trajectory), first + CODED))]
    found = []
    with TemporaryDirectory() as place:
        for shown in (pictures, pictures[:1] * len(pictures)):
            times = []
            for _ in range(3):
                start, yuv = spent(), Yuv()
                with encoder(Path(place) / "movie.mp4", SIZE, Fraction(30)) as encode:
                    for picture in shown:
                        encode(yuv.of(picture))
                times.append((spent() - start) / len(shown))
            found.append(min(times))
    return found[0], found[1]


def print_codings(folders: list[str]) -> None:
    """Print a line for each folder, each measured by a process of its own."""
    print(f"{'folder':<24} picture of a movie [ms]  the same again")
    for folder in folders:
        with ProcessPoolExecutor(1, get_context("spawn")) as pool:
            moving, still = pool.submit(coding, folder).result()
        print(f"{Path(folder).name:<24} {1e3 * moving:23.1f} {1e3 * still:15.1f}", flush=True)


LAYERS = ("overlay.py", "layer.py", "curves.py", "ghosts.py", "tones.py", "run_values.py")
"""Files of what scenes lay over pictures."""


def tells(folder: str) -> tuple[float, float, int]:
    """Seconds of processor time of a draft with what its scene lays over it and without, the least of several, and how many
    functions of LAYERS are called in one without."""
    os.environ["LP_NUM_THREADS"] = "1"
    from mdanim_lammps.picture.render import Painter
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.run.folder import stored_scene

    render, seconds, called = stored_scene(Path(folder)).render, [], []
    without = replace(render, arrows=(), trail=(), label=(), plot=(), caption=(), freeze=None, color_by=None)

    def note(frame, event, _):
        if event == "call" and Path(frame.f_code.co_filename).name in LAYERS:
            called.append(frame.f_code.co_name)

    for shown in (render, without):
        with Trajectory(folder) as trajectory, Painter(trajectory, shown, size=SIZE) as painter:
            times = []
            for _ in range(RUNS):
                start = time.process_time()
                painter.pixels(len(trajectory) // 2)
                times.append(time.process_time() - start)
            seconds.append(min(times))
            if shown is without:
                sys.setprofile(note)
                painter.pixels(len(trajectory) // 2)
                sys.setprofile(None)
    return seconds[0], seconds[1], len(called)


def print_tells(folders: list[str]) -> None:
    """Print a line for each folder, each measured by a process of its own."""
    print(f"{'folder':<24} with all layers [ms]  without  functions of layers called then")
    for folder in folders:
        with ProcessPoolExecutor(1, get_context("spawn")) as pool:
            full, bare, calls = pool.submit(tells, folder).result()
        print(f"{Path(folder).name:<24} {1e3 * full:20.1f} {1e3 * bare:8.1f} {calls:6d}", flush=True)


def main(folders: list[str]) -> None:
    """Print a line for each folder."""
    if folders[:1] == ["tells"]:
        print_tells(folders[1:])
        return
    if folders[:1] == ["coding"]:
        print_codings(folders[1:])
        return
    if folders[:1] == ["floor"]:
        print_floors(folders[1:])
        return
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
