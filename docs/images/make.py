# SPDX-License-Identifier: GPL-2.0-only
"""Make the pictures of README and docs: ``python docs/images/make.py [SCENE ...]`` (runs the scenes; default all)."""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.picture.movie import render_still
from mdanim_lammps.scene.render import Quality
from PIL import Image

HERE = Path(__file__).parent
SCENES = HERE.parent.parent / "scenes"
PICTURES = {
    "beam": 0.33,
    "drop": 0.5,
    "duck": 0.3,
    "crowd": 0.48,
    "float": 5.0,
    "densities": 5.0,
    "vessels": 0.3,
    "splash": 0.45,
    "cork": 0.5,
    "boat": 0.6,
    "dominoes": 1.1,
    "race": 1.4,
    "stairs": 0.88,
    "tower": 1.1,
    "cards": 1.0,
    "plates": 0.0,
    "billiard": 0.5,
    "cradle": 0.8,
    "pile": 1.2,
}
"""Scene and the moment to show [s]."""
SIZE = (720, 405)
"""Two beside each other in the gallery; no file is larger than 200 kB."""


def main(names: list[str]) -> None:
    """Write one picture per scene beside this file."""
    for name in names or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            scene = Scene.load(SCENES / f"{name}.txt")
            scene.run(folder, force=True)
            with Trajectory(folder) as trajectory:
                frame = int(abs(trajectory.times - PICTURES[name]).argmin())
                render = replace(scene.record.render, quality=Quality.FINAL)
                path = render_still(trajectory, frame, HERE / f"{name}.png", render, size=SIZE)
        Image.open(path).save(path, optimize=True)
        print(path)


if __name__ == "__main__":
    main(sys.argv[1:])
