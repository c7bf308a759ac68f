# SPDX-License-Identifier: GPL-2.0-only
"""Make the stored reference runs: ``python tests/reference/make.py``.

Each scene of this folder is run and the positions and velocities of every frame are stored in NAME.npz, beside the version
of LAMMPS. Make them again only when the physics is meant to change, and say so in the commit: a reference that follows the
program shows nothing.
"""

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def film(path: Path) -> np.ndarray:
    """Positions [m] and velocities [m/s] of every frame of a scene, shape (F, 2, N, 3)."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    ready = prepare(load_scene(path))
    with Instance(ready.plan) as instance:
        instance.setup()
        frames = [[instance.array("x").copy(), instance.array("v").copy()]]
        for _ in range(ready.certificate.frames):
            instance.run(ready.certificate.steps_per_frame)
            frames.append([instance.array("x").copy(), instance.array("v").copy()])
    return np.array(frames)


if __name__ == "__main__":
    from mdanim_lammps.engine.plugin import VERSION

    for scene in sorted(HERE.glob("*.txt")):
        np.savez_compressed(scene.with_suffix(".npz"), film=film(scene), lammps=VERSION)
        print(scene.with_suffix(".npz").name)
