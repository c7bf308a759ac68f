# SPDX-License-Identifier: GPL-2.0-only
"""Meshes of a scene under names that depend on their content, so that an output folder can hold copies of them."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path

from .scene import Mesh, Scene

FOLDER = "meshes"


def mesh_files(scene: Scene) -> dict[Path, str]:
    """Every mesh file of a scene, and its name in an output folder: ``meshes/HASH.stl``. Raises OSError."""
    paths = dict.fromkeys(s.shape.path for s in scene.solids if isinstance(s.shape, Mesh))
    return {path: content_name(path) for path in paths}


def content_name(path: Path) -> str:
    """The name of one mesh file. Raises OSError."""
    stat = path.stat()
    return f"{FOLDER}/{_digest(path, stat.st_mtime_ns, stat.st_size)}{path.suffix.lower()}"


@lru_cache(maxsize=1024)
def _digest(path: Path, changed: int, size: int) -> str:
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while piece := file.read(2**20):
            digest.update(piece)
    return digest.hexdigest()[:32]
