# SPDX-License-Identifier: GPL-2.0-only
"""Pieces of VTK that a picture is put together from: meshes that move, lit actors, edges of boxes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from . import shading, textures


class MovingMesh:
    """A triangle mesh whose vertices and normals are overwritten for every frame."""

    def __init__(self, vertices: int, triangle: np.ndarray):
        from vtkmodules.vtkCommonDataModel import vtkPolyData

        self.data = vtkPolyData()
        self.reshape(vertices, triangle)

    def reshape(self, vertices: int, triangle: np.ndarray) -> None:
        """Set the number of vertices, which are still to be moved, and the triangles, shape (T, 3)."""
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints

        points, normals = vtkPoints(), vtkFloatArray()
        points.SetDataTypeToFloat()
        points.SetNumberOfPoints(vertices)
        normals.SetNumberOfComponents(3)
        normals.SetNumberOfTuples(vertices)
        self.data.SetPoints(points)
        self.data.SetPolys(cells(triangle))
        self.data.GetPointData().SetNormals(normals)
        self._points, self._normals = vtk_to_numpy(points.GetData()), vtk_to_numpy(normals)

    @property
    def points(self) -> np.ndarray:
        """Where the vertices are [m], float32, shape (V, 3)."""
        return self._points

    @property
    def normals(self) -> np.ndarray:
        """Their normals, float32, shape (V, 3)."""
        return self._normals

    def paint(self, color: np.ndarray) -> None:
        """Colour every vertex, uint8, shape (V, 3)."""
        from vtkmodules.util.numpy_support import numpy_to_vtk

        colors = numpy_to_vtk(np.ascontiguousarray(color, dtype=np.uint8), deep=1)
        self.data.GetPointData().SetScalars(colors)

    def mark(self, name: str, values: np.ndarray) -> None:
        """Give every vertex numbers that a shader of `lit_actor` reads, float32, shape (V, C)."""
        from vtkmodules.util.numpy_support import numpy_to_vtk

        held = numpy_to_vtk(np.ascontiguousarray(values, dtype=np.float32), deep=1)
        held.SetName(name)
        self.data.GetPointData().AddArray(held)

    def move(self, vertices: np.ndarray, normals: np.ndarray) -> None:
        """Place the vertices [m] and turn their normals, each of shape (V, 3)."""
        self._points[:] = vertices
        self._normals[:] = normals
        self.data.GetPoints().Modified()
        self.data.GetPointData().GetNormals().Modified()
        self.data.Modified()


class MovingLine:
    """A closed line whose points are overwritten for every frame, and how much it covers at each."""

    def __init__(self, points: int, color: tuple[float, float, float], width: float):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkPoints, vtkUnsignedCharArray
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

        self._data, cells = vtkPolyData(), vtkCellArray()
        place, cover = vtkPoints(), vtkUnsignedCharArray()
        place.SetNumberOfPoints(points)
        cover.SetNumberOfComponents(4)
        cover.SetNumberOfTuples(points)
        self._points, self._colors = vtk_to_numpy(place.GetData()), vtk_to_numpy(cover)
        self._colors[:, :3] = 255 * np.array(color)
        cells.InsertNextCell(points + 1, [*range(points), 0])
        self._data.SetPoints(place)
        self._data.SetLines(cells)
        self._data.GetPointData().SetScalars(cover)
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(self._data)
        self.actor = vtkActor()
        self.actor.SetMapper(mapper)
        self.actor.ForceTranslucentOn()
        look = self.actor.GetProperty()
        look.LightingOff()
        look.SetLineWidth(width)

    def move(self, points: np.ndarray, opacity: np.ndarray) -> None:
        """Place the points [m], shape (P, 3), and say how much the line covers there, 0 to 1, shape (P,)."""
        self._points[:] = points
        self._colors[:, 3] = 255 * opacity
        self._data.GetPoints().Modified()
        self._data.GetPointData().GetScalars().Modified()
        self._data.Modified()


def texture(texels, width: int, height: int, smooth: bool):
    """An image of these texels, a VTK array, and the texture that shows it; ``smooth``: also what lies between."""
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkRenderingCore import vtkTexture

    image, shown = vtkImageData(), vtkTexture()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(texels)
    shown.SetInputData(image)
    shown.SetColorModeToDirectScalars()
    shown.SetInterpolate(smooth)
    shown.RepeatOff()
    shown.EdgeClampOn()
    return image, shown


def have_own_textures(actor, names: Sequence[str]) -> None:
    """Give an actor of another window textures of its own in place of those with these names; they show the same images."""
    from vtkmodules.vtkRenderingCore import vtkTexture

    look = actor.GetProperty()
    for name in names:
        if shared := look.GetTexture(name):
            own = vtkTexture()
            own.SetInputData(shared.GetInput())
            own.SetColorModeToDirectScalars()
            own.SetInterpolate(shared.GetInterpolate())
            own.RepeatOff()
            own.EdgeClampOn()
            look.RemoveTexture(name)
            look.SetTexture(name, own)


class Lookup:
    """Numbers on a grid for a shader to look up, overwritten for every frame: one for each place, or three.

    VTK makes bytes of the numbers of a texture unless each texel has three or four. So three hold one number, if no more are
    given; or, where ``packed``, four that lie side by side: a shader fetches x and y as
    ``texelFetch(name, ivec2(x / 4, y), 0)[x % 4]``.

    Args:
        width, height: of the grid; the width of a packed one is a multiple of four.
        smooth: whether the shader sees what lies between.
        packed: whether texels hold four numbers.
    """

    def __init__(self, width: int, height: int, *, smooth: bool = False, packed: bool = False):
        self._packed = packed
        self._image, self.texture = texture(self._hold(width, height), self._held.shape[1], height, smooth)

    def _hold(self, width: int, height: int):
        from vtkmodules.util.numpy_support import numpy_to_vtk

        held = np.zeros((height, width // 4, 4) if self._packed else (height, width, 3), dtype=np.float32)
        self.numbers = held.reshape(height, width) if self._packed else held[:, :, 0]
        self._held = held
        self._texels = numpy_to_vtk(held.reshape(-1, held.shape[2]))  # the same memory
        return self._texels

    def resize(self, width: int, height: int) -> None:
        """Have a grid of another size; ``numbers`` is then another array."""
        if self.numbers.shape != (height, width):
            self._image.GetPointData().SetScalars(self._hold(width, height))
            self._image.SetDimensions(self._held.shape[1], height, 1)

    def fill(self, numbers: np.ndarray) -> None:
        """Overwrite all, shape (height, width), or, with three numbers each, (height, width, 3)."""
        (self.numbers if numbers.ndim == 2 else self._held)[:] = numbers
        self.changed()

    def changed(self) -> None:
        """Say that ``numbers`` has been written to."""
        self._texels.Modified()
        self._image.Modified()


def lit_actor(data, light: str, *, liquid: bool, sky: bool, lamp: str = shading.LAMP, functions: str = "", mark: str = ""):
    """An actor for a mesh, lit by one of the shaders of ``shading``.

    Args:
        data: ``vtkPolyData``.
        light: the shader.
        liquid: whether it may be seen through liquid.
        sky: whether it is darker where objects hide the sky.
        lamp: how it sees the lamp, of ``shading``.
        functions: of ``shading`` or ``textures``, that only this shader uses.
        mark: name of numbers of vertices that it reads (`MovingMesh.mark`).
    """
    from vtkmodules.vtkRenderingCore import vtkActor
    from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLPolyDataMapper

    mapper = vtkOpenGLPolyDataMapper()
    mapper.SetInputData(data)
    # Positions reach the shader as they are, in metres.
    mapper.SetVBOShiftScaleMethod(0)
    actor = vtkActor()
    actor.SetMapper(mapper)
    shader = actor.GetShaderProperty()
    if mark:
        from vtkmodules.vtkCommonDataModel import vtkDataObject

        mapper.MapDataArrayToVertexAttribute(mark, mark, vtkDataObject.FIELD_ASSOCIATION_POINTS, -1)
    for place, code in (shading.VERTEX | (textures.VERTEX if mark else {})).items():
        shader.AddVertexShaderReplacement(place, True, code, False)
    for place, code in shading.fragment_head(liquid, sky, lamp, functions).items():
        shader.AddFragmentShaderReplacement(place, True, code, False)
    shader.AddFragmentShaderReplacement("//VTK::Light::Impl", True, light, False)
    return actor


def plane(low, high, height: float):
    """A level rectangle [m] as ``vtkPolyData``."""
    from vtkmodules.vtkFiltersSources import vtkPlaneSource

    source = vtkPlaneSource()
    source.SetOrigin(low[0], low[1], height)
    source.SetPoint1(high[0], low[1], height)
    source.SetPoint2(low[0], high[1], height)
    source.Update()
    # With texture coordinates VTK would paint the lamp's depth picture on it.
    source.GetOutput().GetPointData().SetTCoords(None)
    return source.GetOutput()


def box_edges(low, high, grey: float, opacity: float = 0.45, width: float = 1.5):
    """The twelve edges of a box [m] as an actor."""
    from vtkmodules.vtkFiltersSources import vtkOutlineSource
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    (x0, y0, z0), (x1, y1, z1) = low, high
    outline = vtkOutlineSource()
    outline.SetBounds(x0, x1, y0, y1, z0, z1)
    mapper, actor = vtkPolyDataMapper(), vtkActor()
    mapper.SetInputConnection(outline.GetOutputPort())
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.LightingOff()
    look.SetColor(grey, grey, grey)
    look.SetOpacity(opacity)
    look.SetLineWidth(width)
    return actor


class MovingLines:
    """Straight lines between points that move.

    Args:
        points: how many.
        ends: numbers of the two points of each line, shape (L, 2).
        color: red, green, blue from 0 to 1.
        width: in pixels.
    """

    def __init__(self, points: int, ends: np.ndarray, color: tuple[float, float, float], width: float):
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkPolyData
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

        self._data, self._points = vtkPolyData(), vtkPoints()
        self._points.SetNumberOfPoints(points)
        self._data.SetPoints(self._points)
        self._data.SetLines(cells(ends))
        mapper, self.actor = vtkPolyDataMapper(), vtkActor()
        mapper.SetInputData(self._data)
        self.actor.SetMapper(mapper)
        look = self.actor.GetProperty()
        look.LightingOff()
        look.SetColor(color)
        look.SetLineWidth(width)

    def move(self, position: np.ndarray) -> None:
        """Take places [m], shape (points, 3)."""
        from vtkmodules.util.numpy_support import numpy_to_vtk

        self._points.SetData(numpy_to_vtk(np.ascontiguousarray(position, dtype=np.float64), deep=1))
        self._data.Modified()


def cells(corners: np.ndarray):
    """Triangles, shape (T, 3), or lines, shape (L, 2), as ``vtkCellArray``."""
    from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    cells = vtkCellArray()
    flat = np.ascontiguousarray(corners, dtype=np.int64).ravel()
    cells.SetData(corners.shape[1], numpy_to_vtkIdTypeArray(flat, deep=1))
    return cells


def gl_matrix(matrix: np.ndarray):
    """A matrix, shape (4, 4), as VTK hands it to shaders: as it lies in memory, of which OpenGL reads columns first."""
    from vtkmodules.vtkCommonMath import vtkMatrix4x4

    found = vtkMatrix4x4()
    found.DeepCopy(matrix.T.ravel())
    return found
