# SPDX-License-Identifier: GPL-2.0-only
"""Meshes of a scene under names that depend on their content, so that an output folder can hold copies of them."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

from .limits import MOST_BYTES_OF_MESH
from .scene import SceneRecord
from .shapes import mesh_of
from .source import ordinary

FOLDER = "meshes"


def mesh_files(scene: SceneRecord) -> dict[Path, str]:
    """Every mesh file of a scene, and its name in an output folder: ``meshes/HASH.stl``. Raises OSError."""
    paths = dict.fromkeys(mesh.path for s in scene.solids if (mesh := mesh_of(s.shape)) is not None)
    return {path: content_name(path) for path in paths}


def content_name(path: Path) -> str:
    """The name of one mesh file. Raises OSError."""
    stat = path.stat()
    return f"{FOLDER}/{_digest(path, stat.st_mtime_ns, stat.st_size)}{path.suffix.lower()}"


@lru_cache(maxsize=1024)
def _digest(path: Path, changed: int, size: int) -> str:
    import hashlib  # loaded for scenes with a mesh alone

    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while piece := file.read(2**20):
            digest.update(piece)
    return digest.hexdigest()[:32]


def beside(folder: Path | str, path: Path) -> Path:
    """The absolute path of a mesh that a file in this folder names."""
    return Path(os.path.abspath(Path(folder) / path))


def refusal_of_mesh(path: Path, name: str) -> tuple[str, str] | None:
    """Why the file that a scene calls by this name cannot be its mesh, and a way out; None where it can."""
    if path.suffix.lower() not in (".stl", ".obj", ".ply"):
        return f"a mesh is an STL, OBJ or PLY file, found '{name}'", ""
    if not os.path.exists(path):
        return f"the mesh file '{name}' is not there: {path}", "its name is relative to this scene file"
    if not ordinary(path):
        return f"the mesh file '{name}' is not an ordinary file", "copy the mesh beside the scene"
    if path.stat().st_size > MOST_BYTES_OF_MESH:
        return f"the mesh file '{name}' is larger than {MOST_BYTES_OF_MESH >> 20} MB", "fewer triangles"
    return None
