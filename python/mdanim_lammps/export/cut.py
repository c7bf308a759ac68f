# SPDX-License-Identifier: GPL-2.0-only
"""The part of a run that is exported: some of its frames and objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..effects.fields import PARTS
from ..errors import OutputError, UsageError
from ..picture.drawn import Drawn, drawn, shape_of
from ..picture.palette import object_colors, vertex_colors
from ..picture.scenery import scenery
from ..picture.surfaces import ShadedMesh, shaded_mesh
from ..records import dataclass
from ..results.trajectory import Trajectory
from ..results.trajectory_metadata import TrajectoryMetadata, springs_gone
from ..results.untrusted import check_places
from ..scene.keywords import did_you_mean
from .stiff import StiffMotion, stiff_motion

GREY = (0.5, 0.5, 0.5)
"""Colour of what a feature adds without one."""


@dataclass(frozen=True)
class Body:
    """The surface of one object, or of what a feature adds, with V vertices."""

    name: str
    color: tuple[float, float, float]
    """Red, green, blue from 0 to 1, as a screen shows them."""
    triangle: np.ndarray
    """Vertex indices, counter-clockwise seen from outside, int32, shape (T, 3)."""
    paint: np.ndarray | None = None
    """Colour of each vertex as a mesh file has it, uint8, shape (V, 3)."""
    clear: bool = False
    """Whether one sees through it."""
    own: bool = True
    """Whether it is an object."""


class Cut:
    """Frames and objects of a trajectory; O objects, N stored particles of these.

    Args:
        trajectory: of the run.
        objects: names; none for all, and then with what features add.
        every, frames: as `export` takes them.

    Raises UsageError for names and ranges that are not there, OutputError where there is no frame.
    """

    def __init__(self, trajectory: Trajectory, objects: Sequence[str], every: int, frames: slice):
        if every < 1:
            raise UsageError(f"--every {every}: must be 1 or more, e.g. --every 10")
        for name in objects:
            if name not in trajectory.names:
                raise UsageError(f"--objects {name}: no object is called so; {did_you_mean(name, trajectory.names)}")
        if not len(trajectory):
            raise OutputError(f"{trajectory.path}: holds no frame, nothing can be exported; resume the run first")
        self.trajectory = trajectory
        self.frames = np.arange(len(trajectory))[frames][::every]
        """Numbers of the frames, shape (F,)."""
        if not len(self.frames):
            raise UsageError(f"--frames {frames.start}:{frames.stop}: the run has frames 0 to {len(trajectory) - 1}")
        self.objects = np.array([n for n, name in enumerate(trajectory.names) if not objects or name in objects], np.intp)
        """Indices into ``trajectory.names``, shape (O,)."""
        m = trajectory.metadata
        self._kept = np.isin(m.object_of, self.objects)
        self.liquid = None if objects else scenery(m).liquid
        self._added = () if objects else drawn(trajectory)
        self._kept_bonds = np.isin(m.bond, m.id[self._kept]).all(axis=1)
        sizes = np.diff(m.first)[self.objects]
        self.metadata: TrajectoryMetadata = replace(
            m,
            names=tuple(m.names[n] for n in self.objects),
            colors=tuple(m.colors[n] for n in self.objects),
            still=m.still[self.objects],
            object_mass=m.object_mass[self.objects],
            first=np.concatenate([[0], np.cumsum(sizes)]),
            id=m.id[self._kept],
            mass=m.mass[self._kept],
            layer=m.layer[self._kept],
            held=m.held[self._kept],
            bond=m.bond[self._kept_bonds],
            surface_of=m.surface_of[self.objects],
            kept=m.kept if self.liquid else {name: record for name, record in m.kept.items() if name != "liquid"},
        )
        """Metadata of the trajectory, for these objects alone."""

    @property
    def times(self) -> np.ndarray:
        """[s], shape (F,)."""
        return self.trajectory.times[self.frames]

    @property
    def rate(self) -> float:
        """Frames per second of simulated time."""
        times = self.times
        return (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else 30.0

    def position(self, frame: int) -> np.ndarray:
        """Positions of the particles in a frame of the trajectory [m], shape (N, 3). Raises OutputError where one is nowhere."""
        position = self.trajectory.position(frame)[self._kept]
        check_places(self.trajectory.path, position, frame=frame)
        return position

    def velocity(self, frame: int) -> np.ndarray:
        """[m/s], shape (N, 3)."""
        return self.trajectory.velocity(frame)[self._kept]

    @property
    def types(self) -> np.ndarray:
        """Atom type of each particle as ``data.NAME`` has it: its layer, and four more where it is held; shape (N,)."""
        return self.metadata.layer.astype(int) + 4 * self.metadata.held

    @cached_property
    def bonds(self) -> np.ndarray:
        """Springs as pairs of particles, counted from 0, shape (B, 2)."""
        return np.searchsorted(self.metadata.id, self.metadata.bond).reshape(-1, 2)

    @cached_property
    def spacing(self) -> float:
        """Typical distance of neighbours at the start [m]."""
        if len(self.bonds):
            return float(np.median(self._rest))
        size = np.ptp(self.position(0), axis=0)
        return float(max(size.max(), np.finfo(np.float32).tiny) / max(1.0, len(self.metadata.id) ** (1 / 3)))

    def strain(self, position: np.ndarray, frame: int) -> np.ndarray:
        """Largest \\|r/r0 - 1\\| of the springs of each particle that a frame has [-], shape (N,); r0 is the length in the first
        frame of the run, which is undeformed. Of stored springs only (``save boundary`` leaves inner ones out)."""
        stretch = np.abs(self._lengths(position) / self._rest - 1.0)
        gone = springs_gone(self.trajectory.metadata, lambda name: self.trajectory.field(name.rpartition("/")[2], frame))
        if gone is not None:
            stretch[gone[self._kept_bonds]] = 0.0
        strain = np.zeros(len(position))
        for end in self.bonds.T:
            np.maximum.at(strain, end, stretch)
        return strain

    def of_particles(self, frame: int) -> dict[str, np.ndarray]:
        """Fields of effects in a frame of the trajectory at each particle, by name, shape (N, ...): its own values, those of its
        object, and the largest of its springs."""
        m, t, found = self.metadata, self.trajectory, {}
        for field in m.fields:
            if field.per not in PARTS:
                continue
            values = t.field(field.name, frame)
            if field.per == "particle":
                values = values[self._kept]
            elif field.per == "object":
                values = values[self.objects][m.object_of]
            else:
                mine, values = values[self._kept_bonds], np.zeros((len(m.id), *field.shape))
                for end in self.bonds.T:
                    np.maximum.at(values, end, mine)
            found[field.name] = values
        return found

    def of_objects(self, frame: int) -> dict[str, np.ndarray]:
        """Numbers of effects in a frame of the trajectory for each object, by name; parts of a vector are ``NAME_x``, or
        ``NAME_1``, and so on, each of shape (O,)."""
        found = {}
        for field in self.metadata.fields:
            if field.per != "object":
                continue
            parts = self.trajectory.field(field.name, frame)[self.objects].reshape(len(self.objects), -1).T
            ends = "xyz" if field.shape == (3,) else map(str, range(1, len(parts) + 1))
            found |= {f"{field.name}_{end}" if field.shape else field.name: part for end, part in zip(ends, parts)}
        return found

    @cached_property
    def _rest(self) -> np.ndarray:
        return self._lengths(self.position(0))

    def _lengths(self, position: np.ndarray) -> np.ndarray:
        i, j = self.bonds.T
        return np.linalg.norm(position[i] - position[j], axis=1)

    # --- surfaces ---------------------------------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> list[Body]:
        """Surfaces of the objects, then of what features add, last what one sees through; vertices are doubled along creases, as
        pictures have them."""
        mesh, m = self._mesh, self.trajectory.metadata
        colors = object_colors(m.colors, m.still)[self.objects] / 255.0
        skin = m.skin
        of_kept = np.isin(skin.object_of_vertex, self.objects)
        paint = vertex_colors(m)[of_kept][mesh.of_skin][self._order]
        painted = np.zeros(len(skin.object_of_vertex), bool)
        painted[skin.painted] = True
        chosen = np.array([bool(name) for name in m.colors], bool)
        painted = (painted & ~chosen[skin.object_of_vertex])[of_kept][mesh.of_skin][self._order]
        rank = np.empty(len(self._order), np.int32)
        rank[self._order] = np.arange(len(self._order))
        triangle = rank[mesh.triangle]
        owner = np.searchsorted(self._first, triangle[:, 0], side="right") - 1
        order = np.argsort(owner, kind="stable")
        ends = np.searchsorted(owner[order], np.arange(len(self.objects) + 1))
        bodies = []
        for n, name in enumerate(self.metadata.names):
            own = slice(self._first[n], self._first[n + 1])
            bodies.append(
                Body(
                    name,
                    tuple(map(float, colors[n])),
                    triangle[order[ends[n] : ends[n + 1]]] - np.int32(self._first[n]),
                    paint[own] if painted[own].any() else None,
                )
            )
        return bodies + [Body(d.name, d.color or GREY, d.triangle, clear=d.clear, own=False) for d in self._drawn]

    def surfaces(self, frame: int) -> list[tuple[np.ndarray, np.ndarray]]:
        """Vertices [m] and outward unit normals of each of `bodies` in a frame of the trajectory, shape (V, 3) each."""
        position = self.position(frame)
        gone = self.trajectory.gone(frame)
        vertices = self._mesh.vertices(position, gone)
        normals = self._mesh.normals(vertices, position, gone)[self._order]
        vertices = vertices[self._order]
        made = [(vertices[a:b], normals[a:b]) for a, b in zip(self._first, self._first[1:])]
        return made + [shape_of(one, self.trajectory, frame) for one in self._drawn]

    @cached_property
    def motion(self) -> StiffMotion:
        """Motion of the objects, the first ones of `bodies`, that keep their shape."""
        return stiff_motion(map(self.position, self.frames), self.metadata.first)

    @property
    def stiff(self) -> np.ndarray:
        """Which of `bodies` keep their shape in all frames: objects alone, bool."""
        return np.append(self.motion.keeps, np.zeros(len(self.bodies) - len(self.objects), bool))

    @property
    def sheds_drops(self) -> bool:
        """Whether there is a liquid that drops may fly from."""
        return self.liquid is not None and self.liquid.most_drops > 0

    def drops(self, frame: int) -> np.ndarray:
        """Middle and radius of each drop in a frame of the trajectory [m], shape (D, 4)."""
        return self.trajectory.liquid_drops(frame).astype(float)

    @cached_property
    def _mesh(self) -> ShadedMesh:
        return shaded_mesh(self.metadata, self.position(0))

    @cached_property
    def _order(self) -> np.ndarray:
        """Vertices object by object: those that creases have doubled are the last ones of the mesh."""
        return np.argsort(self._mesh.object_of_vertex, kind="stable")

    @cached_property
    def _first(self) -> np.ndarray:
        """First vertex of each object in `_order`, and their number, shape (O + 1,)."""
        return np.searchsorted(self._mesh.object_of_vertex[self._order], np.arange(len(self.objects) + 1))

    @cached_property
    def _drawn(self) -> list[Drawn]:
        """Additions of features; those of lines alone have no surface."""
        return sorted((one for one in self._added if len(one.triangle)), key=lambda one: one.clear)
