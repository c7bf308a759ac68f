# SPDX-License-Identifier: GPL-2.0-only
"""The process that reads mesh files (mesh_reader.py): its memory is bounded, and it loads little, to start soon."""

from __future__ import annotations

import resource
import sys
from pathlib import Path

import numpy as np

from .mesh_formats import Polygons, UnreadableMesh, read

MEMORY = 8 << 30
"""Address space of this process [bytes]: 30 times the size of the largest file."""
UNREADABLE = 3
"""Its exit code for a file that is not a mesh; it says why on stderr."""


def contents(path: Path) -> Polygons:
    """Contents of a file, however much memory and time that takes. Raises UnreadableMesh and OSError."""
    return read(path.read_bytes(), path.suffix.lower())


def main() -> None:
    """Write the contents of files to the standard output, each as six arrays."""
    for limit, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(limit)[1]
        resource.setrlimit(limit, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    for name in sys.argv[1:]:
        try:
            found = contents(Path(name))
        except UnreadableMesh as error:
            print(error, file=sys.stderr)
            sys.exit(UNREADABLE)
        for array in (found.points, found.count, found.index, found.color, np.array(found.names, str), found.part):
            np.save(sys.stdout.buffer, array)
