# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces as VTK has them, and what its filters make of them. Points [m] have the shape (V, 3), triangles (T, 3).

VTK's own modules: pyvista would be loaded for each scene with a mesh, which takes as long as to model 3 000 particles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

TOLERANCE = float(np.finfo(np.float32).eps)
"""Tolerance of VTK where a line meets a surface."""


def polygons(points: np.ndarray, faces: np.ndarray) -> Any:
    """``vtkPolyData`` of faces as VTK lists them, (count, index, index, ...) one after the other."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    data, places, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=1))
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces, np.int64), deep=1))
    data.SetPoints(places)
    data.SetPolys(cells)
    return data


def surface(points: np.ndarray, triangles: np.ndarray) -> Any:
    """``vtkPolyData`` of triangles."""
    return polygons(points, np.insert(triangles, 0, 3, axis=1).ravel())


def arrays(data: Any) -> tuple[np.ndarray, np.ndarray]:
    """Points and int32 triangles of ``vtkPolyData`` of triangles."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if not data.GetNumberOfPoints():
        return np.zeros((0, 3)), np.zeros((0, 3), np.int32)
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return points, vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int32)


def paint(data: Any, color: np.ndarray) -> None:
    """Give points colours, uint8, shape (V, 3)."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    held = numpy_to_vtk(np.ascontiguousarray(color), deep=1)
    held.SetName("color")
    data.GetPointData().AddArray(held)


def paint_of(data: Any) -> np.ndarray:
    """Colours of points that were painted."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(data.GetPointData().GetArray("color"))


def merged(data: Any, tolerance: float) -> Any:
    """With points as one that are nearer to each other than a share of the diagonal of the box around all."""
    from vtkmodules.vtkFiltersCore import vtkCleanPolyData

    cleaner = vtkCleanPolyData()
    cleaner.SetTolerance(tolerance)
    return _made(cleaner, data)


def triangulated(data: Any) -> Any:
    """With faces cut into triangles, and without what is not a face."""
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter

    cutter = vtkTriangleFilter()
    cutter.PassVertsOff()
    cutter.PassLinesOff()
    return _made(cutter, data)


def subdivided(data: Any, edge: float) -> Any:
    """After one pass over triangles with an edge longer than this."""
    from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter

    divider = vtkAdaptiveSubdivisionFilter()
    divider.SetMaximumEdgeLength(edge)
    divider.SetMaximumTriangleArea(1e30)
    divider.SetMaximumNumberOfPasses(1)
    return _made(divider, data)


def _made(tool: Any, data: Any) -> Any:
    tool.SetInputData(data)
    tool.Update()
    return tool.GetOutput()


def depth_below(points: np.ndarray, triangles: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """A function: depth [m] of places [m], shape (..., 3), below the surface, negative outside."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

    implicit = vtkImplicitPolyDataDistance()
    implicit.SetInput(surface(points, triangles))

    def depth(place: np.ndarray) -> np.ndarray:
        given, found = np.ascontiguousarray(place.reshape(-1, 3), float), np.zeros(place.size // 3)
        answer = numpy_to_vtk(found)
        implicit.EvaluateFunction(numpy_to_vtk(given), answer)
        return -vtk_to_numpy(answer).reshape(place.shape[:-1])

    return depth


def hits(points: np.ndarray, triangles: np.ndarray, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where lines between places [m], shape (L, 3) each, meet the surface: numbers of lines, shape (K,), ascending, and places
    [m], shape (K, 3)."""
    from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

    locator, found, cells = vtkStaticCellLocator(), vtkPoints(), vtkIdList()
    locator.SetDataSet(surface(points, triangles))
    locator.BuildLocator()
    found.SetDataTypeToDouble()
    line: list[int] = []
    met: list[tuple[float, float, float]] = []
    for k, (a, b) in enumerate(zip(start.tolist(), end.tolist())):
        locator.IntersectWithLine(a, b, TOLERANCE, found, cells)
        met += map(found.GetPoint, range(found.GetNumberOfPoints()))
        line += [k] * (len(met) - len(line))
    return np.array(line, np.intp), np.array(met).reshape(-1, 3)
