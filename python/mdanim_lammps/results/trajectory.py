# SPDX-License-Identifier: GPL-2.0-only
"""Reads the trajectory file of a run that is finished, running or crashed (docs/trajectory.md)."""

from __future__ import annotations

import operator
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import OutputError, SceneError, SetupError
from ..features import facets
from ..scene.keywords import Named, did_you_mean
from ..scene.scene import Save, SceneRecord
from .frame_reader import EVERYTHING, FrameReader
from .html import html_table
from .trajectory_file import NOT_WRITTEN, find_trajectory, frame_shapes, open_trajectory, read_metadata, row_checksum
from .trajectory_metadata import ends_gone
from .untrusted import check_frames, check_hdf5, check_metadata, check_steps

if TYPE_CHECKING:
    import MDAnalysis
    import pandas
    import pyvista

MOST_TEXT, MOST_TEXT_OF_OBJECT = 1 << 18, 1 << 12
"""Signs of a stored scene at most, and for each object; a lock has 340 of an object with all its settings."""
_LASTING = ("path", "metadata", "format", "dt", "steps_per_frame", "frames", "scene")
"""Attributes of a trajectory that do not grow with its frames."""
_QUOTED = re.compile(r'"[^"\n]*"|#[^\n]*')
_UNFOLDS = re.compile(r"\b(repeat|include)\b")
"""Statements that a scene which is written out does not have."""
DAMAGE = (LookupError, OSError, RuntimeError, ValueError, TypeError, AttributeError, MemoryError, ArithmeticError)
"""Errors of HDF5 and of what reads its tables, where a file is damaged."""
TRACKS = tuple(facet.Track for facet in facets("kept") if hasattr(facet, "Track"))
"""Classes of features with what they add to a `Trajectory`."""


class Trajectory(*TRACKS):  # type: ignore[misc]  # features are found when the program starts
    """A finished, running or crashed run, read frame by frame; F frames, O objects, N stored particles.

    Every value is checked against the checksum that was stored with it: reading raises OutputError where the file is damaged.

    Args:
        path: output folder, trajectory file, or the ``.part`` of a run that has not ended.

    Raises:
        OutputError: no trajectory there, one of another program, or a damaged one.
    """

    def __init__(self, path: str | Path):
        self.path = find_trajectory(Path(path))
        file = open_trajectory(self.path)
        with self._damage():
            check_hdf5(self.path, file)
            self.metadata = read_metadata(file)
            check_metadata(self.path, self.metadata)
            parameters = file["parameters/mdanim"].attrs
            self.format, self.dt = int(parameters["format"]), float(parameters["dt"])
            self.steps_per_frame = int(parameters["steps_per_frame"])
            check_steps(self.path, self.dt, self.steps_per_frame)
            self.frames = FrameReader(self.path, file)
            """Also of frames that were not on the disk when this was opened."""
            self._take_rows()
            if self.frames.has_checksums:
                file.close()

    def renewed(self, most: int) -> Trajectory:
        """The same run with the frames that it has by now, the first ``most`` of them; the file is not opened again.

        Raises OutputError where a frame that has come is damaged.
        """
        later = object.__new__(Trajectory)
        later.__dict__ |= {name: value for name, value in self.__dict__.items() if name in _LASTING}
        with later._damage():
            later._take_rows(most)
        return later

    def _take_rows(self, most: int | None = None) -> None:
        steps, times, sums = self.frames.rows()
        count = self._count(steps[:most], times[:most], sums)
        check_frames(self.path, frame_shapes(self.metadata), self.frames.tables, steps[:count], times[:count])
        self.steps: np.ndarray = steps[:count]
        """Time step of each frame, shape (F,)."""
        self.times: np.ndarray = times[:count]
        """Simulated time of each frame [s], shape (F,)."""

    def _count(self, steps: np.ndarray, times: np.ndarray, sums: np.ndarray | None) -> int:
        """Number of frames that are whole. Raises OutputError where steps or times are damaged."""
        if sums is None:
            return len(steps)
        written = steps != NOT_WRITTEN
        count = int(written.sum())
        if not written[:count].all():
            raise self.frames.damaged(int(written.argmin()), "step")
        for frame, (step, time, row) in enumerate(zip(steps[:count], times, sums)):
            if row_checksum(step, time) != row[0]:
                raise self.frames.damaged(frame, "step or time")
        return count

    @cached_property
    def scene(self) -> SceneRecord | None:
        """The scene of the run; None where its text cannot be read here.

        It may be of an older language, its meshes may be elsewhere, or it is not written out in full, as every run stores it: so
        reading it takes no longer than the objects of the run ask for.
        """
        return self.scene_with("")

    def scene_with(self, lines: str) -> SceneRecord | None:
        """The scene with further lines that are written out as it is; None where the text cannot be read here."""
        from ..scene.parse import parse_scene

        m = self.metadata
        text = f"{m.scene_text}\n{lines}" if lines else m.scene_text
        if len(text) > MOST_TEXT + MOST_TEXT_OF_OBJECT * len(m.names) or _UNFOLDS.search(_QUOTED.sub(" ", text)):
            return None
        try:
            scene = parse_scene(text, folder=self.path.parent)
        except SceneError:
            return None
        return scene if tuple(solid.name for solid in scene.solids) == m.names else None

    @property
    def names(self) -> tuple[str, ...]:
        """Object names, in the order of the scene."""
        return self.metadata.names

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.times)

    def __getitem__(self, frame):
        """A frame by its number, negative ones count from the end; of a slice a list of them. Nothing is read yet.

        Raises IndexError.
        """
        if isinstance(frame, slice):
            return [Snapshot(self, n) for n in range(len(self))[frame]]
        return Snapshot(self, self._frame(operator.index(frame)))

    def __iter__(self) -> Iterator[Snapshot]:
        """Frame after frame."""
        return (Snapshot(self, n) for n in range(len(self)))

    def to_pandas(self) -> pandas.DataFrame:
        """A row for each object and frame: ``frame``, ``time`` [s], ``object``, centre of mass ``x y z`` [m], its velocity
        ``vx vy vz`` [m/s] and, where all particles are stored, spin ``wx wy wz`` [rad/s] and ``kinetic`` energy [J]; without a
        liquid also ``contact_fx contact_fy contact_fz`` [N], the mean since the frame before, NaN for objects with hold or drag.

        Raises SetupError where pandas is not installed, OutputError.
        """
        from .motion import MotionTable

        table, count = MotionTable(self, np.arange(len(self.names))), len(self.names)
        values = np.concatenate([np.zeros((0, len(table.columns) - 3)), *map(table.numbers, range(len(self)))])
        frame = import_pandas().DataFrame(values, columns=table.columns[3:])
        frame.insert(0, "frame", np.repeat(np.arange(len(self)), count))
        frame.insert(1, "time", np.repeat(self.times, count))
        frame.insert(2, "object", list(self.names) * len(self))
        return frame

    @cached_property
    def objects(self) -> Mapping[str, ObjectTrack]:
        """The objects by name; a KeyError for another name suggests one."""
        return Named("object", ((name, ObjectTrack(self, index)) for index, name in enumerate(self.names)))

    def position(self, frame: int) -> np.ndarray:
        """Positions of all stored particles [m], shape (N, 3)."""
        return self._read("position", frame)

    def velocity(self, frame: int) -> np.ndarray:
        """Velocities of all stored particles [m/s], shape (N, 3)."""
        return self._read("velocity", frame)

    @cached_property
    def centers(self) -> np.ndarray:
        """Centres of mass of all objects [m], shape (F, O, 3)."""
        with self._damage():
            return self.frames.values("center_of_mass", len(self))

    @cached_property
    def center_velocities(self) -> np.ndarray:
        """Velocities of the centres of mass [m/s], shape (F, O, 3)."""
        with self._damage():
            return self.frames.values("center_of_mass_velocity", len(self))

    def field(self, name: str, frame: int) -> np.ndarray:
        """Values of an effect in a frame, by the name of one of ``metadata.fields``, in its shape and unit.

        They are of all objects, of stored particles (as `position`) or of stored springs (as ``metadata.bond``); those of pairs
        of objects are rows ``a``, ``b``, the numbers of both from 0, and ``value``.

        Raises KeyError that names a near field, OutputError.
        """
        known = {field.name: field for field in self.metadata.fields}
        if name not in known:
            raise KeyError(f"frames have no field {name!r}; {did_you_mean(name, known) or 'no effect of the scene has any'}")
        found = known[name].from_table(self._read(known[name].table, frame))
        if known[name].per == "pair" and not ((found["a"] <= found["b"]) & (found["b"] < len(self.names))).all():
            raise OutputError(f"{self.path}: damaged: a row of {name} in frame {frame} is of objects that are not there")
        return found

    def gone(self, frame: int) -> np.ndarray | None:
        """Ends of the springs that are gone, as numbers of stored particles, int64, shape (G, 2); None where none may be."""
        return ends_gone(self.metadata, lambda name: self._read(name, frame))

    def surface(self, frame: int) -> pyvista.PolyData:
        """Surfaces of all objects in one frame [m], as one mesh.

        Cell data: ``object`` (index into ``names``) and, where the scene sets colours, ``color`` (``#rrggbb``
        as three bytes; black where it sets none).
        """
        import pyvista

        skin = self.metadata.skin
        mesh = pyvista.PolyData.from_regular_faces(skin.vertices(self.position(frame), self.gone(frame)), skin.triangle)
        mesh.cell_data["object"] = skin.object_of_triangle
        if any(self.metadata.colors):
            palette = np.array([_rgb(color) for color in self.metadata.colors], dtype=np.uint8)
            mesh.cell_data["color"] = palette[skin.object_of_triangle]
        return mesh

    @cached_property
    def universe(self) -> MDAnalysis.Universe:
        """The run for MDAnalysis: one residue per object, springs as bonds.

        Lengths are metres, times seconds and velocities m/s (MDAnalysis's own unit is the ångström): the
        reader is opened with ``convert_units=False``. Positions are float32, as everywhere in MDAnalysis.
        """
        from .universe import universe_of

        return universe_of(self)

    def check(self, frame: int) -> None:
        """Compare all values of a frame with their checksums. Raises OutputError where the file is damaged, IndexError."""
        for name in self.frames.tables:
            self._read(name, frame)

    def close(self) -> None:
        """Close the file."""
        self.frames.close()

    def __reduce__(self):
        return Trajectory, (self.path,)  # in another process: opened anew

    def __enter__(self) -> Trajectory:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Trajectory {self.path}: {len(self)} frames, {len(self.names)} objects>"

    def _repr_html_(self) -> str:
        end = f", {self.times[-1]:.4g} s" if len(self) else ""
        rows = [
            (name, f"{mass:.4g} kg", f"{size:,}")
            for name, mass, size in zip(self.names, self.metadata.object_mass, np.diff(self.metadata.first))
        ]
        return html_table(f"{self.path}: {len(self)} frames{end}", ("object", "mass", "stored particles"), rows)

    def _read(self, name: str, frame: int, particles: slice = EVERYTHING) -> np.ndarray:
        """One quantity of a frame, or of some particles in it; the whole of it is checked when it is read for the first time."""
        frame = self._frame(frame)
        with self._damage():
            return self.frames.value(name, frame, particles)

    def _frame(self, frame: int) -> int:
        if not -len(self) <= frame < len(self):
            raise IndexError(f"frame {frame} of a trajectory with {len(self)} frames")
        return range(len(self))[frame]

    @contextmanager
    def _damage(self) -> Iterator[None]:
        """Turn all that HDF5 says of a damaged file into OutputError."""
        try:
            yield
        except DAMAGE as error:
            raise OutputError(f"{self.path}: not a trajectory of mdanim-lammps, or damaged ({error})") from None


class Snapshot:
    """One frame of a trajectory; what is asked for is read."""

    def __init__(self, trajectory: Trajectory, frame: int):
        self.trajectory, self.frame = trajectory, frame

    @property
    def time(self) -> float:
        """Simulated [s]."""
        return float(self.trajectory.times[self.frame])

    @property
    def step(self) -> int:
        """Time step of the simulation."""
        return int(self.trajectory.steps[self.frame])

    @property
    def position(self) -> np.ndarray:
        """Positions of all stored particles [m], shape (N, 3)."""
        return self.trajectory.position(self.frame)

    @property
    def velocity(self) -> np.ndarray:
        """Velocities of all stored particles [m/s], shape (N, 3)."""
        return self.trajectory.velocity(self.frame)

    @property
    def centers(self) -> np.ndarray:
        """Centres of mass of all objects [m], shape (O, 3)."""
        return self.trajectory.centers[self.frame]

    def surface(self) -> pyvista.PolyData:
        """Surfaces of all objects, as `Trajectory.surface`."""
        return self.trajectory.surface(self.frame)

    def __repr__(self) -> str:
        return f"<frame {self.frame} of {len(self.trajectory)}, t = {self.time:.6g} s>"


class ObjectTrack:
    """One object through all frames of a trajectory."""

    def __init__(self, trajectory: Trajectory, index: int):
        self._trajectory = trajectory
        self.index = index
        """Index into ``Trajectory.names``."""
        first = trajectory.metadata.first
        self.particles = slice(int(first[index]), int(first[index + 1]))
        """Its stored particles among all stored particles."""

    @property
    def name(self) -> str:
        return self._trajectory.names[self.index]

    @property
    def mass(self) -> float:
        """Mass of the whole object [kg]."""
        return float(self._trajectory.metadata.object_mass[self.index])

    @property
    def center_of_mass(self) -> np.ndarray:
        """Centre of mass of the whole object, also where only its boundary is stored [m], shape (F, 3)."""
        return self._trajectory.centers[:, self.index]

    @property
    def velocity(self) -> np.ndarray:
        """Velocity of the centre of mass [m/s], shape (F, 3)."""
        return self._trajectory.center_velocities[:, self.index]

    @cached_property
    def spin(self) -> np.ndarray:
        """Angular velocity, angular momentum over inertia about the centre of mass [rad/s], shape (F, 3).

        Raises OutputError where only boundary particles are stored.
        """
        from ..model.spin import spin

        t = self._trajectory
        if t.metadata.save is not Save.ALL:
            raise OutputError(
                f"{t.path}: stores boundary particles only, spin needs all; run the scene with control {{ save all }}"
            )
        mass, first = t.metadata.mass[self.particles], np.zeros(1, int)
        found = [spin(mass, first, self.position(n), t._read("velocity", n, self.particles))[0] for n in range(len(t))]
        return np.array(found).reshape(-1, 3)

    def position(self, frame: int) -> np.ndarray:
        """Positions of its stored particles [m], shape (n, 3)."""
        return self._trajectory._read("position", frame, self.particles)

    def surface(self, frame: int) -> pyvista.PolyData:
        """Its surface in a frame [m]."""
        import pyvista

        t = self._trajectory
        skin = t.metadata.skin
        own = skin.object_of_triangle == self.index
        start = int(np.searchsorted(skin.object_of_vertex, self.index))
        end = int(np.searchsorted(skin.object_of_vertex, self.index, side="right"))
        return pyvista.PolyData.from_regular_faces(
            skin.vertices(t.position(frame), t.gone(frame))[start:end], skin.triangle[own] - start
        )

    def __repr__(self) -> str:
        return f"<ObjectTrack {self.name}: {self.particles.stop - self.particles.start} particles>"


def import_pandas():
    """Raises SetupError where it is not installed."""
    try:
        import pandas
    except ImportError:
        raise SetupError("pandas is not installed: pip install 'mdanim-lammps[export]'") from None
    return pandas


def _rgb(color: str) -> tuple[int, int, int]:
    red, green, blue = bytes.fromhex(color[1:]) if color else (0, 0, 0)
    return red, green, blue
