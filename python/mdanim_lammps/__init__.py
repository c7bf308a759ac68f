# SPDX-License-Identifier: GPL-2.0-only
"""mdanim-lammps: physically simulated animation of elastic objects and liquid, on top of LAMMPS.

>>> from mdanim_lammps import Run, Scene
>>> run = Scene.load("beam.txt").run("beam.out")        # doctest: +SKIP
>>> Run("beam.out").trajectory.objects["cube"].center_of_mass  # doctest: +SKIP
"""

from importlib import import_module

__version__ = "0.1.0"

_PLACES = {
    "api.scene": ("Scene",),
    "api.run": ("Run", "RunStatus"),
    "run.prepare": ("Prepared",),
    "run.loop": ("Interrupted", "Progress"),
    "certificate": ("Certificate",),
    "effects": ("Verdict",),
    "results.trajectory": ("ObjectTrack", "Snapshot", "Trajectory"),
    "results.ledger": ("Ledger",),
    "results.records": ("Records",),
    "results.expect": ("Outcome",),
    "results.cost": ("Cost",),
    "results.timeline": ("Timeline",),
    "results.universe": ("open_universe",),
    "export.write": ("Exported",),
    "study.study": ("Study",),
    "study.target": ("Choice",),
    "errors": (
        *("MdanimError", "Problem", "SceneError", "RefusedError", "DivergedError", "OutputError", "SetupError", "UsageError"),
    ),
}
_MODULES = {name: module for module, names in _PLACES.items() for name in names}
__all__ = sorted(_MODULES)


def __getattr__(name: str):
    # Loaded when asked for: `import lammps` itself imports this package through its plugin entry point.
    if name == "Universe":
        from .deprecated import warn

        warn("mdanim_lammps.Universe", "mdanim_lammps.open_universe", level=3)
        name = "open_universe"
    if name in _MODULES:
        return getattr(import_module(f".{_MODULES[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
