# SPDX-License-Identifier: GPL-2.0-only
"""The basin as a glass tank, and the liquid in it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..results.trajectory import Trajectory
from . import shading
from .behind import Behind
from .floor import nothing
from .foam import Foam
from .hulls import FINER, dry_spots
from .light import Light
from .liquid import Blocks, Drops, LiquidSheet, droplets, kept_dry, overhang, undersides, without_puddles
from .palette import LIQUID, rgb
from .pieces import Lookup, MovingLine, MovingMesh, box_edges, lit_actor, plane
from .ponds import Ponds, parted
from .skin import LiquidSkin

CLEAR = 1.0
"""Distance that one sees in the liquid, in half diagonals of the basin: by then 1/e is left of the light from behind."""
COVER = {"smooth": 0.24, "cells": 0.35}
"""How much the skin of the liquid covers, seen straight on."""

RIM = 0.7
"""How much the bright line covers where the liquid meets the glass."""
INSET = 0.01
"""How far from the edge of the tank's floor what is behind that is not drawn, in sides of the basin."""
HAIR = 1e-3
"""By how much, in sizes of the basin, the edges are drawn outside and the liquid inside: what stands flush
with the glass is then seen in front of the liquid, and nothing flickers."""


class Tank:
    """Actors of the tank of one trajectory.

    Args:
        trajectory: one with a liquid.
        look: ``smooth`` for the surface that objects feel, ``cells`` for the raw columns.
        dark: whether the background is.
        sky: whether its floor is darker where objects hide the sky.
        behind: what is drawn before the liquid's surface, which then shifts it where the surface slopes; None without.
    """

    def __init__(self, trajectory: Trajectory, look: str, dark: bool, sky: bool, behind: Behind | None = None):
        pool = trajectory.liquid
        self._trajectory, self._look = trajectory, look
        self._low, self._high = np.array(pool.low), np.array(pool.high)
        self._color = rgb(pool.color or LIQUID)
        self._form = LiquidSheet(pool.grid) if look == "smooth" else Blocks(pool.grid)
        self._heights = Lookup(*pool.shape[:2], smooth=look == "smooth")
        vertices = self._form.mesh(np.full(pool.shape[1::-1], pool.low[2]))[0]
        self._mesh = MovingMesh(len(vertices), self._form.triangle)
        self._floor = plane(self._low, self._high, pool.low[2])
        self._corners = np.array([self._floor.GetPoint(n) for n in range(self._floor.GetNumberOfPoints())])
        self.plate = lit_actor(self._floor, shading.FRAGMENT_SOLID, liquid=True, sky=sky)
        """The tank's floor, opaque."""
        # Its edge, which covers pixels in part, hides nothing.
        inset = INSET * (self._high - self._low)
        self.cover = None if pool.moves else nothing(plane(self._low + inset, self._high - inset, pool.low[2]))
        """Hides what is behind that floor in a window without it; None where it moves."""
        self.plate.GetProperty().SetColor((0.28, 0.33, 0.37) if dark else (0.74, 0.78, 0.81))
        self._foam = Foam(pool.grid, trajectory.dt * trajectory.steps_per_frame) if look == "smooth" else None
        self._white = Lookup(*pool.shape[:2], smooth=True)
        self._dry, self._beside_ponds = (Lookup(FINER * pool.shape[0], FINER * pool.shape[1], smooth=True) for _ in range(2))
        self._pond = MovingMesh(1, np.zeros((0, 3)))
        sheets = [(self._mesh, self._dry), (self._pond, self._beside_ponds)][: 2 if look == "smooth" else 1]
        self._skins = [LiquidSkin(mesh, self._white, cut, pool.grid.cell, COVER[look], behind) for mesh, cut in sheets]
        self.inner = [actor for skin in self._skins for actor in skin.inner]
        self.outer = [actor for skin in self._skins for actor in skin.outer]
        """The liquid's own faces, seen from inside and from outside; translucent, the inner ones are drawn first."""
        self.skin = [*self.inner, *self.outer]
        """The liquid's own faces, and its drops."""
        glass = HAIR * np.linalg.norm(self._high - self._low) * np.array([1.0, 1.0, 0.0])
        self._edges = box_edges(self._low - glass, self._high + glass, 0.85 if dark else 0.25, 0.55, 2.0)
        self.actors = [*self.outer, self._edges]
        """Translucent actors, in the order in which they are drawn, except the inner faces."""
        if look == "smooth":
            self._rim = MovingLine(len(self._form.rim), (1.0, 1.0, 1.0), 2.0)
            self.actors.append(self._rim.actor)
        self._fine = sky
        # A line is two pixels wide, and each of them as far away as its middle: it would lie half before a solid at the glass.
        self._rim_inside = 2.0 * HAIR * float(np.linalg.norm(self._high - self._low))
        self._spray = None
        if pool.most_drops:
            self._spray = MovingMesh(1, np.zeros((0, 3)))
            drops = lit_actor(self._spray.data, shading.FRAGMENT_DROP, liquid=True, sky=False)
            drops.ForceTranslucentOn()
            drops.GetProperty().BackfaceCullingOn()
            self.skin.append(drops)
            self.actors.append(drops)
        self._through: Sequence = ()

    def colour_through(self, actors: Sequence) -> None:
        """Let everything that is lit take the liquid's colour where it is seen through liquid."""
        self._through = actors
        clear = CLEAR * 0.5 * float(np.linalg.norm(self._high - self._low))
        for actor in actors:
            actor.GetProperty().SetTexture("liquidHeights", self._heights.texture)
            uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniform3f("basinLow", self._low.tolist())
            uniforms.SetUniform3f("basinHigh", self._high.tolist())
            uniforms.SetUniform3f("liquidColor", self._color.tolist())
            uniforms.SetUniformf("liquidClear", clear)

    def stand_on(self, height: float, floor: tuple[float, float, float]) -> None:
        """Say where the picture's floor is: its height, middle x and y, and half side [m]; 0 for none."""
        for actor in self.skin:
            uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniformf("floorHeight", height)
            uniforms.SetUniform3f("floorCentre", list(map(float, floor)))

    def show(self, frame: int, position: np.ndarray, vertices: np.ndarray, triangle: np.ndarray) -> None:
        """Move the liquid to a frame.

        Args:
            frame: its number.
            position: of particles [m], shape (N, 3).
            vertices: of the surfaces of all bodies [m], shape (V, 3).
            triangle: their corners, counter-clockwise seen from outside, shape (T, 3).
        """
        smooth, raw, drops = self._liquid(frame)
        way = self._move(frame)
        position, vertices = position - way, vertices - way  # in the frame of the basin, until all is drawn
        grid, ponds = self._trajectory.liquid.grid, None
        if self._look == "smooth":
            smooth, raw, ponds = parted(grid, smooth, raw, vertices, triangle)
        points, normals = self._form.mesh(smooth if self._look == "smooth" else raw)
        if self._look == "smooth":
            self._form.move_aside(points, overhang(grid, smooth, position))
        points[:, :2] += HAIR * ((self._low + self._high)[:2] / 2 - points[:, :2])
        self._mesh.move(points + way, normals)
        if self._spray:
            rows = droplets(drops, max(grid.cell))
            balls = Drops(max(1, len(rows)), self._fine)
            round_ = balls.mesh(rows)
            self._spray.reshape(len(round_[0]), balls.triangle)
            self._spray.move(round_[0] + way, round_[1])
        if self._look == "smooth":
            rim = points[self._form.rim]
            rim[:, :2] += np.sign((self._low + self._high)[:2] / 2 - rim[:, :2]) * self._rim_inside
            self._rim.move(rim + way, self._rim_opacity(smooth, raw))
            # There are no blocks where it is dry.
            self._dry.fill(dry_spots(grid, smooth, raw, vertices, triangle))
        # Things seen through a column without a value are seen through liquid all the same.
        top = smooth if self._look == "smooth" else np.where(np.isfinite(raw), raw, smooth)
        dry = kept_dry(raw)
        if dry.any():
            # Under a hull there is liquid.
            top = np.where(dry, undersides(grid, position), top)
        if self._foam:
            self._white.fill(self._foam.at(frame, self._liquid))
        self._skins[0].take(self._form.triangle, self._foamy(), not self._dry.numbers.any())
        self._show_ponds(ponds, way)
        level, bottom = (ponds.level, ponds.bottom) if ponds else (top, np.full(top.shape, np.inf))
        self._heights.fill(np.stack([top, level, np.minimum(bottom, self._high[2])], axis=-1))
        for actor in self._through:
            uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniformf("liquidTop", float(max(top.max(), level[bottom < level].max(initial=-np.inf))))
            uniforms.SetUniformf("liquidLow", float(top.min()))

    def _move(self, frame: int) -> np.ndarray:
        """Move the tank to a frame. Returns the displacement of a basin that moves [m], shape (3,)."""
        way = self._trajectory.liquid_way(frame)
        if self._trajectory.liquid.moves:
            self._edges.SetPosition(*way)
            for n, corner in enumerate(self._corners + way):
                self._floor.GetPoints().SetPoint(n, corner)
            self._floor.GetPoints().Modified()
            for actor in self._through:
                uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
                uniforms.SetUniform3f("basinLow", (self._low + way).tolist())
                uniforms.SetUniform3f("basinHigh", (self._high + way).tolist())
        return way

    def _show_ponds(self, ponds: Ponds | None, way: np.ndarray) -> None:
        """Have a sheet for ponds, one without triangles if there are none."""
        if ponds:
            points, normals, triangle = self._form.pond(ponds.level, ponds.quads)
            self._pond.reshape(len(points), triangle)
            self._pond.move(points + way, normals)
            self._beside_ponds.fill(ponds.hidden)
            self._skins[1].take(triangle, self._foamy(), not np.any(ponds.hidden))
        elif self._pond.data.GetNumberOfPolys():
            self._pond.reshape(1, np.zeros((0, 3)))
            self._skins[1].take(np.zeros((0, 3), np.int32), np.zeros(1, bool), True)

    def _foamy(self) -> np.ndarray:
        """Around which vertices of the sheet there may be foam, bool, shape (V,)."""
        from scipy.ndimage import maximum_filter

        if not self._foam:
            return np.zeros(self._mesh.data.GetNumberOfPoints(), bool)
        return self._form.at_vertices(maximum_filter(self._white.numbers, 3)) > 0.0

    def part_skin(self, light: Light, eye: np.ndarray, floor: bool) -> None:
        """Draw each part of the surface by what it needs: as light falls in this frame, as an eye [m] sees it, and by whether a
        floor is behind all."""
        for skin in self._skins:
            skin.part(light, eye, floor)

    def _liquid(self, frame: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Smooth and raw heights, and drops, of a frame."""
        t = self._trajectory
        smooth, raw = t.liquid_height(frame), t.liquid_raw(frame)
        if self._look == "smooth":
            smooth, raw = without_puddles(t.liquid.grid, smooth, raw)
        return smooth, raw, t.liquid_drops(frame)

    def _rim_opacity(self, smooth: np.ndarray, raw: np.ndarray) -> np.ndarray:
        """How much the line on the glass covers, shape (R,).

        Nothing where a solid hides the liquid: it would look out beside the solid. Nothing on a dry floor.
        """
        film = (smooth - self._low[2]) / self._trajectory.liquid.grid.cell[2]
        shown = RIM * np.clip((film - 0.1) / 0.4, 0.0, 1.0) * np.isfinite(raw)
        return np.pad(shown, 1, mode="edge").ravel()[self._form.rim]
