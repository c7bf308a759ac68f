# SPDX-License-Identifier: GPL-2.0-only
"""The floor of a picture: how it looks, the shadow on it, and what of objects lies on its other side."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from ..scene.render import Quality, Render
from . import shading
from .camera import Action
from .framing import corner_rays
from .lens import View
from .palette import is_dark
from .pieces import MovingMesh, lit_actor, plane, texture

REACH = 5.0
"""How far the floor reaches from the middle of the action to each side, in sizes of the action."""
BELOW = 1e-4
"""How far the floor lies below where things stand, in sizes of the action."""
SOFT = 4
"""Width of the square over which the edge of a shadow is the mean, in pixels of the lamp's picture."""
SHADES = np.rint(255.0 * (1.0 - np.arange(SOFT**2 + 1) / SOFT**2)).astype(np.uint8)
"""Light on a floor of which this number of SOFT x SOFT pixels are hidden from the lamp."""


class FloorPlane:
    """A level square.

    Args:
        height: z of what stands on it [m].
        action: what stands on it.
        render: says what it looks like.
        background: red, green, blue of the background below and above.
        picture: height of the picture in pixels.
        finer: drawn pixels along a side of one that is shown.
        liquid: whether it may be seen through liquid.
    """

    def __init__(
        self,
        height: float,
        action: Action,
        render: Render,
        background: tuple[np.ndarray, np.ndarray],
        picture: int,
        finer: int,
        liquid: bool,
    ):
        self.height, (low, high) = height - BELOW * action.size, background
        self._middle, self._reach = action.centre[:2], REACH * action.size
        square = plane(self._middle - self._reach, self._middle + self._reach, self.height)
        shader, sky = shading.fragment_floor(render.floor.value), render.quality is Quality.FINAL
        functions = shading.floor_functions(render.floor.value)
        self.actor = lit_actor(square, shader, liquid=liquid, sky=sky, lamp=shading.LAMP_ON_FLOOR, functions=functions)
        dark, self._uniforms = is_dark(low), self.actor.GetShaderProperty().GetFragmentCustomUniforms()
        self._uniforms.SetUniformf("gridSpacing", grid_spacing(action.size))
        self._uniforms.SetUniformf("linePixels", float(finer))
        self._uniforms.SetUniformf("pictureHeight", float(picture))
        self._uniforms.SetUniform3f("floorCentre", [*self._middle, self._reach])
        self._uniforms.SetUniform3f("floorColor", list(np.minimum(1.0, low * 1.02) if not dark else low * 1.25 + 0.03))
        self._uniforms.SetUniform3f("gridColor", list(low * 0.72 if not dark else low + 0.22))
        self._uniforms.SetUniform3f("lowColor", list(low))
        self._uniforms.SetUniform3f("highColor", list(high))
        self.start_at(0)
        self._cover = MovingMesh(4, np.array([[0, 1, 2], [0, 2, 3]]))
        self.cover = nothing(self._cover.data)
        """Hides what is on the other side of the floor in a window without the floor; to be drawn first."""

    def start_at(self, row: int) -> None:
        """Tell the shader which row of the picture is the lowest one in the window."""
        self._uniforms.SetUniformf("pictureBottom", float(row))

    def covers(self, view: View, size: tuple[int, int]) -> bool:
        """Whether it is behind every pixel of a picture of this size."""
        way = corner_rays(view, size)
        with np.errstate(divide="ignore", invalid="ignore"):
            far = (self.height - view.eye[2]) / way[:, 2]
            at = view.eye[:2] + far[:, None] * way[:, :2]
        return bool(((far > 0.0) & (abs(at - self._middle) < self._reach).all(axis=1)).all())

    def hide(self, view: View, points: np.ndarray, triangle: np.ndarray, boxes: np.ndarray) -> None:
        """Have the cover where the floor hides something from the eye: triangles, shape (T, 3), of places [m], shape (P, 3), or
        what is in boxes with these corners [m], shape (B, 8, 3)."""
        eye = view.eye
        corners = boxes.reshape(-1, 3)
        cells = [(points, triangle), (corners, np.arange(len(corners)).reshape(-1, 8))]
        found = [np.zeros((0, 2))]
        for place, cell in cells:
            beyond = (place[:, 2] - self.height) * (eye[2] - self.height) < 0.0
            part = (eye[2] - self.height) / (eye[2] - place[beyond, 2])
            found.append(eye[:2] + part[:, None] * (place[beyond, :2] - eye[:2]))
            if beyond.any():
                # A cell that goes through the floor is hidden from there on.
                through = beyond[cell].any(axis=1) & ~beyond[cell].all(axis=1)
                found.append(place[cell[through].ravel(), :2])
        at = np.concatenate(found)
        self.cover.SetVisibility(len(at) > 0)
        if len(at):
            margin = 0.01 * self._reach
            (x, y), (right, top) = (
                np.clip(edge, self._middle - self._reach, self._middle + self._reach)
                for edge in (at.min(axis=0) - margin, at.max(axis=0) + margin)
            )
            square = np.array([(x, y), (right, y), (right, top), (x, top)])
            self._cover.move(np.column_stack([square, np.full(4, self.height)]), np.tile([0.0, 0.0, 1.0], (4, 1)))


def _softened(hides: np.ndarray, count: int) -> np.ndarray:
    """Numbers of true ones in squares of SOFT x SOFT, uint8, shape (K, count, count), of bool (K, count + SOFT - 1, ...)."""
    total = hides.view(np.uint8)
    rows = sum(total[:, k : count + k] for k in range(SOFT))
    return sum(rows[:, :, k : count + k] for k in range(SOFT))


def nothing(data):
    """An actor of ``vtkPolyData`` that hides what is behind it, and is not seen; to be drawn first."""
    from vtkmodules.vtkRenderingCore import vtkActor
    from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLPolyDataMapper

    mapper, actor = vtkOpenGLPolyDataMapper(), vtkActor()
    mapper.SetInputData(data)
    actor.SetMapper(mapper)
    actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Light::Impl", True, shading.FRAGMENT_NOTHING, False)
    return actor


class FloorShade:
    """How much of the lamp a floor sees, for shaders to look up: a picture along its rays, soft as other shadows are.

    Args:
        height: of the floor [m].
    """

    def __init__(self, height: float):
        self._height = height
        self._image, self.texture = texture(self._hold(1, 1), 1, 1, smooth=True)
        self._dark = np.zeros((2, 0), int)
        self.corners = np.zeros((0, 3))
        """Corners of the part of the floor that is not in full light [m], shape (4, 3) or (0, 3)."""

    def _hold(self, rows: int, columns: int):
        from vtkmodules.util.numpy_support import numpy_to_vtk

        self._seen = np.full((rows, columns), 255, np.uint8)
        self._dark = np.zeros((2, 0), int)
        self._texels = numpy_to_vtk(self._seen.reshape(-1))  # the same memory
        return self._texels

    @contextmanager
    def lifted(self) -> Iterator[None]:
        """Have full light everywhere for a while."""
        kept = self._seen.copy()
        self._seen[:] = 255
        self._changed()
        yield
        self._seen[:] = kept
        self._changed()

    def cast(self, depth: np.ndarray, nearest: np.ndarray, matrix: np.ndarray) -> None:
        """Take a depth picture along the lamp's rays.

        Args:
            depth: from 0 to 1, shape (h, w).
            nearest: least depths in and around blocks of its pixels, fewer of them.
            matrix: from the world to that picture, x, y and depth from 0 to 1, shape (4, 4).
        """
        if self._seen.shape != depth.shape:
            self._image.GetPointData().SetScalars(self._hold(*depth.shape))
            self._image.SetDimensions(*depth.shape[::-1], 1)
        self._back = np.linalg.inv(matrix)
        block = len(depth) // len(nearest)
        seen = self._seen.reshape(len(nearest), block, -1, block)
        seen[self._dark[0], :, self._dark[1]] = 255
        at = np.stack(np.nonzero(nearest < 1.0))
        # Pixels of each block, and those that count in its means.
        y, x = block * at[:, :, None] + np.arange(-2, block + SOFT - 3)
        y, x = y.clip(0, len(depth) - 1), x.clip(0, depth.shape[1] - 1)
        hidden = _softened(depth[y[:, :, None], x[:, None, :]] <= self._depth_of_floor(x, y), block)
        some = hidden.any(axis=(1, 2))
        self._dark = at[:, some]
        seen[self._dark[0], :, self._dark[1]] = SHADES[hidden[some]]
        self.corners = np.zeros((0, 3))
        if some.any():
            self._bound(block * self._dark.min(axis=1), block * (self._dark.max(axis=1) + 1))
        self._changed()

    def _depth_of_floor(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Depth of the floor at pixels x (K, a) and y (K, b), less than that where nothing is, float32, shape (K, b, a)."""
        one, across, up = self._plane()
        rows, columns = self._seen.shape
        flat = (one + across * (x + 0.5) / columns)[:, None, :] + (up * (y + 0.5) / rows)[:, :, None]
        return np.minimum(flat, 1.0 - 1e-7).astype(np.float32)

    def _plane(self) -> np.ndarray:
        """Depth at the floor is a + b x + c y: z is linear in x, y and depth."""
        x, y, depth, one = self._back[2]
        return np.array([(self._height - one) / depth, -x / depth, -y / depth])

    def _bound(self, low: np.ndarray, high: np.ndarray) -> None:
        y, x = ((np.array([a - SOFT, b + SOFT])) / count for a, b, count in zip(low, high, self._seen.shape))
        x, y = x[[0, 1, 1, 0]], y[[0, 0, 1, 1]]
        at = np.stack([x, y, self._plane() @ [np.ones(4), x, y], np.ones(4)])
        self.corners = (self._back @ at)[:3].T

    def _changed(self) -> None:
        self._texels.Modified()
        self._image.Modified()


def grid_spacing(size: float) -> float:
    """Distance of the floor's lines: 1, 2 or 5 times a power of ten, about a twelfth of the action [m]."""
    exponent = np.floor(np.log10(size / 12.0))
    fraction = size / 12.0 / 10.0**exponent
    return float((1.0 if fraction < 1.5 else 2.0 if fraction < 3.5 else 5.0 if fraction < 7.5 else 10.0) * 10.0**exponent)
