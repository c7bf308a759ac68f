# SPDX-License-Identifier: GPL-2.0-only
"""Scenes of the gallery whose objects no one sees bend, once more with rigid ones: ``python bench/as_rigid.py [SCENE ...]``.

Prints the table of docs/physics-rigid.md: steps and processor time of both, with modelling, without pictures; and the largest
distance of the centre of mass of an object in one from that in the other, over all frames. ``elasticity`` of all that is not a
liquid becomes ``rigid``, and ``damping`` of objects goes; all else stays.
"""

import re
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import one_thread  # noqa: F401
from mdanim_lammps import Scene, Trajectory
from timing import markdown

SCENES = Path(__file__).parent.parent / "scenes"
APART = {
    "pile": {
        "let a = 12 cm": "let a = 11 cm",
        "36*k - 20": "44*k - 28",
        "36*k - 12": "44*k - 17",
        "36*k - 4": "44*k - 6",
        "36*k + 4": "44*k + 5",
    }
}
"""Changes in both forms of a scene, whose objects start in each other by a few millimetres: rigid ones may not."""
NAMES = (
    *("dominoes", "tower", "cards", "plates", "henge", "quake", "spin", "race", "cradle", "billiard", "pile"),
    *("splash", "float"),
)


def as_rigid(text: str) -> str:
    """The text of a scene with rigid objects in place of elastic ones."""
    text = re.sub(r"\belasticity +(?!rigid)(?:\d[\d.]* +\w+|\w+)", "elasticity rigid", text)
    return re.sub(r"(?<![\w-])damping +[\d.]+", "", text)


def run(text: str, folder: Path) -> tuple[int, float, np.ndarray, list[str]]:
    """Steps, processor time [s], centres of mass, shape (F, M, 3), and what was expected and missed."""
    path = folder / "scene.txt"
    path.write_text(text, encoding="utf-8")
    start = time.process_time()
    scene = Scene.load(path)
    done = scene.run(folder / "out")
    took = time.process_time() - start
    with Trajectory(folder / "out") as trajectory:
        return scene.prepared.certificate.steps, took, np.array(trajectory.centers), [str(o) for o in done.missed]


def compared(name: str) -> list:
    """A row of the table."""
    text, both = (SCENES / f"{name}.txt").read_text(encoding="utf-8"), []
    for was, now in APART.get(name, {}).items():
        text = text.replace(was, now)
    for said in (text, as_rigid(text)):
        with tempfile.TemporaryDirectory() as place:
            both.append(run(said, Path(place)))
    (steps, took, centres, _), (fewer, rigid, others, missed) = both
    away = 100.0 * float(np.linalg.norm(centres - others, axis=2).max())
    return [f"`{name}.txt`", steps, fewer, f"{took:.1f}", f"{rigid:.1f}", f"{took / rigid:.1f}", f"{away:.2g}", len(missed)]


HEAD = ("", "steps", "rigid", "processor time [s]", "rigid", "ratio", "farthest apart [cm]", "expectations missed as rigid")

if __name__ == "__main__":
    print(markdown(HEAD, ()), flush=True)
    for scene in sys.argv[1:] or NAMES:
        print(markdown(HEAD, [compared(scene)]).splitlines()[-1], flush=True)
