# SPDX-License-Identifier: GPL-2.0-only
"""One frame of a trajectory as a picture, drawn off screen with VTK."""

from __future__ import annotations

import numpy as np

from ..errors import UsageError
from ..results.trajectory import Trajectory
from ..scene.render import Floor, Quality, Render
from . import shading
from .backdrop import Backdrop
from .behind import Behind
from .camera import Action, action_of
from .drawn import Additions, medium
from .floor import REACH, FloorPlane
from .framing import PicturePart, aim, part_around, whole
from .ghosts import Ghosts
from .label import Label
from .lens import FIELD_OF_VIEW, View
from .light import Light
from .marks import MarkActors, Marks
from .overlay import Overlay, room_for
from .palette import background_colors, is_dark, object_colors, vertex_colors
from .pieces import MovingMesh, box_edges, have_own_textures, lit_actor
from .scenery import scenery, way_of_walls
from .standpoints import camera_of
from .surfaces import shaded_mesh
from .textures import FLOORS, MATERIAL, OBJECTS, material_places
from .tones import Tones
from .window import fewer_pixels, lay_over, off_screen_window, rgba, silent, upright

FINER = {Quality.DRAFT: 1, Quality.FINAL: 2}
"""Pixels that are drawn along each side of one that is shown."""
SAMPLES = 4
"""Samples along an edge of each drawn pixel."""
MOST_PIXELS = 16384
"""Pixels that Mesa draws along a side."""


def _renderer():
    """A renderer of VTK that lays translucent surfaces over the rest in the order of adding."""
    from vtkmodules.vtkRenderingCore import vtkRenderer

    renderer = vtkRenderer()
    renderer.SetUseHiddenLineRemoval(False)
    renderer.SetUseOIT(False)
    return renderer


class Painter:
    """Draws frames of one trajectory, all with the same lamp, floor and, unless the scene moves it, camera.

    Args:
        trajectory: what is drawn.
        render: the scene's ``render`` block; ``Render()`` chooses everything.
        size: width and height in pixels; None takes that of ``render``.
        action: bounds over all frames, if known already; None finds them.
        marks: what is shown beside the surfaces.
        seen: what an automatic camera sees, where that is not the action of this run alone.
        beside: a run that is shown beside this one, on the same axes and with arrows of the same scale.
        colors: of objects, uint8, shape (O, 3); None are those of the scene.
        name: words in place of the title.

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
        seen: Action | None = None,
        beside: Trajectory | None = None,
        colors: np.ndarray | None = None,
        name: str = "",
    ):
        self.trajectory, self._name = trajectory, name or trajectory.metadata.title
        self.size = tuple(size or render.size)
        metadata = trajectory.metadata
        self._colors = object_colors(metadata.colors, metadata.still) if colors is None else colors
        self._finer = FINER[render.quality]
        if self._finer > 1 and max(self.size) * self._finer > MOST_PIXELS:
            raise UsageError(
                f"a picture of {self.size[0]} x {self.size[1]} pixels is too large for quality final, which draws "
                f"{self._finer} times as many along each side; take at most {MOST_PIXELS // self._finer}, or quality draft"
            )
        self.action = action or action_of(trajectory)
        aspect, room = self.size[0] / self.size[1], room_for(render, self.size)
        # Two runs beside each other have one camera.
        self._camera = camera_of(render.camera, trajectory, seen or self.action, aspect, room, fixed=seen is not None)
        self._mesh = shaded_mesh(trajectory.metadata, trajectory.position(0), self._pixel())
        self._tones = Tones((trajectory, beside), render.color_by) if render.color_by else None
        self._build(render, marks)
        self._overlay = None
        if render.tells:
            dark = is_dark(background_colors(render)[0])
            runs = trajectory, beside
            both = seen or self.action
            self._overlay = Overlay(
                runs, render, self._pixels, dark, both, self.action, self._tones, self._finer, self.view, self._colors
            )

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
        return self._camera.at(time)

    def frame(self, index: int) -> np.ndarray:
        """Picture of a frame, uint8 RGB, shape (height, width, 3), first row on top."""
        return upright(self.pixels(index))

    def pixels(self, index: int) -> np.ndarray:
        """The same as it was drawn, with a fourth number that says nothing, shape (height, width, 4), first row below."""
        position, gone = self.trajectory.position(index), self.trajectory.gone(index)
        vertices = self._mesh.vertices(position, gone)
        time = float(self.trajectory.times[index])
        points, normals = self._more.show(index)
        if self._ghosts:
            points, normals = (np.concatenate(pair) for pair in zip((points, normals), self._ghosts.show(index)))
        shown = self._mesh.normals(vertices, position, gone)
        if self._tones:
            self._surface.paint(np.concatenate([self._toned(index), self._surface_colors[len(vertices) :]]))
        view = self.view(time)
        shown_points = np.concatenate([self._mesh.seen_from(view.eye, vertices), points])
        self._surface.move(shown_points, shown_normals := np.concatenate([shown, normals]))
        casting = shown_points[: len(self._casters.points)]
        if self._ghosts:
            self._casters.move(casting, shown_normals[: len(casting)])
        if self._tank:
            self._tank.show(index, position, vertices, self._mesh.triangle)
        if self._walls and self._way_of_walls:
            self._walls.SetPosition(*self._way_of_walls(time))
        self._marks.show(position)
        # Before the picture: only one window can be drawn into at a time.
        self._light.cast(casting)
        if self._tank:
            self._tank.part_skin(self._light, view.eye, bool(self._floor and self._floor.covers(view, self._pixels)))
        for actor in self._actors:
            actor.GetShaderProperty().GetFragmentCustomUniforms().SetUniform3f("eye", list(view.eye))
        picture = self._all_in_one(view) if self._behind else self._over_backdrop(view, shown_points)
        if self._overlay:
            self._overlay.lay_on(picture, view, index, position, gone)
        self._title.lay_on(picture, self._name)
        self._stamp.lay_on(picture, f"t = {time:.2f} s")
        return fewer_pixels(picture, self._finer)

    def _toned(self, index: int) -> np.ndarray:
        """Colours of the vertices by a quantity, uint8, shape (V, 3); what never moves keeps its own."""
        values = self._mesh.carry @ self._tones.of_particles(index)
        still = self.trajectory.metadata.still[self._mesh.object_of_vertex]
        return np.where(still[:, None], self._surface_colors[: len(values)], self._tones.colors(values))

    def _over_backdrop(self, view: View, points: np.ndarray) -> np.ndarray:
        """Floor and background by themselves, and before them, where there is something, all else; ``points`` [m], shape (P, 3),
        are those of surfaces."""
        boxes = self._boxes()
        corners = boxes.reshape(-1, 3)
        picture = self._backdrop.picture(view, self._light.shade, corners if self._tank else corners[:0])
        seen = np.concatenate([points, corners])
        if self._floor:
            self._floor.hide(view, points, self._triangle, boxes)
        # In final quality a shader tells pixels apart by their place in the window.
        everywhere = self._marks.words or self._finer > 1
        part = whole(self._pixels) if everywhere else part_around(view, self._pixels, seen)
        if all(part.size):
            self._window.SetSize(*part.size)
            self._aim(view, part)
            self._window.Render()
            lay_over(part.of(picture), rgba(self._window))
        return picture

    def _all_in_one(self, view: View) -> np.ndarray:
        """All in one window, where shaders look up what is behind."""
        self._aim(view, whole(self._pixels))
        self._renderer.DrawOn()
        self._front.DrawOff()
        self._window.Render()
        self._behind.take(self._window, self._renderer.GetActiveCamera(), self._tank.outer)
        self._renderer.DrawOff()
        self._front.DrawOn()
        self._window.Render()
        return rgba(self._window)

    def _boxes(self) -> np.ndarray:
        """Corners of the boxes around each actor besides surfaces and floor [m], shape (B, 8, 3)."""
        boxes = [
            actor.GetBounds()
            for renderer in self._renderers
            for actor in renderer.GetActors()
            if actor.GetVisibility() and actor is not self._actors[0] and not (self._floor and actor is self._floor.cover)
        ]
        found = [np.stack(np.meshgrid(*np.reshape(box, (3, 2))), axis=-1).reshape(-1, 3) for box in boxes if box[0] <= box[1]]
        return np.array(found).reshape(-1, 8, 3)

    def close(self) -> None:
        """Release the windows."""
        self._window.Finalize()
        if self._backdrop:
            self._backdrop.close()
        self._light.close()

    def __enter__(self) -> Painter:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    # --- the stage -----------------------------------------------------------------------------------------

    def _build(self, render: Render, marks: Marks) -> None:
        """All that is drawn. The order in which actors are added is that in which they are drawn."""
        import vtkmodules.vtkRenderingFreeType
        import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

        colors = background_colors(render)
        dark, sky = is_dark(colors[0]), render.quality is Quality.FINAL
        self._pixels = tuple(n * self._finer for n in self.size)
        self._renderer = _renderer()
        # In final quality the surface of a medium looks up what is behind it, so that has to be drawn before.
        through = medium(self.trajectory, render)
        self._behind = Behind(self._pixels) if sky and through and through.bends else None
        self._front = self._in_front() if self._behind else self._renderer
        self._renderers = [self._renderer, self._front] if self._behind else [self._renderer]
        self._tank = through.make(dark, sky, self._behind) if through else None
        height, liquid = None if render.floor is Floor.NONE else self._floor_height(), bool(self._tank)
        self._floor = (
            None if height is None else FloorPlane(height, self.action, render, colors, self._pixels[1], self._finer, liquid)
        )
        self._add_surfaces(render, dark, sky, marks)
        self._add_walls(dark)
        if self._tank:
            self._add_tank(height)
        self._marks = MarkActors(marks, self.trajectory.metadata, dark, self._pixels[1])
        for actor in self._marks.actors:
            self._front.AddViewProp(actor)
        self._write(colors[0], self._floor is not None and render.floor.value in FLOORS)
        self._set_background(colors)
        for actor in (actor for renderer in self._renderers for actor in renderer.GetActors()):
            look = actor.GetProperty()
            look.SetLineWidth(look.GetLineWidth() * self._finer)
        self._open_windows(render, colors, sky)

    def _add_surfaces(self, render: Render, dark: bool, sky: bool, marks: Marks) -> None:
        """Surfaces of objects, of what features add and of frozen moments, in one mesh; the floor's own actors around them."""
        self._more, own = Additions(self.trajectory, dark), len(self._mesh.carry)
        self._triangle = np.concatenate([self._mesh.triangle, own + self._more.triangle])
        colors = [vertex_colors(self.trajectory.metadata, self._colors)[self._mesh.of_skin], self._more.color]
        self._ghosts = Ghosts(self.trajectory, self._mesh, colors[0], render.freeze) if render.freeze else None
        if self._ghosts:  # what is not there casts no shadow
            self._casters = MovingMesh(sum(map(len, colors)), self._triangle)
            self._triangle = np.concatenate([self._triangle, own + int(self._more.first[-1]) + self._ghosts.triangle])
            colors.append(self._ghosts.color)
        self._surface_colors = np.concatenate(colors)
        self._surface = MovingMesh(len(self._surface_colors), self._triangle)
        self._surface.paint(self._surface_colors)
        if not self._ghosts:
            self._casters = self._surface
        surface = self._surface_actor(bool(self._tank), sky)
        surface.SetVisibility(not marks.springs)
        # Objects are closed, so their inner faces are never visible, and drawing these takes time.
        surface.GetProperty().BackfaceCullingOn()
        # The tank's plate comes before the floor: pixels that are hidden are not shaded.
        self._actors = [surface, *([self._tank.plate] if self._tank else [])]
        # The cover is first, as it hides only what is drawn later.
        for actor in (*([self._floor.cover] if self._floor else []), *self._actors, *self._more.actors):
            self._renderer.AddActor(actor)
        if self._floor:
            self._actors.append(self._floor.actor)

    def _add_walls(self, dark: bool) -> None:
        there, self._walls, self._way_of_walls = scenery(self.trajectory.metadata), None, way_of_walls(self.trajectory.scene)
        if there.walls is not None:
            self._walls = box_edges(*there.walls, 0.8 if dark else 0.35)
            self._renderer.AddActor(self._walls)

    def _add_tank(self, floor: float | None) -> None:
        """The liquid and its basin, which stand on a floor of this height [m]."""
        for actor in self._tank.inner:
            self._renderer.AddActor(actor)
        for actor in self._tank.actors:
            self._front.AddActor(actor)
        self._actors += self._tank.skin
        self._tank.colour_through(self._actors)
        (x, y, _), reach = self.action.centre, REACH * self.action.size
        self._tank.stand_on(floor or 0.0, (x, y, 0.0 if floor is None else reach))

    def _set_background(self, colors: tuple) -> None:
        """These colours, below and above, where all is in one window; else nothing, as what is drawn is laid over a backdrop."""
        if not self._behind:
            self._renderer.SetBackground(0.0, 0.0, 0.0)
            self._renderer.SetBackgroundAlpha(0.0)
            return
        self._renderer.SetBackground(colors[0])
        self._renderer.SetBackground2(colors[1])
        self._renderer.GradientBackgroundOn()
        if self._floor:
            self._renderer.AddActor(self._floor.actor)
            self._floor.cover.VisibilityOff()

    def _open_windows(self, render: Render, colors: tuple, sky: bool) -> None:
        """Windows of the picture, of the lamp and of the backdrop."""
        sizes = np.linalg.norm(self.action.high[0] - self.action.low[0], axis=1)
        # The median; NumPy's would load masked arrays.
        middle = np.sort(sizes)[(len(sizes) - 1) // 2 : len(sizes) // 2 + 1]
        typical = float(middle.mean()) if len(sizes) else self.action.size
        with silent():
            self._window = off_screen_window(self._renderers, self._pixels, SAMPLES, clear=not self._behind)
            self._light = Light(self._casters.data, self.action.centre, self.action.size, typical, render, self._floor)
            cover = self._tank.cover if self._tank else None
            self._backdrop = None
            if not self._behind:
                self._backdrop = Backdrop(self._pixels, colors, self._floor, self._camera.still, sky, cover)
        self._light.fall_on(self._actors)
        if self._backdrop and self._floor:
            have_own_textures(self._floor.actor, ("skyDepth", "liquidHeights"))

    def _surface_actor(self, liquid: bool, sky: bool):
        """An actor for all surfaces, with the textures of objects where some have one."""
        start = self._mesh.vertices(self.trajectory.position(0), self.trajectory.gone(0))
        places = material_places(self.trajectory, start, self._mesh.object_of_vertex)
        if places is None or self._tones:
            return lit_actor(self._surface.data, shading.FRAGMENT_SOLID, liquid=liquid, sky=sky)
        rest = np.zeros((len(self._surface_colors) - len(places), 4), np.float32)
        self._surface.mark(MATERIAL, np.concatenate([places, rest]))
        own = {"functions": OBJECTS, "mark": MATERIAL}
        return lit_actor(self._surface.data, shading.FRAGMENT_TEXTURED, liquid=liquid, sky=sky, **own)

    def _in_front(self):
        """A renderer that draws over what the other one has drawn, and behind what that holds nearer to the camera."""
        front = _renderer()
        front.SetLayer(1)
        front.PreserveColorBufferOn()
        front.PreserveDepthBufferOn()
        front.SetActiveCamera(self._renderer.GetActiveCamera())
        return front

    def _floor_height(self) -> float | None:
        """The ground; without one the lowest point of the action, unless something falls through there."""
        there = scenery(self.trajectory.metadata)
        if there.ground is not None:
            # The ground would hide a basin that is sunk into it.
            return min(there.ground, there.liquid.low[2] if there.liquid else there.ground)
        return None if self.action.escaped else float(self.action.bounds[0][2])

    def _write(self, background: np.ndarray, halo: bool) -> None:
        width, height = self._pixels
        color = (0.93, 0.94, 0.95) if is_dark(background) else (0.20, 0.23, 0.27)
        margin = round(0.035 * height)
        self._title = Label((margin, margin), round(0.032 * height), color, halo=halo)
        self._stamp = Label((width - margin, margin), round(0.032 * height), color, right=True, halo=halo)

    # --- one picture ---------------------------------------------------------------------------------------

    def _aim(self, view: View, part: PicturePart) -> None:
        aim(self._renderer.GetActiveCamera(), view, self._pixels, part)
        bounds = np.array([renderer.ComputeVisiblePropBounds() for renderer in self._renderers])
        self._renderer.ResetCameraClippingRange(np.where(np.arange(6) % 2, bounds.max(axis=0), bounds.min(axis=0)))
