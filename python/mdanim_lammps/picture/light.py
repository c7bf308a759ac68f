# SPDX-License-Identifier: GPL-2.0-only
"""The lamp and the sky: depth pictures of all objects along parallel rays, and what shaders look up in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..scene.render import Quality, Render
from .floor import FloorPlane, FloorShade
from .framing import PicturePart
from .pieces import Lookup, gl_matrix
from .rays import FAR, NEAR, ROOM, SKY_PIXELS, axes, direction, sky_axes
from .window import off_screen_window

PIXELS, MORE_PIXELS = 1024, 2048
"""Pixels of the lamp's picture, along a side; more where objects are small, and in final quality."""
REACH = 1.5
"""Distance to which surfaces that hide the sky have an effect, in sizes of an object."""
BLOCK = 8
"""Pixels of the lamp's picture, along a side, of which the nearest to the lamp is known."""
EDGE, STEEP = 3, 42
"""How far from a point its shadow is looked up, in pixels, and by how much nearer the surface may be there, in depths that are a
pixel wide: on a slope of 0.15 to the lamp, as shaders have it at most, along both axes."""
STEP, AROUND = 64, 4
"""The drawn part of the lamp's picture begins and ends at a multiple of the first, and so many pixels around what is in it."""


class DepthPictures:
    """Depth of a mesh along parallel rays from one or several directions, side by side in one picture.

    Args:
        data: ``vtkPolyData``.
        centre: middle of the shown sphere [m].
        radius: of that sphere [m].
        frames: `axes` of each direction, shape (K, 3, 3); K is a square number.
        pixels: of each along a side.
    """

    def __init__(self, data, centre: np.ndarray, radius: float, frames: np.ndarray, pixels: int):
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer

        side = round(len(frames) ** 0.5)
        mapper, actor, renderers = vtkPolyDataMapper(), vtkActor(), []
        mapper.SetInputData(data)
        mapper.ScalarVisibilityOff()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        actor.GetProperty().BackfaceCullingOn()
        for k, (_, up, toward) in enumerate(frames):
            renderer = vtkRenderer()
            x, y = k % side, k // side
            renderer.SetViewport(x / side, y / side, (x + 1) / side, (y + 1) / side)
            renderer.AddActor(actor)
            camera = renderer.GetActiveCamera()
            camera.ParallelProjectionOn()
            camera.SetFocalPoint(centre)
            camera.SetPosition(centre + 2 * radius * toward)
            camera.SetViewUp(up)
            camera.SetParallelScale(ROOM * radius)
            camera.SetClippingRange(NEAR * radius, FAR * radius)
            renderers.append(renderer)
        self._renderers, self._scale = renderers, ROOM * radius / pixels
        self._pixels, self._size = pixels, (side * pixels, side * pixels)
        self._window = off_screen_window(renderers, self._size, samples=0)
        self.depth = Lookup(*self._size, packed=True)

    def take(self, part: PicturePart | None = None) -> None:
        """Draw the mesh as it is now; only one window can be drawn into at a time. ``part``: of a single picture, which is then
        all that ``depth`` has."""
        from vtkmodules.util.numpy_support import numpy_to_vtk

        if part:
            (width, height), camera = part.size, self._renderers[0].GetActiveCamera()
            self._size = width, height
            self._window.SetSize(width, height)
            camera.SetParallelScale(self._scale * height)
            camera.SetWindowCenter(
                (part.left + part.right - self._pixels) / width, (part.bottom + part.top - self._pixels) / height
            )
            self.depth.resize(width, height)
        self._window.Render()
        values = numpy_to_vtk(self.depth.numbers.ravel())  # the same memory
        self._window.GetZbufferData(0, 0, self._size[0] - 1, self._size[1] - 1, values)
        self.depth.changed()

    def close(self) -> None:
        """Release the window."""
        self._window.Finalize()


class Light:
    """The light on lit actors: the lamp with its shadows and, where it is wanted, the sky as far as it is seen from each point.

    Args:
        data: ``vtkPolyData`` of all objects.
        centre: middle of the action [m].
        size: of the action [m].
        typical: size of an object [m].
        render: says where the lamp is, how dark shadows are, and whether the sky is looked at.
        floor: where shadows fall; None without one.
    """

    def __init__(self, data, centre: np.ndarray, size: float, typical: float, render: Render, floor: FloorPlane | None):
        self._centre, self._radius, self._darkness = centre, 0.5 * size, render.shadows
        self._toward = direction(render.light)
        self._reach = min(REACH * typical, self._radius)
        final = render.quality is Quality.FINAL
        self._pixels = MORE_PIXELS if final or typical < size / 30.0 else PIXELS
        self._touch = 2.0 * ROOM / (FAR - NEAR) / self._pixels  # as much depth as a pixel is wide
        self._lamp = DepthPictures(data, centre, self._radius, axes(self._toward)[None], self._pixels)
        self._sky = DepthPictures(data, centre, self._radius, sky_axes(), SKY_PIXELS) if final else None
        self.shade = FloorShade(floor.height) if floor else None
        self._floor = floor

    def cast(self, points: np.ndarray) -> None:
        """Take the depth pictures of a frame, apart from the main window, and hand shaders what they look up; ``points`` [m],
        shape (P, 3), are those of surfaces."""
        part = self._part(points)
        self._lamp.take(part)
        matrix, (width, height) = self._matrix(part), part.size
        nearest = nearest_around(self._lamp.depth.numbers, BLOCK)
        if self.shade:
            self.shade.cast(self._lamp.depth.numbers, nearest, matrix)
        if self._sky:
            self._sky.take()
        self._cast = matrix, nearest
        found = gl_matrix(matrix)
        for uniforms in self._uniforms:
            uniforms.SetUniformMatrix("lampMatrix", found)
            uniforms.SetUniform2f("lampPixels", [float(width), float(height)])

    def may_shade(self, points: np.ndarray, triangle: np.ndarray) -> np.ndarray:
        """Which triangles, shape (T, 3), of points [m], shape (P, 3), something may shade in this frame, bool, shape (T,)."""
        matrix, nearest = self._cast
        size = np.array(nearest.shape[::-1])
        at = points @ matrix[:3, :3].T + matrix[:3, 3]
        block = at[:, :2] * size
        y, x = np.clip(np.floor(block).astype(int), 0, size - 1)[:, ::-1].T
        corner = block[triangle]
        wide = np.ptp(corner, axis=1).max(axis=1) + EDGE / BLOCK
        # Where a triangle is wider than a block, more of these around its corners count.
        shaded, reach = np.zeros(len(triangle), bool), np.ceil(wide)
        for n in range(1, int(reach.max(initial=0.0)) + 1):
            if n > 1:
                nearest = _of_nine(nearest)
            own = triangle[reach == n]
            shaded[reach == n] = (nearest[y, x] < at[:, 2] + STEEP * self._touch)[own].any(axis=1)
        return shaded

    def fall_on(self, actors: Sequence) -> None:
        """Say where light falls; once, after the actors are made."""
        self._uniforms = [actor.GetShaderProperty().GetFragmentCustomUniforms() for actor in actors]
        for actor, uniforms in zip(actors, self._uniforms):
            look = actor.GetProperty()
            if self._floor and self.shade and actor is self._floor.actor:
                look.SetTexture("floorShade", self.shade.texture)
            else:
                look.SetTexture("lampDepth", self._lamp.depth.texture)
            uniforms.SetUniformf("lampTouch", self._touch)
            uniforms.SetUniformf("shadowDarkness", self._darkness)
            for name, axis in zip(("lampRight", "lampUp", "lamp"), axes(self._toward).tolist()):
                uniforms.SetUniform3f(name, axis)
            uniforms.SetUniform3f("eye", [0.0, 0.0, 0.0])
            if self._sky:
                look.SetTexture("skyDepth", self._sky.depth.texture)
                uniforms.SetUniform3f("skyCentre", list(self._centre))
                uniforms.SetUniformf("skyRadius", self._radius)
                uniforms.SetUniformf("skyReach", self._reach)

    def close(self) -> None:
        """Release the windows."""
        self._lamp.close()
        if self._sky:
            self._sky.close()

    def _part(self, points: np.ndarray) -> PicturePart:
        """The part of the lamp's picture in which these points are."""
        low = high = np.full(2, 0.5 * self._pixels)
        if len(points):
            across = (points - self._centre) @ axes(self._toward)[:2].T
            at = (0.5 + (0.5 / ROOM / self._radius) * np.stack([across.min(axis=0), across.max(axis=0)])) * self._pixels
            low, high = at[0] - AROUND, at[1] + AROUND
        low = np.clip(np.floor(low / STEP) * STEP, 0, self._pixels - STEP)
        high = np.maximum(np.clip(np.ceil(high / STEP) * STEP, 0, self._pixels), low + STEP)
        return PicturePart(*low.astype(int).tolist(), *high.astype(int).tolist())

    def _matrix(self, part: PicturePart) -> np.ndarray:
        """From the world to a part of the lamp's picture: x, y and depth from 0 to 1."""
        matrix = np.eye(4)
        size = np.array(part.size) / self._pixels
        scale = np.array([*(0.5 / ROOM / size), -1.0 / (FAR - NEAR)]) / self._radius
        matrix[:3, :3] = scale[:, None] * axes(self._toward)
        middle = (0.5 - np.array([part.left, part.bottom]) / self._pixels) / size
        matrix[:3, 3] = [*middle, (2.0 - NEAR) / (FAR - NEAR)] - matrix[:3, :3] @ self._centre
        return matrix


def nearest_around(depth: np.ndarray, block: int) -> np.ndarray:
    """Least depth in each block of pixels and the eight around it.

    Args:
        depth: shape (n, m).
        block: pixels along a side, a divisor of n and m.

    Returns:
        shape (n / block, m / block).
    """
    n, m = depth.shape
    least = depth.reshape(n // block, block, m).min(axis=1).reshape(n // block, m // block, block).min(axis=2)
    return _of_nine(least)


def _of_nine(least: np.ndarray) -> np.ndarray:
    """The least of each number and the eight around it, shape (n, m)."""
    rows = np.concatenate([least[:1], least, least[-1:]])
    rows = np.minimum(np.minimum(rows[:-2], rows[2:]), least)
    both = np.concatenate([rows[:, :1], rows, rows[:, -1:]], axis=1)
    return np.minimum(np.minimum(both[:, :-2], both[:, 2:]), rows)
