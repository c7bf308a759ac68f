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
from .mesh_formats import UnreadableMesh, read

MEMORY = 8 << 30
"""Address space of the reading process [bytes]: 30 times the size of the largest file."""
SECONDS = 120.0
"""Time of the reading process [s]; the largest text takes 20."""
UNREADABLE = 3
"""Exit code of the reading process for a file that is not a mesh; it says why on stderr."""


def read_polygons(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, shape (V, 3), in units of the file, faces as VTK lists them, (count, index, index, ...) one after the other, and
    colours of points, uint8 RGB, shape (V, 3), or (0, 3) where the file has none.

    Every index is that of a point. Raises UnreadableMesh, and OSError for a file that is not there.
    """
    found = path.stat()
    if not stat.S_ISREG(found.st_mode):
        raise UnreadableMesh("is not a regular file")
    if found.st_size > MOST_BYTES_OF_MESH:
        raise UnreadableMesh(f"has {found.st_size >> 20} MiB, {MOST_BYTES_OF_MESH >> 20} are the most")
    return _read_apart(path)


def _read_apart(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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
    return np.load(arrays), np.load(arrays), np.load(arrays)


def contents(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same as `read_polygons`, by this process, however much memory and time that takes. Raises UnreadableMesh."""
    found = read(path.read_bytes(), path.suffix.lower())
    faces = np.insert(found.index, np.cumsum(found.count) - found.count, found.count)
    return found.points, faces, found.color


def main() -> None:
    """Write the contents of a file to the standard output, as three arrays."""
    for limit, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(limit)[1]
        resource.setrlimit(limit, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    try:
        found = contents(Path(sys.argv[1]))
    except UnreadableMesh as error:
        print(error, file=sys.stderr)
        sys.exit(UNREADABLE)
    for array in found:
        np.save(sys.stdout.buffer, array)
