# SPDX-License-Identifier: GPL-2.0-only
"""The messages on a run that a page is sent, as bytes: the scene once, and frames.

All numbers are little endian, and every array is padded to a multiple of four bytes. Both messages begin with eight bytes:

    scene  "MDS1", u32 length of the header in bytes; the header, JSON (`Feed.head`); the arrays that it lists as "buffers"
    frame  "MDF1", u32 frame; f64 time [s], u32 layers, u32 vertices V, u32 objects O, u32 columns C of liquid,
           u32 drops D of it
           f32 (O, 12): corner and size of each object's box [m], its centre of mass [m], the velocity of that [m/s]
           u16 (V, 3): vertices within the box of their object
           u16 (C), u8 (C): heights of the liquid within its basin, and `OPEN`, `HIDDEN` or `DRY` plus 4 times its foam
           f32 (D, 4): middle and radius of each drop [m]
           u8 (V): strain, 255 is `MOST_STRAIN`, where asked for; f32 (A, 3): points of what features add [m], where asked for;
           f32 (N, 3): particles [m], where asked for
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..features.liquid.kept import DROPS, HEIGHT, RAW, WAY
from ..picture.camera import Action, action_of
from ..picture.drawn import Drawn, drawn
from ..picture.floor import grid_spacing
from ..picture.foam import Foam
from ..picture.lens import FIELD_OF_VIEW, View
from ..picture.liquid import LiquidSheet, without_puddles
from ..picture.palette import LIQUID, background_colors, is_dark, object_colors, rgb, vertex_colors
from ..picture.ponds import one_sheet
from ..picture.rays import direction
from ..picture.scenery import scenery, way_of_walls
from ..picture.standpoints import camera_of, direction_of
from ..picture.surfaces import shaded_mesh
from ..picture.textures import material_places
from ..results.trajectory import Trajectory
from ..results.trajectory_metadata import ends_gone, springs_gone
from ..results.untrusted import check_places
from ..scene.render import Floor, Render
from .told import shown

STRAIN, PARTICLES, ADDED = 1, 2, 4
LAYERS = STRAIN | PARTICLES | ADDED
"""Layers of a frame beside the surfaces and the liquid: bits, and all of them."""
OPEN, HIDDEN, DRY = 0, 1, 2
"""States of a column of liquid: seen from above, below a solid, kept dry by one as by a hull."""
MOST_FOAM = 63
"""White all over."""
STEPS = 65535
"""Steps of a 16-bit number."""
MOST_STRAIN = 0.2
"""Strain that is drawn in the last colour [-]."""
GREY = {False: (38, 38, 38), True: (242, 242, 242)}
"""Colour of what features add without one, on bright and dark background."""
PAGE = 2
"""Form of what a page is sent: a report of another one is not shown beside a run."""
BY_FRAME = ("path", "walls")
"""Arrays of a scene that have a row for each frame."""
MOST_POINTS = 1000
"""Frames of the way of an object that a page is sent while the run goes on, at most."""
ASPECT = 16 / 9
"""Width over height of the picture for which the first camera is chosen: a narrower one shows as much from side to side."""


class Feed:
    """Scene and frames of one run as bytes; may be used by several threads.

    Args:
        folder: output folder of the run.
        title: of the page.
        render: the scene's ``render`` block.
        finished: whether all frames are there: the camera is then the movie's.

    Raises:
        OutputError: no trajectory there, or a damaged one.
    """

    def __init__(self, folder: Path, title: str = "", render: Render = Render(), *, finished: bool = False):
        self._trajectory = trajectory = Trajectory(folder)
        if not trajectory.frames.has_checksums:
            raise OutputError(
                f"{trajectory.path}: format {trajectory.format} cannot be viewed; run the scene again, or draw it: "
                f"mdanim-lammps render {folder}"
            )
        self.frames, self.title, self.render, self.finished = trajectory.frames, title, render, finished
        self.folder = folder
        m = self.metadata = trajectory.metadata
        self.mesh = shaded_mesh(m, self.frames.value("position", 0))
        of = self.mesh.object_of_vertex
        order = np.argsort(of, kind="stable")
        if not (order == np.arange(len(of))).all():  # doubled vertices come last: each object's are to lie together
            rank = np.argsort(order)
            self._carry, self.triangle, of = self.mesh.carry[order], rank[self.mesh.triangle], of[order]
        else:
            self._carry, self.triangle = self.mesh.carry, self.mesh.triangle
        self._of_skin, self._lift = self.mesh.of_skin[order], self.mesh.lift[order]
        self.object_of_vertex = of
        self.first = np.searchsorted(of, np.arange(len(m.names)))
        self.count = np.diff(np.append(self.first, len(of)))
        self._frame_time = trajectory.dt * trajectory.steps_per_frame
        self.scenery = scenery(m)
        pool = self.scenery.liquid
        self._foam = Foam(pool.grid, self._frame_time) if pool else None

    def close(self) -> None:
        """Close the trajectory."""
        self.frames.close()

    def vertices(self, position: np.ndarray, gone: np.ndarray | None = None) -> np.ndarray:
        """Vertices of all surfaces [m], shape (V, 3), for stored particles [m], shape (N, 3), and the ends of springs that are
        gone (`gone`)."""
        return self._carry.places(position, gone)

    @cached_property
    def start(self) -> np.ndarray:
        """Vertices of all surfaces at the start [m], shape (V, 3)."""
        return self.vertices(self.frames.value("position", 0), self.gone(0))

    def gone(self, n: int) -> np.ndarray | None:
        """Ends of the springs that are gone in a frame, as Trajectory.gone."""
        return ends_gone(self.metadata, lambda name: self.frames.value(name, n))

    # --- the scene ----------------------------------------------------------------------------------------------

    def scene(self) -> bytes:
        """Data that do not change."""
        return packed(self.head(), self.buffers())

    def head(self) -> dict:
        """Data that do not change, without arrays; lengths [m], times [s], masses [kg], colours ``[r, g, b]`` of 0 to 255."""
        m, there, action = self.metadata, self.scenery, self.action
        view = self._path[0]
        low, high = background_colors(self.render)
        size = max(action.size, np.finfo(np.float32).tiny)
        floor = None if action.escaped else float(action.bounds[0][2])
        if there.ground is not None:
            floor = min(there.ground, there.liquid.low[2]) if there.liquid else there.ground
        elif there.liquid:
            floor = min(float(action.bounds[0][2]), there.liquid.low[2])
        if self.render.floor is Floor.NONE:
            floor = None
        colors = object_colors(m.colors, m.still)
        liquid = None
        if there.liquid:
            color = (255 * rgb(there.liquid.color or LIQUID)).round().tolist()
            pool = there.liquid
            liquid = {"name": pool.name, "low": pool.low, "high": pool.high, "shape": pool.shape, "color": color}
            liquid["drops"] = pool.most_drops
        return {
            "page": PAGE,
            "title": self.title,
            "frames": self.frames.total,
            "frameTime": self._frame_time,
            "particles": len(m.id),
            "springs": len(m.bond),
            "mostStrain": MOST_STRAIN,
            "bounds": [b.tolist() for b in action.bounds],
            "size": float(size),
            "floor": floor,
            "pattern": self.render.floor.value,
            "shadows": self.render.shadows,
            "grid": grid_spacing(size),
            "lamp": direction(self.render.light).tolist(),
            "walls": there.walls,
            "background": [(255 * c).round().tolist() for c in (low, high)],
            "dark": is_dark(low),
            "fieldOfView": FIELD_OF_VIEW,
            "aspect": ASPECT,
            "view": {"eye": view.eye.tolist(), "look": view.look.tolist(), "up": view.up.tolist()},
            "objects": [
                {"name": name, "mass": mass, "color": color, "still": still, "first": first, "count": count}
                for name, mass, color, still, first, count in zip(
                    m.names, m.object_mass.tolist(), colors.tolist(), m.still.tolist(), self.first.tolist(), self.count.tolist()
                )
            ],
            "liquid": liquid,
            "added": sum(self._added_counts),
            "shown": shown(self.render, m.names),
        }

    def buffers(self) -> dict[str, np.ndarray]:
        """Arrays that do not change: ``triangle``, ``object`` of vertices, their ``tint`` where mesh files have colours, their
        ``material`` where objects have textures, ``lift``, how much nearer to the eye they are drawn where there are layers [m];
        of a liquid ``sheet`` and ``rim``; by frame the ``path`` of a camera that moves,
        eye, look and up, and the way of walls that move, ``walls``."""
        found = {"triangle": self.triangle.astype("<u4"), "object": self.object_of_vertex.astype("<u4")}
        if self.metadata.skin.painted.any():
            found["tint"] = vertex_colors(self.metadata)[self._of_skin].ravel()
        if self.scenery.liquid:
            sheet = LiquidSheet(self.scenery.liquid.grid)
            found |= {"sheet": sheet.triangle.astype("<u4"), "rim": sheet.rim.astype("<u4")}
        if (material := material_places(self._trajectory, self.start, self.object_of_vertex)) is not None:
            found["material"] = material.astype("<f4")
        if self._lift.any():
            found["lift"] = self._lift.astype("<f4")
        if self._added:
            first = np.cumsum([0, *self._added_counts])
            shifted = [(one.triangle + n, one.line + n) for one, n in zip(self._added, first)]
            found["added triangle"], found["added line"] = (np.concatenate(part).astype("<u4").ravel() for part in zip(*shifted))
            grey = GREY[is_dark(background_colors(self.render)[0])]
            colors = [grey if one.color is None else np.rint(255.0 * np.array(one.color)) for one in self._added]
            found["added color"] = np.repeat(np.array(colors), self._added_counts, axis=0).astype("u1").ravel()
        return found | {name: rows.astype("<f4") for name, rows in self._by_frame().items()}

    def _by_frame(self) -> dict[str, np.ndarray]:
        """Arrays of BY_FRAME that there are."""
        found, liquid = {}, self.scenery.liquid
        if len(path := self._path) > 1:
            found["path"] = np.array([np.concatenate([view.eye, view.look, view.upright]) for view in path])
        if (way := way_of_walls(self._trajectory.scene)) is not None and not (liquid and liquid.moves):
            found["walls"] = np.array([way(self._frame_time * n) for n in range(self.frames.total)])
        return found

    def springs(self) -> bytes:
        """The same form as `scene`: ``bond``, pairs of stored particles."""
        return packed({"springs": len(self.bond)}, {"bond": self.bond.astype("<u4")})

    @cached_property
    def bond(self) -> np.ndarray:
        """Springs as pairs of stored particles, shape (B, 2)."""
        return np.searchsorted(self.metadata.id, self.metadata.bond)

    @cached_property
    def _added(self) -> tuple[Drawn, ...]:
        """Additions of features to pictures, as joints and strings, in a run that has ended."""
        return tuple(one for one in drawn(Trajectory(self.folder)) if not one.clear) if self.finished else ()

    @cached_property
    def _added_counts(self) -> list[int]:
        """Numbers of their points."""
        return [len(one.points(0)) for one in self._added]

    def added(self, n: int) -> np.ndarray:
        """Points of what features add in a frame [m], float32, shape (A, 3)."""
        points = np.concatenate([np.zeros((0, 3)), *(one.points(n) for one in self._added)]) - self.way(n)
        check_places(self.frames.path, points, frame=n)
        return points.astype("<f4")

    @cached_property
    def action(self) -> Action:
        """Where things happen: known for a finished run, guessed from frame 0 for others."""
        if self.finished:
            with Trajectory(self.folder) as trajectory:  # the file has another name than while the run went on
                return action_of(trajectory)
        vertices = self.vertices(self.frames.value("position", 0))
        check_places(self.frames.path, vertices, frame=0)
        return first_action(self.metadata, *self._boxes(vertices))

    @cached_property
    def _path(self) -> list[View]:
        """The movie's camera at each frame, once where it never moves; as long as the run goes on one view of what will be."""
        if not self.finished:
            seen = self.render.camera if direction_of(self.render.camera) is not None else ()
            return [camera_of(seen, self._trajectory, self.action, ASPECT).at(0.0)]
        with Trajectory(self.folder) as trajectory:
            camera = camera_of(self.render.camera, trajectory, self.action, ASPECT)
            return [camera.at(self._frame_time * n) for n in range(1 if camera.still else self.frames.total)]

    def _boxes(self, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lower corner and size of each object's box [m], each of shape (O, 3)."""
        low = np.minimum.reduceat(vertices, self.first)
        return low, np.maximum.reduceat(vertices, self.first) - low

    # --- a frame ------------------------------------------------------------------------------------------------

    def frame(self, n: int, layers: int = 0) -> bytes:
        """A frame. Raises OutputError where it is not there or damaged, IndexError."""
        frames = self.frames
        x, center, speed = (frames.value(name, n) for name in ("position", "center_of_mass", "center_of_mass_velocity"))
        x, center = x - self.way(n), center - self.way(n)
        vertices = self.vertices(x, self.gone(n))
        check_places(frames.path, vertices, center, speed, frame=n)
        low, size = self._boxes(vertices)
        scale = np.divide(STEPS, size, out=np.zeros_like(size), where=size > 0.0)
        within = (vertices - np.repeat(low, self.count, axis=0)) * np.repeat(scale, self.count, axis=0)
        liquid = self.liquid(n)
        columns, drops = len(liquid[0]) if liquid else 0, self.drops(n)
        parts = [
            b"MDF1",
            struct.pack("<IdIIIII", n, frames.time(n), layers, len(vertices), len(low), columns, len(drops)),
            padded(np.hstack([low, size, center, speed]).astype("<f4")),
            padded(np.rint(within).astype("<u2")),
            *map(padded, liquid or ()),
            padded(drops.astype("<f4")),
        ]
        if layers & STRAIN:
            parts.append(padded(self._strain(x, n)))
        if layers & ADDED:
            parts.append(padded(self.added(n)))
        if layers & PARTICLES:
            parts.append(padded(x.astype("<f4")))
        return b"".join(parts)

    def liquid(self, n: int) -> tuple[np.ndarray, np.ndarray] | None:
        """Heights, u16, and states with foam, u8, of the columns of a frame, each of shape (C,); None without a liquid."""
        if self._foam is None:
            return None
        grid, (smooth, raw, _) = self.scenery.liquid.grid, self._liquid(n)
        read = lambda k: (*without_puddles(grid, *self._liquid(k)[:2]), self.drops(k))
        vertices = self.vertices(self.frames.value("position", n) - self.way(n), self.gone(n))
        smooth, cut = one_sheet(grid, *without_puddles(grid, smooth, raw), vertices, self.triangle)
        low, high = self.scenery.liquid.low[2], self.scenery.liquid.high[2]
        height = np.rint(np.clip((smooth - low) / (high - low), 0.0, 1.0) * STEPS).astype("<u2")
        state = np.where(cut, DRY, np.where(np.isfinite(raw), OPEN, HIDDEN)).astype("u1")
        foam = np.rint(MOST_FOAM * self._foam.at(n, read)).astype("u1")
        return height.ravel(), (state + 4 * foam).ravel()

    def drops(self, n: int) -> np.ndarray:
        """Middle and radius of each drop of a frame [m], shape (D, 4)."""
        if self.scenery.liquid is None or not self.scenery.liquid.most_drops:
            return np.zeros((0, 4), np.float32)
        rows = self.frames.value(DROPS.table, n)
        return rows[rows[:, 3] > 0.0]

    def way(self, n: int) -> np.ndarray:
        """Displacement of a basin that moves [m], shape (3,): the page shows all in its frame."""
        liquid = self.scenery.liquid
        return self.frames.value(WAY.table, n)[0] if liquid is not None and liquid.moves else np.zeros(3)

    def _liquid(self, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Smooth and raw heights, and drops, of a frame."""
        smooth, raw = (self.frames.value(of.table, n) for of in (HEIGHT, RAW))
        return smooth, raw, self.drops(n)

    def track(self, k: int, count: int) -> bytes:
        """The same form as `scene`: ``time`` [s], ``centre`` [m] and ``velocity`` [m/s] of an object in at most `MOST_POINTS` of
        the first ``count`` frames."""
        chosen = np.unique(np.linspace(0, count - 1, min(count, MOST_POINTS)).astype(int)).tolist()
        centre = np.array([self.frames.value("center_of_mass", n)[k] - self.way(n) for n in chosen])
        velocity = np.array([self.frames.value("center_of_mass_velocity", n)[k] for n in chosen])
        time = np.array([self.frames.time(n) for n in chosen])
        return packed({}, {"time": time.astype("<f4"), "centre": centre.astype("<f4"), "velocity": velocity.astype("<f4")})

    @cached_property
    def _springs(self) -> tuple[np.ndarray, np.ndarray]:
        """Lengths of the springs in frame 0 [m], shape (B,), and how many each particle has, at least 1, shape (N,)."""
        x, bond = self.frames.value("position", 0), self.bond
        length = np.linalg.norm(x[bond[:, 0]] - x[bond[:, 1]], axis=1)
        return np.maximum(length, np.finfo(float).tiny), np.maximum(np.bincount(bond.ravel(), minlength=len(x)), 1)

    def _strain(self, x: np.ndarray, n: int) -> np.ndarray:
        """Mean of |strain| over the springs of a particle, carried to vertices, u8, shape (V,)."""
        bond, (length, springs) = self.bond, self._springs
        strain = np.abs(np.linalg.norm(x[bond[:, 0]] - x[bond[:, 1]], axis=1) / length - 1.0)
        if (gone := springs_gone(self.metadata, lambda name: self.frames.value(name, n))) is not None:
            strain[gone] = 0.0
        mean = (np.bincount(bond[:, 0], strain, len(x)) + np.bincount(bond[:, 1], strain, len(x))) / springs
        return np.clip(np.rint(self._carry @ mean * (255.0 / MOST_STRAIN)), 0, 255).astype("u1")


def first_action(metadata, low: np.ndarray, size: np.ndarray) -> Action:
    """Where things will probably happen, from the boxes of frame 0 [m], each of shape (O, 3): from there down to the ground,
    and a little to all sides."""
    there = scenery(metadata)
    least, most = low.min(axis=0), (low + size).max(axis=0)
    room = 0.15 * float(np.linalg.norm(most - least))
    bounds = least - room * np.array([1.0, 1.0, 0.0]), most + room * np.array([1.0, 1.0, 0.3])
    if there.liquid is not None:
        bounds = np.minimum(bounds[0], there.liquid.low), np.maximum(bounds[1], there.liquid.high)
    if there.ground is not None:
        bounds[0][2] = min(bounds[0][2], max(there.ground, least[2] - 4.0 * float(np.linalg.norm(most - least))))
    corners = np.stack([bounds[0], bounds[1]])[:, None]
    sinks, one = there.ground is None and there.liquid is None, np.ones(1, dtype=bool)
    return Action(corners[:1], corners[1:], bounds, sinks, one, one[None])


def packed(head: dict, buffers: Mapping[str, np.ndarray]) -> bytes:
    """A message of a header and arrays."""
    table, parts, at = {}, [], 0
    for name, array in buffers.items():
        part = padded(array)
        table[name] = [array.dtype.str[1:], at, array.size]
        parts.append(part)
        at += len(part)
    text = json.dumps(head | {"buffers": table}, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    return b"".join([b"MDS1", struct.pack("<I", len(text)), text, *parts])


def padded(array: np.ndarray) -> bytes:
    """The bytes of an array, and zeros up to a multiple of four."""
    data = array.tobytes()
    return data + bytes(-len(data) % 4)
