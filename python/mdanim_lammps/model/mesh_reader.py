# SPDX-License-Identifier: GPL-2.0-only
"""Mesh files read in a process of its own, whose memory and time are bounded."""

from __future__ import annotations

import io
import stat
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..children import TimeoutExpired, command, run
from ..scene.limits import MOST_BYTES_OF_MESH
from . import mesh_contents
from .mesh_formats import Polygons, UnreadableMesh

SECONDS = 120.0
"""Time of the reading process [s]; the largest text takes 20."""


def read_polygons(path: Path) -> Polygons:
    """Contents of a file. Raises UnreadableMesh, and OSError for a file that is not there."""
    return read_together([path])[0]


def read_together(paths: Sequence[Path]) -> list[Polygons]:
    """Contents of files by one process, whose start takes longer than most files. Raises what `read_polygons` does, where one of
    them cannot be read."""
    for path in paths:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            raise UnreadableMesh("is not a regular file")
        if found.st_size > MOST_BYTES_OF_MESH:
            raise UnreadableMesh(f"has {found.st_size >> 20} MiB, {MOST_BYTES_OF_MESH >> 20} are the most")
    return _read_apart(paths)


def _read_apart(paths: Sequence[Path]) -> list[Polygons]:
    """`mesh_contents.contents` of each by a process of its own."""
    try:
        done = run(command(mesh_contents.__name__, *paths), text=False, capture_output=True, timeout=SECONDS)
    except TimeoutExpired:
        raise UnreadableMesh(f"could not be read in {SECONDS:g} s") from None
    if done.returncode == mesh_contents.UNREADABLE:
        raise UnreadableMesh(done.stderr.decode().strip())
    if done.returncode:
        raise UnreadableMesh("is too large to be read, or damaged")
    arrays = io.BytesIO(done.stdout)
    return [_polygons(*(np.load(arrays) for _ in range(6))) for _ in paths]


def _polygons(points, count, index, color, names, part) -> Polygons:
    return Polygons(points, count, index, color, tuple(names.tolist()), part)
