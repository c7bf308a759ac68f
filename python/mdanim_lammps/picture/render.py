# SPDX-License-Identifier: GPL-2.0-only
"""One frame of a trajectory as a picture, drawn off screen with VTK."""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np

from ..errors import SetupError
from ..results.trajectory import Trajectory
from ..scene.scene import Render
from . import shading
from .camera import FIELD_OF_VIEW, Action, CameraPath, View, action_of, automatic_view
from .marks import MarkActors, Marks
from .palette import background_colors, is_dark, object_colors
from .pieces import Field, MovingMesh, box_edges, lit_actor, plane
from .surfaces import shaded_mesh
from .tank import Tank

LAMP = np.array([-0.45, -0.55, 1.15]) / np.linalg.norm([-0.45, -0.55, 1.15])
"""Direction to the key light, world frame."""
FLOOR = 5.0
"""How far the floor reaches from the middle of the action to each side, in sizes of the action."""
SHADOW_PIXELS, SHADOW_PIXELS_OF_A_CROWD = 1024, 2048
SHADOW_BLOCK = 16
"""Pixels of the shadow, along a side, of which the nearest to the lamp is known."""


class Painter:
    """Draws frames of one trajectory, all with the same lamp, floor and, unless the scene moves it, camera.

    Args:
        trajectory: what is drawn.
        render: the scene's ``render`` block; ``Render()`` chooses everything.
        size: width and height in pixels; None takes that of ``render``.
        action: bounds over all frames, if known already; None finds them.
        marks: what is shown beside the surfaces.

    Raises:
        SetupError: this host cannot draw off screen.
        UsageError: marks that this trajectory cannot have.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        render: Render = Render(),
        *,
        size: tuple[int, int] | None = None,
        action: Action | None = None,
        marks: Marks = Marks(),
    ):
        self.trajectory = trajectory
        self.size = tuple(size or render.size)
        self.action = action or action_of(trajectory)
        self._path = CameraPath(render.camera, trajectory) if render.camera else None
        walls, pool = trajectory.metadata.walls, trajectory.liquid
        basin = (pool.low, pool.high) if pool else None
        aspect = self.size[0] / self.size[1]
        self._still = None if self._path else automatic_view(self.action, aspect, walls, basin)
        self._mesh = shaded_mesh(trajectory.metadata, trajectory.position(0), self._pixel())
        self._build(render, marks)

    def _pixel(self) -> np.ndarray:
        """What a pixel covers of each object where it comes nearest to the camera [m], shape (M,)."""
        times = self.trajectory.times
        stretches = np.array_split(np.arange(len(times)), len(self.action.low))
        eyes = [np.array([self.view(float(times[n])).eye for n in frames]) for frames in stretches]
        near = np.full(self.action.low.shape[1], np.inf)
        for low, high, eye in zip(self.action.low, self.action.high, eyes):
            away = np.maximum(np.maximum(low - eye[:, None], eye[:, None] - high), 0.0)
            near = np.minimum(near, np.linalg.norm(away, axis=2).min(axis=0))
        return 2.0 * near * np.tan(np.radians(FIELD_OF_VIEW) / 2.0) / self.size[1]

    def view(self, time: float) -> View:
        """Where the camera is at a simulated time [s]."""
        return self._path.at(time) if self._path else self._still

    def frame(self, index: int) -> np.ndarray:
        """Picture of a frame, uint8 RGB, shape (height, width, 3), first row on top."""
        position = self.trajectory.position(index)
        vertices = self._mesh.vertices(position)
        time = float(self.trajectory.times[index])
        self._surface.move(vertices, self._mesh.normals(vertices, position))
        if self._tank:
            self._tank.show(index, position)
        self._marks.show(position)
        self._stamp.SetInput(f"t = {time:.2f} s")
        self._aim(self.view(time))
        self._cast_shadow()
        self._window.Render()
        return self._pixels()

    def close(self) -> None:
        """Release the windows."""
        for window in (self._window, self._shadow):
            window.Finalize()

    def __enter__(self) -> Painter:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    # --- the stage -----------------------------------------------------------------------------------------

    def _build(self, render: Render, marks: Marks) -> None:
        import vtkmodules.vtkInteractionStyle
        import vtkmodules.vtkRenderingFreeType
        import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
        from vtkmodules.vtkRenderingCore import vtkRenderer

        low, high = background_colors(render.background)
        self._renderer = vtkRenderer()
        self._renderer.SetBackground(low)
        self._renderer.SetBackground2(high)
        self._renderer.GradientBackgroundOn()
        self._renderer.SetUseHiddenLineRemoval(False)
        # What is translucent is laid over the rest in the order of adding.
        self._renderer.SetUseOIT(False)
        camera = self._renderer.GetActiveCamera()
        camera.SetViewAngle(FIELD_OF_VIEW)

        metadata, dark = self.trajectory.metadata, is_dark(low)
        self._tank = Tank(self.trajectory, render.liquid, dark) if metadata.liquid else None
        floor, (x, y, _), reach = self._floor_height(), self.action.centre, FLOOR * self.action.size
        self._surface = MovingMesh(self._mesh.carry.shape[0], self._mesh.triangle)
        self._surface.paint(object_colors(metadata.colors, metadata.still)[self._mesh.object_of_vertex])
        self._actors = [lit_actor(self._surface.data, shading.FRAGMENT_SOLID, bool(self._tank))]
        self._actors[0].SetVisibility(not marks.springs)
        # Objects are closed, so their inner faces are never visible, and drawing these takes time.
        self._actors[0].GetProperty().BackfaceCullingOn()
        if self._tank:
            # Before the floor: pixels that are hidden are not shaded.
            self._actors.append(self._tank.plate)
        if floor is not None:
            self._actors.append(self._make_floor(floor, low, high))
        for actor in self._actors:
            self._renderer.AddActor(actor)
        if metadata.walls is not None:
            self._renderer.AddActor(box_edges(*metadata.walls, 0.8 if dark else 0.35))
        if self._tank:
            for actor in self._tank.actors:
                self._renderer.AddActor(actor)
            self._actors += self._tank.skin
            self._tank.colour_through(self._actors)
            self._tank.stand_on(0.0 if floor is None else floor, (x, y, 0.0 if floor is None else reach))
        self._marks = MarkActors(marks, metadata, dark, self.size[1])
        for actor in self._marks.actors:
            self._renderer.AddViewProp(actor)
        self._write(render, low)

        with _silent():
            self._window = _window(self._renderer, self.size, samples=4)
            self._shadow, self._depth, self._nearest = self._make_shadow()
        self._share_shadow()

    def _floor_height(self) -> float | None:
        """The ground; without one the lowest point of the action, unless something falls through there."""
        metadata = self.trajectory.metadata
        if metadata.ground is not None:
            # The ground would hide a basin that is sunk into it.
            return min(metadata.ground, metadata.liquid.low[2] if metadata.liquid else metadata.ground)
        return None if self.action.escaped else float(self.action.bounds[0][2])

    def _make_floor(self, height: float, low: np.ndarray, high: np.ndarray):
        centre, size = self.action.centre, self.action.size
        reach = FLOOR * size
        ground = plane(centre - reach, centre + reach, height - 1e-4 * size)
        actor = lit_actor(ground, shading.FRAGMENT_FLOOR, bool(self._tank))
        dark = is_dark(low)
        uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
        uniforms.SetUniformf("gridSpacing", grid_spacing(size))
        uniforms.SetUniformf("pictureHeight", float(self.size[1]))
        uniforms.SetUniform3f("floorCentre", [centre[0], centre[1], reach])
        uniforms.SetUniform3f("floorColor", list(np.minimum(1.0, low * 1.02) if not dark else low * 1.25 + 0.03))
        uniforms.SetUniform3f("gridColor", list(low * 0.72 if not dark else low + 0.22))
        uniforms.SetUniform3f("lowColor", list(low))
        uniforms.SetUniform3f("highColor", list(high))
        return actor

    def _write(self, render: Render, background: np.ndarray) -> None:
        from vtkmodules.vtkRenderingCore import vtkTextActor

        height = self.size[1]
        color = (0.93, 0.94, 0.95) if is_dark(background) else (0.20, 0.23, 0.27)
        margin = round(0.035 * height)

        def text(words: str, at: tuple[int, int], share: float, right: bool = False):
            actor = vtkTextActor()
            actor.SetInput(words)
            actor.SetPosition(*at)
            look = actor.GetTextProperty()
            look.SetFontFamilyToArial()
            look.SetFontSize(max(9, round(share * height)))
            look.SetColor(color)
            look.SetOpacity(0.85)
            look.SetJustificationToRight() if right else look.SetJustificationToLeft()
            self._renderer.AddViewProp(actor)
            return actor

        text(self.trajectory.metadata.title, (margin, margin), 0.032)
        self._stamp = text("", (self.size[0] - margin, margin), 0.028, right=True)

    # --- the shadow ----------------------------------------------------------------------------------------

    def _make_shadow(self):
        """A depth picture of all objects, seen from the lamp along parallel rays."""
        from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer

        centre, radius = self.action.centre, 0.5 * self.action.size
        extent = self.action.high[0] - self.action.low[0]
        small = float(np.median(np.linalg.norm(extent, axis=1))) < self.action.size / 30.0
        self._shadow_pixels = SHADOW_PIXELS_OF_A_CROWD if small else SHADOW_PIXELS
        pixels = (self._shadow_pixels, self._shadow_pixels)
        mapper, actor, renderer = vtkPolyDataMapper(), vtkActor(), vtkRenderer()
        mapper.SetInputData(self._surface.data)
        mapper.ScalarVisibilityOff()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        renderer.AddActor(actor)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(centre)
        camera.SetPosition(centre + 2 * radius * LAMP)
        camera.SetViewUp(0.0, 1.0, 0.0)
        camera.SetParallelScale(radius * 1.02)
        camera.SetClippingRange(0.9 * radius, 3.1 * radius)
        window = _window(renderer, pixels, samples=0)
        blocks = self._shadow_pixels // SHADOW_BLOCK
        return window, Field(*pixels, smooth=False), Field(blocks, blocks, smooth=False)

    def _cast_shadow(self) -> None:
        """Take the depth picture, apart from the main one: only one window can be drawn into at a time."""
        self._shadow.Render()
        last = self._shadow_pixels - 1
        self._shadow.GetZbufferData(0, 0, last, last, self._depth.values)
        self._depth.changed()
        self._nearest.fill(nearest_around(self._depth.numbers, SHADOW_BLOCK))

    def _share_shadow(self) -> None:
        from vtkmodules.vtkCommonMath import vtkMatrix4x4

        camera = self._shadow.GetRenderers().GetFirstRenderer().GetActiveCamera()
        to_clip = camera.GetCompositeProjectionTransformMatrix(1.0, 0.0, 1.0)
        matrix = np.array([[to_clip.GetElement(i, j) for j in range(4)] for i in range(4)])
        # x and y from -1 .. 1 to the texture's 0 .. 1; z is 0 .. 1 already.
        matrix[:2] = 0.5 * matrix[:2] + 0.5 * matrix[3]
        width = 2 * camera.GetParallelScale()
        texel = width / self._shadow_pixels
        near, far = camera.GetClippingRange()
        lamp_matrix = vtkMatrix4x4()
        # VTK hands its matrices to OpenGL as they lie in memory, and OpenGL reads columns first.
        lamp_matrix.DeepCopy(matrix.T.ravel())
        for actor in self._actors:
            actor.GetProperty().SetTexture("lampDepth", self._depth.texture)
            actor.GetProperty().SetTexture("lampNearest", self._nearest.texture)
            uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniformMatrix("lampMatrix", lamp_matrix)
            uniforms.SetUniformf("lampTexel", texel)
            uniforms.SetUniformf("lampPixels", float(self._shadow_pixels))
            uniforms.SetUniformi("lampBlock", SHADOW_BLOCK)
            uniforms.SetUniformf("lampBias", 2.5 * texel / (far - near))
            uniforms.SetUniform3f("lamp", list(LAMP))
            uniforms.SetUniform3f("eye", [0.0, 0.0, 0.0])

    # --- one picture ---------------------------------------------------------------------------------------

    def _aim(self, view: View) -> None:
        camera = self._renderer.GetActiveCamera()
        camera.SetPosition(view.eye)
        camera.SetFocalPoint(view.look)
        camera.SetViewUp(view.up)
        self._renderer.ResetCameraClippingRange()
        for actor in self._actors:
            actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniform3f("eye", list(view.eye))

    def _pixels(self) -> np.ndarray:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

        width, height = self.size
        data = vtkUnsignedCharArray()
        self._window.GetPixelData(0, 0, width - 1, height - 1, 0, data, 0)
        return vtk_to_numpy(data).reshape(height, width, 3)[::-1].copy()


def nearest_around(depth: np.ndarray, block: int) -> np.ndarray:
    """Least depth in each block of pixels and the eight around it.

    Args:
        depth: shape (n, m).
        block: pixels along a side, a divisor of n and m.

    Returns:
        shape (n / block, m / block).
    """
    from scipy.ndimage import minimum_filter

    n, m = depth.shape
    least = depth.reshape(n // block, block, m).min(axis=1).reshape(n // block, m // block, block).min(axis=2)
    return minimum_filter(least, 3, mode="nearest")


def grid_spacing(size: float) -> float:
    """Distance of the floor's lines: 1, 2 or 5 times a power of ten, about a twelfth of the action [m]."""
    exponent = np.floor(np.log10(size / 12.0))
    fraction = size / 12.0 / 10.0**exponent
    return float((1.0 if fraction < 1.5 else 2.0 if fraction < 3.5 else 5.0 if fraction < 7.5 else 10.0) * 10.0**exponent)


def _window(renderer, size: tuple[int, int], samples: int):
    """An off-screen window, or SetupError with what is missing."""
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*size)
    window.SetMultiSamples(samples)
    # Pictures are read from the buffer that is drawn into; the other one is not used.
    window.SwapBuffersOff()
    window.AddRenderer(renderer)
    window.Initialize()
    if not window.SupportsOpenGL():
        raise SetupError(
            f"pictures need OpenGL 3.2, and {window.GetClassName()} found none on this host; install Mesa "
            "(Debian: apt install libegl1 libosmesa6), or run with --no-movie and render the folder elsewhere"
        )
    return window


@contextmanager
def _silent():
    """Silence VTK's message that there is no X server, which off-screen drawing does not need."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)
