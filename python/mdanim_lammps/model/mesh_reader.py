# SPDX-License-Identifier: GPL-2.0-only
"""Mesh files read in a process of its own, whose memory and time are bounded."""

from __future__ import annotations

import io
import resource
import stat
import sys
from pathlib import Path

import numpy as np

from ..children import TimeoutExpired, command, run
from ..scene.limits import MOST_BYTES_OF_MESH
from .mesh_formats import Polygons, UnreadableMesh, read

MEMORY = 8 << 30
"""Address space of the reading process [bytes]: 30 times the size of the largest file."""
SECONDS = 120.0
"""Time of the reading process [s]; the largest text takes 20."""
UNREADABLE = 3
"""Exit code of the reading process for a file that is not a mesh; it says why on stderr."""


def read_polygons(path: Path) -> Polygons:
    """Contents of a file. Raises UnreadableMesh, and OSError for a file that is not there."""
    found = path.stat()
    if not stat.S_ISREG(found.st_mode):
        raise UnreadableMesh("is not a regular file")
    if found.st_size > MOST_BYTES_OF_MESH:
        raise UnreadableMesh(f"has {found.st_size >> 20} MiB, {MOST_BYTES_OF_MESH >> 20} are the most")
    return _read_apart(path)


def _read_apart(path: Path) -> Polygons:
    """`contents` by a process of its own."""
    try:
        done = run(command(__name__, path), text=False, capture_output=True, timeout=SECONDS)
    except TimeoutExpired:
        raise UnreadableMesh(f"could not be read in {SECONDS:g} s") from None
    if done.returncode == UNREADABLE:
        raise UnreadableMesh(done.stderr.decode().strip())
    if done.returncode:
        raise UnreadableMesh("is too large to be read, or damaged")
    arrays = io.BytesIO(done.stdout)
    *parts, names, part = (np.load(arrays) for _ in range(6))
    return Polygons(*parts, tuple(names.tolist()), part)


def contents(path: Path) -> Polygons:
    """The same as `read_polygons`, by this process, however much memory and time that takes. Raises UnreadableMesh."""
    return read(path.read_bytes(), path.suffix.lower())


def main() -> None:
    """Write the contents of a file to the standard output, as six arrays."""
    for limit, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(limit)[1]
        resource.setrlimit(limit, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    try:
        found = contents(Path(sys.argv[1]))
    except UnreadableMesh as error:
        print(error, file=sys.stderr)
        sys.exit(UNREADABLE)
    for array in (found.points, found.count, found.index, found.color, np.array(found.names, str), found.part):
        np.save(sys.stdout.buffer, array)
