# SPDX-License-Identifier: GPL-2.0-only
"""Mesh files read by VTK in a process of its own: damaged files end VTK's readers with a signal, which no exception can catch."""

from __future__ import annotations

import io
import resource
import stat
import sys
from pathlib import Path

import numpy as np

from ..children import TimeoutExpired, command, run
from ..scene.limits import MOST_BYTES_OF_MESH

MEMORY = 8 << 30
"""Address space of the reading process [bytes]; VTK takes 20 times the size of a file at most."""
SECONDS = 120.0
"""Time of the reading process [s]; the largest file takes 10."""


class UnreadableMesh(Exception):
    """A file that is no mesh; the message says why."""


def read_polygons(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, shape (V, 3), in units of the file, faces as VTK lists them, (count, index, index, ...) one after the other, and
    colours of points, uint8 RGB, shape (V, 3), or (0, 3) where the file has none.

    Every index is that of a point. Raises UnreadableMesh, and OSError for a file that is not there.
    """
    found = path.stat()
    if not stat.S_ISREG(found.st_mode):
        raise UnreadableMesh("is no regular file")
    if found.st_size > MOST_BYTES_OF_MESH:
        raise UnreadableMesh(f"has {found.st_size >> 20} MiB, {MOST_BYTES_OF_MESH >> 20} are the most")
    try:
        done = run(command(__name__, path), text=False, capture_output=True, timeout=SECONDS)
    except TimeoutExpired:
        raise UnreadableMesh(f"could not be read in {SECONDS:g} s") from None
    if done.returncode:
        raise UnreadableMesh("is damaged, cut short, or no mesh at all")
    arrays = io.BytesIO(done.stdout)
    return np.load(arrays), np.load(arrays), np.load(arrays)


def _read(path: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader

    vtkObject.GlobalWarningDisplayOff()
    reader = {".stl": vtkSTLReader, ".obj": vtkOBJReader, ".ply": vtkPLYReader}[Path(path).suffix.lower()]()
    reader.SetFileName(path)
    reader.Update()
    surface = reader.GetOutput()
    if reader.GetErrorCode() or not surface.GetNumberOfPoints():
        raise UnreadableMesh("VTK could not read it")
    points, cells = vtk_to_numpy(surface.GetPoints().GetData()), surface.GetPolys()
    first, index = vtk_to_numpy(cells.GetOffsetsArray()), vtk_to_numpy(cells.GetConnectivityArray())
    if len(index) and (index.min() < 0 or index.max() >= len(points)):
        raise UnreadableMesh("a face names a point that is not there")
    found = next((a for name in ("RGB", "RGBA") if (a := surface.GetPointData().GetArray(name)) is not None), None)
    color = vtk_to_numpy(found)[:, :3] if found is not None else np.zeros((0, 3), dtype=np.uint8)
    return points, np.insert(index, first[:-1], np.diff(first)), np.ascontiguousarray(color, dtype=np.uint8)


def main() -> None:
    """Write the contents of a file to the standard output, as three arrays."""
    for limit, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(limit)[1]
        resource.setrlimit(limit, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    for array in _read(sys.argv[1]):
        np.save(sys.stdout.buffer, array)
