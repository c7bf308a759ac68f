# SPDX-License-Identifier: GPL-2.0-only
"""The trajectory file: H5MD 1.1 with all that pictures need, readable after a crash (docs/trajectory.md)."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import OutputError
from ..model.basin import Grid
from ..model.model import Model, Surface
from ..scene.scene import Save, Scene
from ..scene.keywords import did_you_mean
from .catalogue import Catalogue, Pool, catalogue_of, distinct_surfaces, stored_particles

if TYPE_CHECKING:
    import h5py
    import MDAnalysis
    import pyvista

FILE_NAME = "trajectory.h5"
FORMAT = 2
"""Version of ``/parameters/mdanim``; a reader refuses what is newer. Version 1 knew no liquid."""

LIQUID = ("liquid/height", "liquid/raw")
"""Heights of a liquid: smooth, and of the topmost cells; below ``/observables``."""

# HDF5 1.10 is the oldest that knows single-writer-multiple-reader files, readable at any instant.
_LIBVER = ("v110", "v110")
_CHUNK_BYTES = 1 << 20
# Room for what HDF5 writes of its own between two claims and at the end: chunk indices, sizes, short rows.
_CLOSING_BYTES = 1 << 18


def trajectory_bytes(
    models: Sequence[Model], frames: int, save: Save = Save.ALL, single: bool = False, grid: Grid | None = None
) -> int:
    """Size of the trajectory file [bytes] before anything is run, rather too large than too small.

    Args:
        models: all objects.
        frames: number of frames, the first included.
        save: which particles are stored.
        single: whether positions and velocities take 4 bytes a number instead of 8.
        grid: cells of the liquid, if there is one.
    """
    stored = sum(int(stored_particles(model, save).sum()) for model in models)
    per_frame = stored * 6 * (4 if single else 8) + len(models) * 6 * 8 + 16
    if grid:
        per_frame += 2 * 4 * grid.shape[0] * grid.shape[1]
    surfaces = distinct_surfaces(models, [stored_particles(model, save) for model in models])[0]
    springs = sum(len(model.spring) for model in models)
    return frames * per_frame + _fixed_bytes(stored, springs, surfaces) + 64 * 1024


class TrajectoryWriter:
    """Writes frames to ``PATH.part``; ``close`` gives the file its name.

    A frame counts once ``flush`` has returned: it then survives the death of the process at any instant. The
    file is written in HDF5's single-writer mode, and a frame's number is written only after its data.

    Args:
        path: the finished file, usually ``FOLDER/trajectory.h5``.
        scene: for names, colours, ground, walls and ``control save``.
        models: one per solid; frames have the particles of all models one after the other.
        dt: time step [s].
        steps_per_frame: time steps between frames.
        scene_text: the expanded scene, so that pictures need no other file.
        grid: cells of the scene's liquid; every frame then has heights. None without liquid.

    Raises:
        OutputError: the file cannot be written, e.g. because the disk is full.
    """

    def __init__(
        self,
        path: str | Path,
        scene: Scene,
        models: Sequence[Model],
        *,
        dt: float,
        steps_per_frame: int,
        scene_text: str = "",
        grid: Grid | None = None,
    ):
        self._start(Path(path), catalogue_of(scene, models, scene_text, grid), dt, steps_per_frame)
        # Masses of all particles, stored or not: the centre of mass is the whole object's.
        self._weigh(np.concatenate([model.mass for model in models]), [len(m.position) for m in models])

    @classmethod
    def append(
        cls, path: str | Path, scene: Scene, models: Sequence[Model], after_step: int, grid: Grid | None = None
    ) -> TrajectoryWriter:
        """Go on with the trajectory of a run that ended early; frames after ``after_step`` are dropped.

        The frames are copied to a fresh file first, so a second crash loses nothing that was there.

        Args:
            path: as for a new trajectory; ``PATH`` or, of a killed run, ``PATH.part`` must exist.
            scene, models, grid: the same as in the first run.
            after_step: last step to keep.

        Raises:
            OutputError: no trajectory there, one of other objects, or it cannot be written.
        """
        path = Path(path)
        with Trajectory(path) as old:
            keep = int(np.searchsorted(old.steps, after_step, side="right"))
            names = tuple(model.name for model in models)
            if old.catalogue.names != names or old.catalogue.total != sum(len(m.position) for m in models):
                raise OutputError(
                    f"{old.path}: holds {len(old.names)} objects with {old.catalogue.total} particles, "
                    f"not this scene's; start afresh with --force or another -o folder"
                )
            if (old.liquid and old.liquid.grid) != grid:
                raise OutputError(
                    f"{old.path}: holds {_described(old.liquid and old.liquid.grid)}, this scene "
                    f"{_described(grid)}; start afresh with --force or another -o folder"
                )
            self = cls.__new__(cls)
            self._start(path, old.catalogue, old.dt, old.steps_per_frame, suffix=".part.new")
            self._weigh(np.concatenate([model.mass for model in models]), [len(m.position) for m in models])
            with _disk(self._partial):
                for name, target in self._values.items():
                    target.resize(keep, axis=0)
                    for i in range(keep):
                        target[i] = old._values[name][i]
            self._pending = list(zip(old.steps[:keep].tolist(), old.times[:keep].tolist()))
            self._count = keep
        self.flush()
        os.replace(self._partial, part_of(path))
        self._partial = part_of(path)
        return self

    def write(
        self,
        step: int,
        time: float,
        position: np.ndarray,
        velocity: np.ndarray,
        liquid: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> None:
        """Add a frame.

        Args:
            step: time step number, larger than that of the frame before.
            time: simulated time [s].
            position: of all particles, stored or not [m], shape (N, 3).
            velocity: [m/s], shape (N, 3).
            liquid: heights z of the liquid over the columns of its cells, smooth and raw [m], each of shape
                (ny, nx); raw ones are NaN where a solid hides
                the liquid, minus infinity where one keeps the column dry, as a hull does. None without liquid.
        """
        for name, array in (("position", position), ("velocity", velocity)):
            if np.shape(array) != (self.catalogue.total, 3):
                raise ValueError(f"{name} must have shape ({self.catalogue.total}, 3), found {np.shape(array)}")
        pool = self.catalogue.liquid
        wanted = [pool.shape[1::-1]] * 2 if pool else []
        found = [np.shape(height) for height in liquid or ()]
        if found != wanted:
            raise ValueError(f"liquid must be heights of shapes {wanted}, found {found}")
        if step <= self._last_step:
            raise ValueError(f"step must be larger than that of the frame before ({self._last_step}), found {step}")
        rows = {
            "position": position[self._stored],
            "velocity": velocity[self._stored],
            "center_of_mass": self._mean(position),
            "center_of_mass_velocity": self._mean(velocity),
        }
        if liquid:
            rows |= {name: np.asarray(h, np.float32) for name, h in zip(LIQUID, liquid)}
        with _disk(self._partial):
            self._claim(sum(row.nbytes for row in rows.values()))
            for name, row in rows.items():
                _append(self._values[name], self._count, row)
        self._count += 1
        self._pending.append((int(step), float(time)))

    @property
    def _last_step(self) -> int:
        return self._pending[-1][0] if self._pending else self._flushed_step

    def flush(self) -> None:
        """Make all frames so far safe against the death of this process."""
        if not self._pending:
            return
        with _disk(self._partial):
            # The number of a frame vouches for its data, so the data go first.
            self._file.flush()
            steps, times = zip(*self._pending)
            for dataset, column in ((self._step, steps), (self._time, times)):
                dataset.resize(self._count, axis=0)
                dataset[self._count - len(column) :] = column
            self._file.flush()
        self._flushed_step = self._pending[-1][0]
        self._pending.clear()

    def close(self, *, finished: bool = True) -> Path:
        """Flush, close, and give the file its name; returns where it is.

        Args:
            finished: False leaves it as ``PATH.part``, for a run that will be resumed.
        """
        if self._file:
            self.flush()
            with _disk(self._partial):
                self._file.close()
                if finished:
                    os.replace(self._partial, self.path)
        return self.path if finished else self._partial

    def __enter__(self) -> TrajectoryWriter:
        return self

    def __exit__(self, kind, value, traceback) -> None:
        self.close(finished=kind is None)

    def _start(self, path: Path, catalogue: Catalogue, dt: float, steps_per_frame: int, suffix: str = ".part"):
        import h5py

        self.path = path
        self.catalogue = catalogue
        self._partial = path.with_name(path.name + suffix)
        self._count = 0
        self._pending: list[tuple[int, float]] = []
        self._flushed_step = -1
        self._stored = slice(None) if len(catalogue.id) == catalogue.total else catalogue.id - 1
        with _disk(self._partial):
            self._file = h5py.File(self._partial, "w", libver=_LIBVER)
            try:
                text = len(catalogue.scene_text) + sum(map(len, catalogue.names))
                self._claim(_fixed_bytes(len(catalogue.id), len(catalogue.bond), catalogue.surfaces) + 8 * text)
                self._step, self._time, self._values = _create(self._file, catalogue, dt, steps_per_frame)
                self._file.swmr_mode = True
                self._file.flush()
            except OSError:
                self._file.close()
                self._partial.unlink()
                raise

    def _claim(self, size: int) -> None:
        """Take room on the disk before HDF5 needs it: it cannot even close a file once a write has failed."""
        with self._partial.open("r+b") as file:
            os.posix_fallocate(file.fileno(), 0, self._file.id.get_filesize() + size + _CLOSING_BYTES)

    def _weigh(self, mass: np.ndarray, sizes: list[int]) -> None:
        self._starts = np.cumsum([0] + sizes[:-1])
        self._mass = mass[:, None]
        self._object_mass = np.add.reduceat(self._mass, self._starts)

    def _mean(self, value: np.ndarray) -> np.ndarray:
        """Mass-weighted mean over each object, shape (O, 3)."""
        return np.add.reduceat(self._mass * value, self._starts) / self._object_mass


class Trajectory:
    """A finished, running or crashed run, read frame by frame; F frames, O objects, N stored particles.

    Args:
        path: output folder, trajectory file, or the ``.part`` of a run that has not ended.

    Raises:
        OutputError: no trajectory there, or not one of ours.
    """

    def __init__(self, path: str | Path):
        self.path = _find(Path(path))
        self._file = _open(self.path)
        try:
            particles = self._file["particles/all"]
            values = {name: particles[f"{name}/value"] for name in ("position", "velocity")}
            for name in ("center_of_mass", "center_of_mass_velocity"):
                values[name] = self._file[f"observables/{name}/value"]
            self._values = values
            self.catalogue = _read_catalogue(self._file)
            if self.catalogue.liquid:
                values |= {name: self._file[f"observables/{name}/value"] for name in LIQUID}
            parameters = self._file["parameters/mdanim"].attrs
            self.dt = float(parameters["dt"])
            self.steps_per_frame = int(parameters["steps_per_frame"])
            step, time = particles["position/step"][:], particles["position/time"][:]
        except (KeyError, OSError) as error:
            self._file.close()
            raise OutputError(f"{self.path}: not a trajectory of mdanim-lammps, or damaged ({error})") from None
        count = min(len(step), len(time), *(len(value) for value in values.values()))
        self.steps: np.ndarray = step[:count]
        """Time step of each frame, shape (F,)."""
        self.times: np.ndarray = time[:count]
        """Simulated time of each frame [s], shape (F,)."""

    @property
    def names(self) -> tuple[str, ...]:
        """Object names, in the order of the scene."""
        return self.catalogue.names

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.times)

    @cached_property
    def objects(self) -> Mapping[str, ObjectTrack]:
        """The objects by name; a KeyError for another name suggests one."""
        return _Tracks((name, ObjectTrack(self, index)) for index, name in enumerate(self.names))

    def position(self, frame: int) -> np.ndarray:
        """Positions of all stored particles [m], shape (N, 3)."""
        return self._values["position"][self._frame(frame)]

    def velocity(self, frame: int) -> np.ndarray:
        """Velocities of all stored particles [m/s], shape (N, 3)."""
        return self._values["velocity"][self._frame(frame)]

    @cached_property
    def centers(self) -> np.ndarray:
        """Centres of mass of all objects [m], shape (F, O, 3)."""
        return self._values["center_of_mass"][: len(self)]

    @cached_property
    def center_velocities(self) -> np.ndarray:
        """Velocities of the centres of mass [m/s], shape (F, O, 3)."""
        return self._values["center_of_mass_velocity"][: len(self)]

    @property
    def liquid(self) -> Pool | None:
        """The liquid and its basin; None in a scene without."""
        return self.catalogue.liquid

    def liquid_height(self, frame: int) -> np.ndarray:
        """Smooth height z of the liquid over each column of cells [m], float32, shape (ny, nx)."""
        return self._liquid(LIQUID[0], frame)

    def liquid_raw(self, frame: int) -> np.ndarray:
        """Top of the topmost liquid cell of each column, z [m], float32, shape (ny, nx); NaN where a solid
        hides it, minus infinity where one keeps the column dry, as a hull does."""
        return self._liquid(LIQUID[1], frame)

    @cached_property
    def liquid_levels(self) -> np.ndarray:
        """Mean height z of the liquid over the basin [m], shape (F,)."""
        return np.array([self.liquid_height(i).mean(dtype=np.float64) for i in range(len(self))])

    def surface(self, frame: int) -> pyvista.PolyData:
        """Surfaces of all objects in one frame [m], as one mesh.

        Cell data: ``object`` (index into ``names``) and, where the scene sets colours, ``color`` (``#rrggbb``
        as three bytes; black where it sets none).
        """
        import pyvista

        skin = self.catalogue.skin
        mesh = pyvista.PolyData.from_regular_faces(skin.vertices(self.position(frame)), skin.triangle)
        mesh.cell_data["object"] = skin.object_of_triangle
        if any(self.catalogue.colors):
            palette = np.array([_rgb(color) for color in self.catalogue.colors], dtype=np.uint8)
            mesh.cell_data["color"] = palette[skin.object_of_triangle]
        return mesh

    @cached_property
    def universe(self) -> MDAnalysis.Universe:
        """The run for MDAnalysis: one residue per object, springs as bonds.

        Lengths are metres, times seconds and velocities m/s (MDAnalysis's own unit is the ångström): the
        reader is opened with ``convert_units=False``. Positions are float32, as everywhere in MDAnalysis.
        """
        import MDAnalysis
        from MDAnalysis.coordinates.H5MD import H5MDReader

        catalogue = self.catalogue
        universe = MDAnalysis.Universe.empty(
            len(catalogue.id), n_residues=len(self.names), atom_resindex=catalogue.object_of, trajectory=False
        )
        universe.add_TopologyAttr("masses", catalogue.mass)
        universe.add_TopologyAttr("ids", catalogue.id)
        universe.add_TopologyAttr("types", catalogue.layer.astype(str).astype(object))
        universe.add_TopologyAttr("names", np.array(self.names, dtype=object)[catalogue.object_of])
        universe.add_TopologyAttr("resids", np.arange(1, len(self.names) + 1))
        universe.add_TopologyAttr("resnames", np.array(self.names, dtype=object))
        if len(catalogue.bond):
            rank = np.full(catalogue.total + 1, -1)
            rank[catalogue.id] = np.arange(len(catalogue.id))
            universe.add_TopologyAttr("bonds", rank[catalogue.bond])
        # A file that is still written, or whose writer was killed, opens only in the mode that _open knows.
        source = _open(self.path) if _is_part(self.path) else str(self.path)
        frame = self.dt * self.steps_per_frame
        universe.trajectory = H5MDReader(source, convert_units=False, dt=frame)
        return universe

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Trajectory:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Trajectory {self.path}: {len(self)} frames, {len(self.names)} objects>"

    def _liquid(self, name: str, frame: int) -> np.ndarray:
        if self.liquid is None:
            raise OutputError(f"{self.path}: there is no liquid in this run")
        return self._values[name][self._frame(frame)]

    def _frame(self, frame: int) -> int:
        if not -len(self) <= frame < len(self):
            raise IndexError(f"frame {frame} of a trajectory with {len(self)} frames")
        return range(len(self))[frame]


class _Tracks(dict):
    """Objects by name."""

    def __missing__(self, name):
        raise KeyError(f"no object is called {name!r}; {did_you_mean(str(name), self) or 'see Trajectory.names'}")


class ObjectTrack:
    """One object through all frames of a trajectory."""

    def __init__(self, trajectory: Trajectory, index: int):
        self._trajectory = trajectory
        self.index = index
        """Index into ``Trajectory.names``."""
        first = trajectory.catalogue.first
        self.particles = slice(int(first[index]), int(first[index + 1]))
        """Its stored particles among all stored particles."""

    @property
    def name(self) -> str:
        return self._trajectory.names[self.index]

    @property
    def mass(self) -> float:
        """Mass of the whole object [kg]."""
        return float(self._trajectory.catalogue.object_mass[self.index])

    @property
    def center_of_mass(self) -> np.ndarray:
        """Of the whole object, also where only its boundary is stored [m], shape (F, 3)."""
        return self._trajectory.centers[:, self.index]

    @property
    def velocity(self) -> np.ndarray:
        """Of the centre of mass [m/s], shape (F, 3)."""
        return self._trajectory.center_velocities[:, self.index]

    def position(self, frame: int) -> np.ndarray:
        """Positions of its stored particles [m], shape (n, 3)."""
        trajectory = self._trajectory
        return trajectory._values["position"][trajectory._frame(frame), self.particles]

    def __repr__(self) -> str:
        return f"<ObjectTrack {self.name}: {self.particles.stop - self.particles.start} particles>"


# --- the file ---------------------------------------------------------------------------------------------


def part_of(path: str | Path) -> Path:
    """Where a trajectory is while it is written."""
    path = Path(path)
    return path.with_name(path.name + ".part")


def _fixed_bytes(particles: int, springs: int, surfaces: Sequence[Surface]) -> int:
    """What the file holds beside the frames, before packing."""
    per_surface = (s.triangle.nbytes + s.index.nbytes + s.weight.nbytes for s in surfaces)
    return 22 * particles + 8 * springs + sum(per_surface)


def _create(file: h5py.File, catalogue: Catalogue, dt: float, steps_per_frame: int):
    """Lay out the whole file; nothing but rows can be added later (single-writer mode)."""
    header = file.create_group("h5md")
    header.attrs["version"] = np.array([1, 1], dtype=np.int32)
    header.create_group("author").attrs["name"] = "mdanim-lammps"
    header.create_group("creator").attrs.update(name="mdanim-lammps", version=_version())

    particles = file.create_group("particles/all")
    box = particles.create_group("box")
    box.attrs["dimension"] = 3
    box.attrs["boundary"] = np.array(["none"] * 3, dtype="S4")
    step = file.create_dataset("particles/all/position/step", (0,), np.int64, maxshape=(None,), chunks=(256,))
    time = file.create_dataset("particles/all/position/time", (0,), np.float64, maxshape=(None,), chunks=(256,))
    time.attrs["unit"] = "s"

    real = np.float32 if catalogue.single else np.float64
    n, objects = len(catalogue.id), len(catalogue.names)
    pool = catalogue.liquid
    values = {}
    for name, where, row, dtype, unit in (
        ("position", "particles/all", (n, 3), real, "m"),
        ("velocity", "particles/all", (n, 3), real, "m s-1"),
        ("center_of_mass", "observables", (objects, 3), np.float64, "m"),
        ("center_of_mass_velocity", "observables", (objects, 3), np.float64, "m s-1"),
        *((name, "observables", pool.shape[1::-1], np.float32, "m") for name in LIQUID if pool),
    ):
        group = file.require_group(f"{where}/{name}")
        line = 8 * row[1]
        # One frame a chunk for particles; of the short rows of objects as many frames as make a page.
        per_chunk = max(1, min(64, 4096 // (line * row[0])))
        # Chunks of equal length, so that none is stored half empty.
        chunk = (per_chunk, -(-row[0] // max(1, -(-row[0] * line // _CHUNK_BYTES))), row[1])
        values[name] = group.create_dataset("value", (0, *row), dtype, maxshape=(None, *row), chunks=chunk)
        # H5MD's own attribute is `unit`, but MDAnalysis refuses a file whose length unit it does not
        # know, and it knows no metre; so `units` says it everywhere and `unit` where it is understood.
        values[name].attrs["units"] = unit
        if unit != "m":
            values[name].attrs["unit"] = unit
        for key, dataset in (("step", step), ("time", time)):
            if key not in group:
                group[key] = dataset

    if pool:
        file["observables/liquid"].attrs.update(
            name=pool.name,
            low=pool.low,
            high=pool.high,
            shape=np.array(pool.shape, dtype=np.int64),
            density=pool.density,
            color=pool.color,
        )

    particles.create_dataset("mass", data=catalogue.mass).attrs["unit"] = "kg"
    particles["id"] = catalogue.id.astype(np.int64)
    particles["species"] = catalogue.layer.astype(np.int8)
    particles["object"] = catalogue.object_of
    particles["held"] = catalogue.held.astype(np.uint8)
    bonds = file.create_group("connectivity").create_dataset("bonds", data=catalogue.bond, **_packed(catalogue.bond))
    bonds.attrs["particles_group"] = particles.ref

    _write_catalogue(file.create_group("parameters/mdanim"), catalogue, dt, steps_per_frame)
    return step, time, values


def _append(dataset: h5py.Dataset, count: int, row: np.ndarray) -> None:
    """Put a row behind the ``count`` that are there: what h5py's own ``resize`` and ``dataset[count] = row`` come down to, in a
    third of their time where rows are short."""
    from h5py import h5s

    low, one = dataset.id, (1, *row.shape)
    low.set_extent((count + 1, *row.shape))
    place = low.get_space()
    place.select_hyperslab((count, *(0 for _ in row.shape)), one)
    low.write(h5s.create_simple(one), place, np.ascontiguousarray(row, dataset.dtype))


def _write_catalogue(group: h5py.Group, catalogue: Catalogue, dt: float, steps_per_frame: int) -> None:
    group.attrs.update(
        format=FORMAT,
        dt=dt,
        steps_per_frame=steps_per_frame,
        title=catalogue.title,
        total=catalogue.total,
        save=catalogue.save.value,
        single=catalogue.single,
    )
    if catalogue.ground is not None:
        group.attrs["ground"] = catalogue.ground
    if catalogue.walls is not None:
        group.attrs["walls"] = np.array(catalogue.walls)
    group["scene"] = _text([catalogue.scene_text])
    group["name"] = _text(catalogue.names)
    group["color"] = _text(catalogue.colors)
    group["still"] = catalogue.still.astype(np.uint8)
    group["object_mass"] = catalogue.object_mass
    group["first"] = catalogue.first.astype(np.int64)
    group["surface_of"] = catalogue.surface_of.astype(np.int64)
    surfaces = group.create_group("surface")
    shapes = [(len(s.triangle), len(s.index), s.index.shape[1]) for s in catalogue.surfaces]
    surfaces["shape"] = np.array(shapes, dtype=np.int64).reshape(-1, 3)
    for name in ("triangle", "index", "weight"):
        flat = np.concatenate(
            [np.zeros(0, np.int32 if name != "weight" else np.float64)] + [getattr(s, name).ravel() for s in catalogue.surfaces]
        )
        surfaces.create_dataset(name, data=flat, **_packed(flat))


def _read_pool(file: h5py.File) -> Pool | None:
    if "observables/liquid" not in file:
        return None
    attributes = file["observables/liquid"].attrs
    low, high, shape = (tuple(attributes[key].tolist()) for key in ("low", "high", "shape"))
    return Pool(attributes["name"], low, high, shape, float(attributes["density"]), attributes["color"])


def _described(grid: Grid | None) -> str:
    return f"a liquid in {' x '.join(map(str, grid.shape))} cells" if grid else "no liquid"


def _read_catalogue(file: h5py.File) -> Catalogue:
    group, particles = file["parameters/mdanim"], file["particles/all"]
    if group.attrs["format"] > FORMAT:
        raise KeyError(f"format {group.attrs['format']}, newer than {FORMAT}: update mdanim-lammps")
    flat = {name: group[f"surface/{name}"][:] for name in ("triangle", "index", "weight")}
    shapes = group["surface/shape"][:]
    ends = np.cumsum(np.stack([3 * shapes[:, 0], shapes[:, 1] * shapes[:, 2]], axis=1), axis=0)
    surfaces = tuple(
        Surface(
            triangle=flat["triangle"][t - 3 * triangles : t].reshape(-1, 3),
            index=flat["index"][v - vertices * corners : v].reshape(-1, corners),
            weight=flat["weight"][v - vertices * corners : v].reshape(-1, corners),
        )
        for (triangles, vertices, corners), (t, v) in zip(shapes, ends)
    )
    walls = group.attrs.get("walls")
    return Catalogue(
        title=group.attrs["title"],
        names=_texts(group["name"]),
        colors=_texts(group["color"]),
        still=group["still"][:].astype(bool),
        object_mass=group["object_mass"][:],
        first=group["first"][:],
        total=int(group.attrs["total"]),
        id=particles["id"][:],
        mass=particles["mass"][:],
        layer=particles["species"][:],
        held=particles["held"][:].astype(bool),
        bond=file["connectivity/bonds"][:],
        surfaces=surfaces,
        surface_of=group["surface_of"][:],
        ground=float(group.attrs["ground"]) if "ground" in group.attrs else None,
        walls=None if walls is None else (tuple(walls[0].tolist()), tuple(walls[1].tolist())),
        liquid=_read_pool(file),
        save=Save(group.attrs["save"]),
        single=bool(group.attrs["single"]),
        scene_text=_texts(group["scene"])[0],
    )


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("mdanim-lammps")
    except PackageNotFoundError:
        return "source tree"


def _packed(array: np.ndarray) -> dict:
    """Options that shrink tables of whole numbers; an empty table takes none."""
    return {"compression": "gzip", "compression_opts": 1, "shuffle": True} if array.size else {}


def _text(lines: Sequence[str]) -> np.ndarray:
    """UTF-8 in fields of fixed width: variable ones cannot live in a file in single-writer mode."""
    encoded = [line.encode() for line in lines]
    return np.array(encoded, dtype=f"S{max([1, *map(len, encoded)])}")


def _texts(dataset: h5py.Dataset) -> tuple[str, ...]:
    return tuple(line.decode() for line in dataset[:])


def _rgb(color: str) -> tuple[int, int, int]:
    return tuple(bytes.fromhex(color[1:])) if color else (0, 0, 0)


def _is_part(path: Path) -> bool:
    return ".part" in path.suffixes


def _find(path: Path) -> Path:
    file = path / FILE_NAME if path.is_dir() else path
    for candidate in (file, part_of(file)):
        if candidate.is_file():
            return candidate
    raise OutputError(f"{file}: no such trajectory; run the scene first, or name the folder that a run wrote")


def _open(path: Path) -> h5py.File:
    import h5py

    try:
        return h5py.File(path, "r", libver=_LIBVER, swmr=_is_part(path))
    except OSError as error:
        raise OutputError(f"{path}: cannot be read as HDF5 ({error})") from None


@contextmanager
def _disk(path: Path) -> Iterator[None]:
    """Turn what the disk says into an error with a way out."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        reason = os.strerror(error.errno) if getattr(error, "errno", None) else str(error)
        cure = "check the folder's permissions and the disk, then `resume`"
        if getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG) or "space" in str(error):
            cure = "make room (or `control { save boundary single }`, which needs far less), then `resume`"
        raise OutputError(f"{path}: cannot be written: {reason}; {cure}") from error
