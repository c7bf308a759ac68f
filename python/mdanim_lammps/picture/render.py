# SPDX-License-Identifier: GPL-2.0-only
"""One frame of a trajectory as a picture, drawn off screen with VTK."""

from __future__ import annotations

import numpy as np

from ..errors import UsageError
from ..results.trajectory import Trajectory
from ..scene.render import Floor, Quality, Render
from . import shading
from .behind import Behind
from .camera import FIELD_OF_VIEW, Action, CameraPath, View, action_of, automatic_view
from .drawn import Additions, medium
from .light import Light
from .marks import MarkActors, Marks
from .palette import background_colors, is_dark, vertex_colors
from .pieces import MovingMesh, box_edges, lit_actor, plane
from .scenery import scenery
from .surfaces import shaded_mesh
from .window import fewer_pixels, off_screen_window, pixels, silent

FLOOR = 5.0
"""How far the floor reaches from the middle of the action to each side, in sizes of the action."""
FINER = {Quality.DRAFT: 1, Quality.FINAL: 2}
"""Pixels that are drawn along each side of one that is shown."""
SAMPLES = 4
"""Samples along an edge of each drawn pixel."""
MOST_PIXELS = 16384
"""Pixels that Mesa draws along a side."""


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
        UsageError: marks that this trajectory cannot have, or a picture too large for its quality.
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
        self._finer = FINER[render.quality]
        if self._finer > 1 and max(self.size) * self._finer > MOST_PIXELS:
            raise UsageError(
                f"a picture of {self.size[0]} x {self.size[1]} pixels is too large for quality final, which draws "
                f"{self._finer} times as many along each side; take at most {MOST_PIXELS // self._finer}, or quality draft"
            )
        self.action = action or action_of(trajectory)
        self._path = CameraPath(render.camera, trajectory) if render.camera else None
        _, walls, pool = scenery(trajectory.metadata)
        basin = (pool.low, pool.high) if pool else None
        aspect = self.size[0] / self.size[1]
        self._still = None if self._path else automatic_view(self.action, aspect, walls, basin)
        self._mesh = shaded_mesh(trajectory.metadata, trajectory.position(0), self._pixel())
        self._build(render, marks)

    def _pixel(self) -> np.ndarray:
        """Size of a pixel on each object where it comes nearest to the camera [m], shape (M,)."""
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
        points, normals = self._more.show(index)
        self._surface.move(np.concatenate([vertices, points]), np.concatenate([self._mesh.normals(vertices, position), normals]))
        if self._tank:
            self._tank.show(index, position, vertices, self._mesh.triangle)
        self._marks.show(position)
        self._stamp.SetInput(f"t = {time:.2f} s")
        self._aim(self.view(time))
        # Before the picture: only one window can be drawn into at a time.
        self._light.cast()
        if self._behind:
            self._renderer.DrawOn()
            self._front.DrawOff()
            self._window.Render()
            self._behind.take(self._window, self._renderer.GetActiveCamera(), self._tank.outer)
            self._renderer.DrawOff()
            self._front.DrawOn()
        self._window.Render()
        return fewer_pixels(pixels(self._window), self._finer)

    def close(self) -> None:
        """Release the windows."""
        self._window.Finalize()
        self._light.close()

    def __enter__(self) -> Painter:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    # --- the stage -----------------------------------------------------------------------------------------

    def _build(self, render: Render, marks: Marks) -> None:
        import vtkmodules.vtkRenderingFreeType
        import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
        from vtkmodules.vtkRenderingCore import vtkRenderer

        low, high = background_colors(render.background)
        self._renderer = vtkRenderer()
        self._renderer.SetBackground(low)
        self._renderer.SetBackground2(high)
        self._renderer.GradientBackgroundOn()
        self._renderer.SetUseHiddenLineRemoval(False)
        # Translucent surfaces are laid over the rest in the order of adding.
        self._renderer.SetUseOIT(False)
        camera = self._renderer.GetActiveCamera()
        camera.SetViewAngle(FIELD_OF_VIEW)

        metadata, dark, sky = self.trajectory.metadata, is_dark(low), render.quality is Quality.FINAL
        there = scenery(metadata)
        width, height = (n * self._finer for n in self.size)
        # In final quality the surface of a medium looks up what is behind it, so that has to be drawn before.
        through = medium(self.trajectory, render)
        self._behind = Behind((width, height)) if sky and through and through.bends else None
        self._front = self._in_front() if self._behind else self._renderer
        self._tank = through.make(dark, sky, self._behind) if through else None
        floor = None if render.floor is Floor.NONE else self._floor_height()
        (x, y, _), reach = self.action.centre, FLOOR * self.action.size
        self._more, own = Additions(self.trajectory, dark), len(self._mesh.carry)
        self._surface = MovingMesh(
            own + int(self._more.first[-1]), np.concatenate([self._mesh.triangle, own + self._more.triangle])
        )
        self._surface.paint(np.concatenate([vertex_colors(metadata)[self._mesh.of_skin], self._more.color]))
        self._actors = [lit_actor(self._surface.data, shading.FRAGMENT_SOLID, liquid=bool(self._tank), sky=sky)]
        self._actors[0].SetVisibility(not marks.springs)
        # Objects are closed, so their inner faces are never visible, and drawing these takes time.
        self._actors[0].GetProperty().BackfaceCullingOn()
        if self._tank:
            # Before the floor: pixels that are hidden are not shaded.
            self._actors.append(self._tank.plate)
        if floor is not None:
            self._actors.append(self._make_floor(floor, low, high, render))
        for actor in (*self._actors, *self._more.actors):
            self._renderer.AddActor(actor)
        if there.walls is not None:
            self._renderer.AddActor(box_edges(*there.walls, 0.8 if dark else 0.35))
        if self._tank:
            for actor in self._tank.inner:
                self._renderer.AddActor(actor)
            for actor in self._tank.actors:
                self._front.AddActor(actor)
            self._actors += self._tank.skin
            self._tank.colour_through(self._actors)
            self._tank.stand_on(0.0 if floor is None else floor, (x, y, 0.0 if floor is None else reach))
        self._marks = MarkActors(marks, metadata, dark, self.size[1] * self._finer)
        for actor in self._marks.actors:
            self._front.AddViewProp(actor)
        self._write(low)
        self._renderers = [self._renderer, self._front] if self._behind else [self._renderer]
        for actor in (actor for renderer in self._renderers for actor in renderer.GetActors()):
            look = actor.GetProperty()
            look.SetLineWidth(look.GetLineWidth() * self._finer)

        typical = float(np.median(np.linalg.norm(self.action.high[0] - self.action.low[0], axis=1)))
        with silent():
            self._window = off_screen_window(self._renderers, (width, height), SAMPLES)
            self._light = Light(self._surface.data, self.action.centre, self.action.size, typical, render)
        self._light.fall_on(self._actors)

    def _in_front(self):
        """A renderer that draws over what the other one has drawn, and behind what that holds nearer to the camera."""
        from vtkmodules.vtkRenderingCore import vtkRenderer

        front = vtkRenderer()
        front.SetLayer(1)
        front.PreserveColorBufferOn()
        front.PreserveDepthBufferOn()
        front.SetUseHiddenLineRemoval(False)
        front.SetUseOIT(False)
        front.SetActiveCamera(self._renderer.GetActiveCamera())
        return front

    def _floor_height(self) -> float | None:
        """The ground; without one the lowest point of the action, unless something falls through there."""
        there = scenery(self.trajectory.metadata)
        if there.ground is not None:
            # The ground would hide a basin that is sunk into it.
            return min(there.ground, there.liquid.low[2] if there.liquid else there.ground)
        return None if self.action.escaped else float(self.action.bounds[0][2])

    def _make_floor(self, height: float, low: np.ndarray, high: np.ndarray, render: Render):
        centre, size = self.action.centre, self.action.size
        reach = FLOOR * size
        ground = plane(centre - reach, centre + reach, height - 1e-4 * size)
        shader, sky = shading.fragment_floor(render.floor.value), render.quality is Quality.FINAL
        actor = lit_actor(ground, shader, liquid=bool(self._tank), sky=sky)
        dark = is_dark(low)
        uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
        uniforms.SetUniformf("gridSpacing", grid_spacing(size))
        uniforms.SetUniformf("linePixels", float(self._finer))
        uniforms.SetUniformf("pictureHeight", float(self.size[1] * self._finer))
        uniforms.SetUniform3f("floorCentre", [centre[0], centre[1], reach])
        uniforms.SetUniform3f("floorColor", list(np.minimum(1.0, low * 1.02) if not dark else low * 1.25 + 0.03))
        uniforms.SetUniform3f("gridColor", list(low * 0.72 if not dark else low + 0.22))
        uniforms.SetUniform3f("lowColor", list(low))
        uniforms.SetUniform3f("highColor", list(high))
        return actor

    def _write(self, background: np.ndarray) -> None:
        from vtkmodules.vtkRenderingCore import vtkTextActor

        width, height = (n * self._finer for n in self.size)
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
            self._front.AddViewProp(actor)
            return actor

        text(self.trajectory.metadata.title, (margin, margin), 0.032)
        self._stamp = text("", (width - margin, margin), 0.028, right=True)

    # --- one picture ---------------------------------------------------------------------------------------

    def _aim(self, view: View) -> None:
        camera = self._renderer.GetActiveCamera()
        camera.SetPosition(view.eye)
        camera.SetFocalPoint(view.look)
        camera.SetViewUp(view.upright)
        bounds = np.array([renderer.ComputeVisiblePropBounds() for renderer in self._renderers])
        self._renderer.ResetCameraClippingRange(np.where(np.arange(6) % 2, bounds.max(axis=0), bounds.min(axis=0)))
        for actor in self._actors:
            actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniform3f("eye", list(view.eye))


def grid_spacing(size: float) -> float:
    """Distance of the floor's lines: 1, 2 or 5 times a power of ten, about a twelfth of the action [m]."""
    exponent = np.floor(np.log10(size / 12.0))
    fraction = size / 12.0 / 10.0**exponent
    return float((1.0 if fraction < 1.5 else 2.0 if fraction < 3.5 else 5.0 if fraction < 7.5 else 10.0) * 10.0**exponent)
