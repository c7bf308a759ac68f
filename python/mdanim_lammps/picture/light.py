# SPDX-License-Identifier: GPL-2.0-only
"""The lamp and the sky: depth pictures of all objects along parallel rays, and what shaders look up in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ..scene.render import Quality, Render
from .floor import FloorPlane, FloorShade
from .pieces import Lookup, gl_matrix
from .rays import FAR, NEAR, ROOM, SKY_PIXELS, axes, direction, sky_axes
from .window import off_screen_window

PIXELS, MORE_PIXELS = 1024, 2048
"""Pixels of the lamp's picture, along a side; more where objects are small, and in final quality."""
REACH = 1.5
"""Distance to which surfaces that hide the sky have an effect, in sizes of an object."""
BLOCK = 16
"""Pixels of the lamp's picture, along a side, of which the nearest to the lamp is known."""


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
        from vtkmodules.util.numpy_support import numpy_to_vtk
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
        self._size = side * pixels
        self._window = off_screen_window(renderers, (self._size, self._size), samples=0)
        self.depth = Lookup(self._size, self._size, packed=True)
        self._values = numpy_to_vtk(self.depth.numbers.ravel())  # the same memory

    def take(self) -> None:
        """Draw the mesh as it is now; only one window can be drawn into at a time."""
        self._window.Render()
        self._window.GetZbufferData(0, 0, self._size - 1, self._size - 1, self._values)
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
        self._lamp = DepthPictures(data, centre, self._radius, axes(self._toward)[None], self._pixels)
        self._nearest = Lookup(self._pixels // BLOCK, self._pixels // BLOCK, packed=True)
        self._sky = DepthPictures(data, centre, self._radius, sky_axes(), SKY_PIXELS) if final else None
        self.shade = FloorShade(floor.height, self._matrix(), self._pixels) if floor else None
        self._floor = floor

    def cast(self) -> None:
        """Take the depth pictures of a frame, apart from the main window."""
        self._lamp.take()
        self._nearest.fill(nearest_around(self._lamp.depth.numbers, BLOCK))
        if self.shade:
            self.shade.cast(self._lamp.depth.numbers, self._nearest.numbers)
        if self._sky:
            self._sky.take()

    def fall_on(self, actors: Sequence) -> None:
        """Hand shaders what they look up; once, after the actors are made."""
        matrix = gl_matrix(self._matrix())
        for actor in actors:
            look = actor.GetProperty()
            if self._floor and self.shade and actor is self._floor.actor:
                look.SetTexture("floorShade", self.shade.texture)
            else:
                look.SetTexture("lampDepth", self._lamp.depth.texture)
                look.SetTexture("lampNearest", self._nearest.texture)
            uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniformMatrix("lampMatrix", matrix)
            uniforms.SetUniformf("lampPixels", float(self._pixels))
            uniforms.SetUniformi("lampBlock", BLOCK)
            # As much depth as a pixel is wide.
            uniforms.SetUniformf("lampTouch", 2.0 * ROOM / (FAR - NEAR) / self._pixels)
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

    def _matrix(self) -> np.ndarray:
        """From the world to the lamp's picture: x, y and depth from 0 to 1."""
        matrix = np.eye(4)
        scale = np.array([0.5 / ROOM, 0.5 / ROOM, -1.0 / (FAR - NEAR)]) / self._radius
        matrix[:3, :3] = scale[:, None] * axes(self._toward)
        matrix[:3, 3] = [0.5, 0.5, (2.0 - NEAR) / (FAR - NEAR)] - matrix[:3, :3] @ self._centre
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
    return sliding_window_view(np.pad(least, 1, mode="edge"), (3, 3)).min(axis=(2, 3))
