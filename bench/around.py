# SPDX-License-Identifier: GPL-2.0-only
"""Time around the steps of a run: ``python bench/around.py [rounds]``.

Scenes of scenes/, each in processes of their own: seconds until the first step (the program's start, the scene, modelling,
LAMMPS), the share of the run that output and the guard take, and pictures per second of the movie at 1280x720.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import one_thread  # noqa: F401
from timing import interleaved, markdown

SCENES = Path(__file__).resolve().parent.parent / "scenes"
NAMES = ("beam", "crowd", "float")
GOAL = 10.0
"""Pictures per second on two cores."""


def program(*words: object) -> None:
    """Run the program, quietly."""
    subprocess.run([sys.executable, "-m", "mdanim_lammps", *map(str, words), "-q"], check=True, timeout=600)


def start_up(name: str, folder: Path) -> float:
    """Seconds from the program's start to a plan: all but LAMMPS and its steps."""
    code = (
        "import sys; from pathlib import Path; from mdanim_lammps.run.prepare import prepare; "
        "from mdanim_lammps.scene.parse import load_scene; prepare(load_scene(Path(sys.argv[1])))"
    )
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", code, str(SCENES / f"{name}.txt")], check=True, timeout=600)
    return time.perf_counter() - start


def pictures(name: str, folder: Path) -> float:
    """Pictures per second of a movie, the start of its processes included."""
    from mdanim_lammps.picture.movie import movie_frames, render_movie
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.scene.parse import load_scene

    scene = load_scene(SCENES / f"{name}.txt")
    with Trajectory(folder) as trajectory:
        count = len(movie_frames(trajectory)[0])
        start = time.perf_counter()
        render_movie(trajectory, scene.render, folder / "bench.mp4", size=(1280, 720))
        return count / (time.perf_counter() - start)


def measure(rounds: int = 3, quick: bool = False) -> list[dict]:
    """One row for each scene."""
    rounds = 1 if quick else min(rounds, 3)
    rows = []
    for name in NAMES[2:] if quick else NAMES:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            program(SCENES / f"{name}.txt", "-o", out, "--no-movie")
            cost = json.loads((out / "cost.json").read_text())
            found = interleaved({"start": lambda: start_up(name, out), "pictures": lambda: pictures(name, out)}, rounds)
        start, fps = found["start"], found["pictures"]
        rows.append(
            {
                "scene": name,
                "particles": cost["particles"],
                "wall": cost["wall"],
                "start": start.median,
                "start_least": start.least,
                "setup": cost["other"]["setup"],
                "output": cost["other"]["output"] / cost["wall"],
                "guard": cost["other"]["guard"] / cost["wall"],
                "fps": fps.median,
                "fps_most": max(fps.values),
            }
        )
    return rows


def table(rows: list[dict]) -> str:
    """In Markdown."""
    return markdown(
        [
            "scene",
            "particles",
            "run [s]",
            "start to plan, median (minimum) [s]",
            "loading and modelling in the run [s]",
            "output",
            "guard",
            "pictures per second, median (most)",
            "goal",
        ],
        [
            (
                r["scene"],
                r["particles"],
                r["wall"],
                f"{r['start']:.2f} ({r['start_least']:.2f})",
                r["setup"],
                f"{100 * r['output']:.1f} %",
                f"{100 * r['guard']:.1f} %",
                f"{r['fps']:.1f} ({r['fps_most']:.1f})",
                f"≥ {GOAL:g}",
            )
            for r in rows
        ],
    )


if __name__ == "__main__":
    print(table(measure(*map(int, sys.argv[1:]))))
