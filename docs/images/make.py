# SPDX-License-Identifier: GPL-2.0-only
"""Make the pictures of README and docs: ``python docs/images/make.py`` (runs the scenes it needs)."""

import tempfile
from pathlib import Path

from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.picture.movie import render_still

HERE = Path(__file__).parent
SCENES = HERE.parent.parent / "scenes"
PICTURES = {"beam": 0.33, "drop": 0.5, "duck": 0.6, "crowd": 0.48}
"""Scene and the moment to show [s]."""


def main() -> None:
    """Write one picture per scene beside this file."""
    for name, time in PICTURES.items():
        with tempfile.TemporaryDirectory() as folder:
            scene = Scene.load(SCENES / f"{name}.txt")
            scene.run(folder, force=True)
            with Trajectory(folder) as trajectory:
                frame = int(abs(trajectory.times - time).argmin())
                render_still(trajectory, frame, HERE / f"{name}.png", scene.record.render, size=(960, 540))
        print(HERE / f"{name}.png")


if __name__ == "__main__":
    main()
