# SPDX-License-Identifier: GPL-2.0-only
"""mdanim-lammps: physically simulated animation of elastic objects and liquid, on top of LAMMPS.

>>> from mdanim_lammps import Scene, Trajectory
>>> run = Scene.load("beam.txt").run("beam.out")        # doctest: +SKIP
>>> Trajectory("beam.out").objects["cube"].center_of_mass  # doctest: +SKIP
"""

__version__ = "0.1.0"
__all__ = ["Scene", "SceneError", "Trajectory", "Universe"]


def __getattr__(name: str):
    # Loaded when asked for: `import lammps` itself imports this package through its plugin entry point.
    if name == "Scene":
        from .api import Scene

        return Scene
    if name == "SceneError":
        from .errors import SceneError

        return SceneError
    if name == "Trajectory":
        from .results.trajectory import Trajectory

        return Trajectory
    if name == "Universe":
        from .results.universe import open_data

        return open_data
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
