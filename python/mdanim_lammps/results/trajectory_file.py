# SPDX-License-Identifier: GPL-2.0-only
"""The trajectory file: H5MD 1.1 in HDF5, with room for all frames from the start (docs/trajectory.md).

HDF5 lays the file out once, before the first frame. Every quantity of the frames is one contiguous table, so the writer puts
the bytes of a frame in their place without HDF5. A disk that is full or broken then meets plain writes, which fail with an
error and nothing else, and a killed writer leaves a file that HDF5 opens.
"""

from __future__ import annotations

import errno
import gc
import io
import math
import os
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..effects.fields import Field
from ..effects.kept import KeptRecord, kinds
from ..errors import OutputError
from ..model.model import Model, Surface
from ..records import dataclass
from ..scene.scene import Save
from .files import disk_errors, sync
from .trajectory_metadata import FIELDS, TrajectoryMetadata, distinct_surfaces, stored_particles
from .untrusted import check_plain

if TYPE_CHECKING:
    import h5py

FILE_NAME = "trajectory.h5"
FORMAT = 3
"""Version of ``/parameters/mdanim``; a reader refuses what is newer. Version 1 has no liquid, 2 no checksums."""

STEP, TIME, CHECKSUM = "step", "time", "checksum"
_ROW = (STEP, TIME, CHECKSUM)
"""Tables of what a frame has beside its quantities."""
NOT_WRITTEN = -1
"""Step of a frame that is still to come."""
OF_SOME = {"painted": ("color", (3,)), "tubed": ("tube", (4,)), "patched": ("patch", ())}
"""Tables of vertices that only some surfaces have, with the shape of a row, by the table that tells which surfaces have one."""

_LIBVER = ("v110", "v110")  # the first HDF5 whose whole metadata have checksums
# HDF5 puts groups, attributes and indices into blocks of this size; one block holds all of a usual file.
_METADATA_BYTES = 1 << 16
_CHUNK_BYTES = 1 << 20


@dataclass(frozen=True, slots=True)
class FrameTable:
    """Where the file holds one quantity of all frames."""

    offset: int
    """Place of frame 0 in the file [bytes]."""
    dtype: np.dtype
    shape: tuple[int, ...]
    """Shape in one frame."""
    frames: int
    """Frames that there is room for."""
    pieces: h5py.Dataset | None = None
    """The table itself where it does not lie in one piece, as before format 3."""

    @property
    def stride(self) -> int:
        """Bytes of one frame."""
        return math.prod(self.shape) * self.dtype.itemsize

    @property
    def row(self) -> int:
        """Bytes of one row of a frame, such as a particle's position."""
        return math.prod(self.shape[1:]) * self.dtype.itemsize


def trajectory_bytes(
    models: Sequence[Model], frames: int, save: Save = Save.ALL, single: bool = False, fields: Iterable[Field] = ()
) -> int:
    """Size of the trajectory file [bytes] before anything is run, rather too large than too small.

    Args:
        models: all objects.
        frames: number of frames, the first included.
        save: which particles are stored.
        single: whether positions and velocities take 4 bytes a number instead of 8.
        fields: that frames have besides (`trajectory_metadata.kept_fields`).
    """
    stored = sum(int(stored_particles(model, save).sum()) for model in models)
    per_frame = stored * 6 * (4 if single else 8) + len(models) * 6 * 8 + 16 + 4 * 7
    per_frame += sum(math.prod(of.whole_shape) * np.dtype(of.dtype).itemsize for of in fields)
    surfaces = distinct_surfaces(models, [stored_particles(model, save) for model in models])[0]
    springs = sum(len(model.spring) for model in models)
    return frames * per_frame + _fixed_bytes(stored, springs, surfaces) + _METADATA_BYTES


def part_of(path: str | Path) -> Path:
    """Where a trajectory is while it is written."""
    path = Path(path)
    return path.with_name(path.name + ".part")


def trajectory_names(path: Path) -> tuple[Path, ...]:
    """Names that a trajectory file, given by its folder or its own path, has in turn, in the order in which to ask for them. A
    run that ends gives it its last name, one that is resumed takes that away: who asks for all of these misses neither."""
    file = path / FILE_NAME if path.is_dir() else path
    return file, part_of(file), file


def find_trajectory(path: Path) -> Path:
    """The trajectory file of a folder, or of its own path, finished or not. Raises OutputError."""
    for candidate in trajectory_names(path):
        if path.is_dir():
            check_plain(candidate)
        if candidate.is_file():
            return candidate
    raise OutputError(
        f"{trajectory_names(path)[0]}: no such trajectory; run the scene first, or name the folder that a run wrote"
    )


class _Source(io.BufferedReader):
    """A file that is closed without a warning when nothing refers to it any more, as an `h5py.File` is."""

    def __del__(self):
        self.close()


def open_trajectory(path: Path) -> h5py.File:
    """Open a file for reading, through a file of Python's: HDF5 then takes no lock, which another process or a file system may
    refuse, and lets others in this process open the file in their own way. Raises OutputError."""
    import h5py

    def opened() -> h5py.File:
        return h5py.File(_Source(path.open("rb", buffering=0)), "r")

    try:
        try:
            return opened()
        except OSError as error:
            if error.errno != errno.EMFILE:
                raise
            gc.collect()  # files of trajectories that nothing refers to any more
            return opened()
    except (OSError, RuntimeError, ValueError) as error:
        raise OutputError(f"{path}: cannot be read as HDF5, it is not a trajectory or it is damaged ({error})") from None


def create_trajectory(path: Path, metadata: TrajectoryMetadata, frames: int, dt: float, steps_per_frame: int) -> None:
    """Make a file with room for ``frames`` frames, none of which is written yet; the room is taken frame by frame.

    Raises:
        OutputError: no room for what is not frames, or a size that the disk does not allow.
    """
    import h5py

    with _hdf5_errors(path):
        try:
            with h5py.File(path, "w", libver=_LIBVER, meta_block_size=_METADATA_BYTES, locking=False) as file:
                _claim(path, metadata, frames)
                _write_tables(file, metadata, frames, dt, steps_per_frame)
                size = _claim_rest(path, file)
            os.truncate(path, size)
            sync(path)
        except BaseException:
            path.unlink(missing_ok=True)
            raise


def frame_tables(file: h5py.File) -> dict[str, FrameTable]:
    """Where the tables of the frames are, by the names of `quantities`, STEP, TIME and CHECKSUM. Raises KeyError."""
    return {
        name: FrameTable(d.id.get_offset() or 0, d.dtype, d.shape[1:], len(d), d if d.chunks else None)
        for name, d in datasets_of_frames(file).items()
    }


def datasets_of_frames(file: h5py.File) -> dict[str, h5py.Dataset]:
    """The datasets of the frames by name: STEP, TIME, CHECKSUM (not before format 3), and the quantities. Raises KeyError."""
    particles, own = file["particles/all"], file["parameters/mdanim"]
    found = {STEP: particles["position/step"], TIME: particles["position/time"]}
    if CHECKSUM in own:
        found[CHECKSUM] = own[CHECKSUM]
    found |= {name: particles[f"{name}/value"] for name in ("position", "velocity")}
    names = ["center_of_mass", "center_of_mass_velocity"]
    names += [table for kind in kinds().values() for table in _shapes(file, kind)]
    names += [f"{FIELDS}/{name}" for name in _names_of_fields(file)]
    return found | {name: file[f"observables/{name}/value"] for name in names}


def row_checksum(step: int, time: float) -> int:
    """Checksum of a frame's step and time."""
    return zlib.crc32(np.float64(time).tobytes(), zlib.crc32(np.int64(step).tobytes()))


def checksum(values: np.ndarray) -> int:
    """Checksum of the values of one quantity in one frame; C-contiguous."""
    return zlib.crc32(values) if values.size else 0


def frame_shapes(metadata: TrajectoryMetadata) -> dict[str, tuple[int, ...]]:
    """Shape of one frame of each quantity."""
    return {name: tuple(shape) for name, _, shape, _, _ in _quantities(metadata)}


def _quantities(metadata: TrajectoryMetadata) -> Iterator[tuple[str, str, tuple[int, ...], type, str]]:
    """Quantities that every frame has: name, group above it, shape, type, unit."""
    real = np.float32 if metadata.single else np.float64
    n, objects = len(metadata.id), len(metadata.names)
    yield "position", "particles/all", (n, 3), real, "m"
    yield "velocity", "particles/all", (n, 3), real, "m s-1"
    yield "center_of_mass", "observables", (objects, 3), np.float64, "m"
    yield "center_of_mass_velocity", "observables", (objects, 3), np.float64, "m s-1"
    for of in metadata.fields:
        yield of.table, "observables", of.whole_shape, np.dtype(of.dtype).type, of.unit


def _fixed_bytes(particles: int, springs: int, surfaces: Sequence[Surface]) -> int:
    """Size of the file besides the frames, before packing."""
    per_surface = (s.triangle.nbytes + s.index.nbytes + s.weight.nbytes + 3 * len(s.index) for s in surfaces)
    return 22 * particles + 8 * springs + sum(per_surface)


def _claim(path: Path, metadata: TrajectoryMetadata, frames: int) -> None:
    """Ask for the size of the file and take the room of all that HDF5 writes, before it does: HDF5 cannot close a file once a
    write has failed. Raises OSError."""
    text = len(metadata.scene_text) + sum(map(len, metadata.names))
    fixed = _fixed_bytes(len(metadata.id), len(metadata.bond), metadata.surfaces) + 8 * text + 64 * len(metadata.names)
    per_frame = [int(np.prod(shape)) * np.dtype(real).itemsize for _, _, shape, real, _ in _quantities(metadata)]
    fixed += frames * (16 + 4 * (1 + len(per_frame))) + 2 * _METADATA_BYTES
    os.truncate(path, fixed + frames * sum(per_frame))
    with path.open("r+b") as file:
        os.posix_fallocate(file.fileno(), 0, fixed)


def _claim_rest(path: Path, file: h5py.File) -> int:
    """Take the room of all that is not frames; returns the size of the file [bytes]. Raises OSError."""
    size = file.id.get_filesize()
    tables = frame_tables(file)
    rooms = sorted((t.offset, t.offset + t.stride * t.frames) for name, t in tables.items() if name not in _ROW and t.stride)
    edges = [0, *(edge for room in rooms for edge in room), size]
    with path.open("r+b") as own:
        for low, high in zip(edges[::2], edges[1::2]):
            if high > low:
                os.posix_fallocate(own.fileno(), low, high - low)
    return size


def _write_tables(file: h5py.File, metadata: TrajectoryMetadata, frames: int, dt: float, steps_per_frame: int) -> None:
    header = file.create_group("h5md")
    header.attrs["version"] = np.array([1, 1], dtype=np.int32)
    header.create_group("author").attrs["name"] = "mdanim-lammps"
    header.create_group("creator").attrs.update(name="mdanim-lammps", version=_version())

    particles = file.create_group("particles/all")
    box = particles.create_group("box")
    box.attrs["dimension"] = 3
    box.attrs["boundary"] = np.array(["none"] * 3, dtype="S4")
    for name, array in (
        ("mass", metadata.mass),
        ("id", metadata.id.astype(np.int64)),
        ("species", metadata.layer.astype(np.int8)),
        ("object", metadata.object_of),
        ("held", metadata.held.astype(np.uint8)),
    ):
        _table(particles, name, array)
    particles["mass"].attrs["unit"] = "kg"
    bonds = _table(file.create_group("connectivity"), "bonds", metadata.bond, packed=True)
    bonds.attrs["particles_group"] = particles.ref
    own = file.create_group("parameters/mdanim")
    _write_metadata(own, metadata, dt, steps_per_frame)

    # Written now, so that later writes to them need no room: a full disk leaves all frames before countable.
    step = particles.create_dataset("position/step", data=np.full(frames, NOT_WRITTEN, np.int64))
    time = particles.create_dataset("position/time", data=np.full(frames, np.nan))
    time.attrs["unit"] = "s"
    quantities = list(_quantities(metadata))
    kinds_of_fields = {of.table: of.per for of in metadata.fields if of.table == f"{FIELDS}/{of.name}" and of.per != "object"}
    own.create_dataset(CHECKSUM, data=np.zeros((frames, 1 + len(quantities)), np.uint32))
    for name, above, shape, real, unit in quantities:
        group = file.require_group(f"{above}/{name}")
        value = _room(group, (frames, *shape), real)
        # H5MD's own attribute is `unit`, but MDAnalysis refuses a file whose length unit it does not
        # know, and it knows no metre; so `units` says it everywhere and `unit` where it is understood.
        value.attrs["units"] = unit
        if name in kinds_of_fields:
            value.attrs["per"] = kinds_of_fields[name]
        if unit != "m":
            value.attrs["unit"] = unit
        for key, dataset in ((STEP, step), (TIME, time)):
            if key not in group:
                group[key] = dataset
    for record in metadata.kept.values():
        file.require_group(record.GROUP).attrs.update({key: _attribute(value) for key, value in record.write().items()})


def _room(group: h5py.Group, shape: tuple[int, ...], real: type) -> h5py.Dataset:
    """A dataset "value" of which nothing is written; its place in the file is known at once."""
    import h5py

    create = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    create.set_layout(h5py.h5d.CONTIGUOUS)
    create.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    create.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    create.set_obj_track_times(False)  # the same run makes the same bytes
    kind = h5py.h5t.py_create(np.dtype(real))
    return h5py.Dataset(h5py.h5d.create(group.id, b"value", kind, h5py.h5s.create_simple(shape), create))


def _table(group: h5py.Group, name: str, array: np.ndarray, packed: bool = False) -> h5py.Dataset:
    """A dataset that never changes, with a checksum; ``packed`` shrinks tables of whole numbers."""
    options = {}
    if array.size:
        rows = max(1, min(len(array), _CHUNK_BYTES // (array.nbytes // len(array))))
        options = {"chunks": (rows, *array.shape[1:]), "fletcher32": True}
        if packed:
            options |= {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    return group.create_dataset(name, data=array, **options)


def _write_metadata(group: h5py.Group, metadata: TrajectoryMetadata, dt: float, steps_per_frame: int) -> None:
    group.attrs.update(
        format=FORMAT,
        dt=dt,
        steps_per_frame=steps_per_frame,
        title=_text([metadata.title]),
        total=metadata.total,
        save=_text([metadata.save.value]),
        single=metadata.single,
    )
    for name, array in (
        ("scene", _text([metadata.scene_text])),
        ("name", _text(metadata.names)),
        ("color", _text(metadata.colors)),
        ("still", metadata.still.astype(np.uint8)),
        ("object_mass", metadata.object_mass),
        ("first", metadata.first.astype(np.int64)),
        ("surface_of", metadata.surface_of.astype(np.int64)),
    ):
        _table(group, name, array)
    surfaces = group.create_group("surface")
    shapes = [(len(s.triangle), len(s.index), s.index.shape[1]) for s in metadata.surfaces]
    _table(surfaces, "shape", np.array(shapes, dtype=np.int64).reshape(-1, 3))
    for name in ("triangle", "index", "weight"):
        none = np.zeros(0, np.int32 if name != "weight" else np.float64)
        flat = np.concatenate([none, *(getattr(s, name).ravel() for s in metadata.surfaces)])
        _table(surfaces, name, flat, packed=True)
    for has, (name, _) in OF_SOME.items():
        if some := [getattr(s, name).ravel() for s in metadata.surfaces if getattr(s, name) is not None]:
            _table(surfaces, has, np.array([getattr(s, name) is not None for s in metadata.surfaces], dtype=np.uint8))
            _table(surfaces, name, np.concatenate(some), packed=True)


def read_metadata(file: h5py.File) -> TrajectoryMetadata:
    """Read the data that never change during the run. Raises KeyError, OSError, ValueError for a file that is damaged or newer
    than FORMAT."""
    group, particles = file["parameters/mdanim"], file["particles/all"]
    if group.attrs["format"] > FORMAT:
        raise KeyError(f"format {group.attrs['format']}, newer than {FORMAT}: update mdanim-lammps")
    kept = _read_kept(file)
    return TrajectoryMetadata(
        title=_string(group.attrs["title"]),
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
        surfaces=_read_surfaces(group["surface"]),
        surface_of=group["surface_of"][:],
        kept=kept,
        fields=(*(of for record in kept.values() for of in record.fields()), *_read_fields(file)),
        save=Save(_string(group.attrs["save"])),
        single=bool(group.attrs["single"]),
        scene_text=_texts(group["scene"])[0],
    )


def _read_surfaces(group: Mapping[str, h5py.Dataset]) -> tuple[Surface, ...]:
    flat = {name: group[name][:] for name in ("triangle", "index", "weight")}
    shapes = group["shape"][:]
    counts = np.stack([3 * shapes[:, 0], shapes[:, 1] * shapes[:, 2]], axis=1)
    return tuple(
        Surface(
            triangle=flat["triangle"][t - 3 * triangles : t].reshape(-1, 3),
            index=flat["index"][v - vertices * corners : v].reshape(-1, corners),
            weight=flat["weight"][v - vertices * corners : v].reshape(-1, corners),
            **some,
        )
        for (triangles, vertices, corners), (t, v), some in zip(
            shapes, np.cumsum(counts, axis=0), _of_some(group, shapes[:, 1]), strict=True
        )
    )


def _of_some(group: Mapping[str, h5py.Dataset], vertices: np.ndarray) -> Iterator[dict[str, np.ndarray]]:
    """Tables that only some surfaces have, of each surface in turn, by their names; each has these vertices, shape (K,)."""
    there = {}
    for has, (name, shape) in OF_SOME.items():
        if has in group:
            mine = group[has][:].astype(bool)
            there[name] = mine, np.cumsum(vertices * mine), group[name][:].reshape(-1, *shape)
    for n, count in enumerate(vertices):
        yield {name: values[last[n] - count : last[n]] for name, (mine, last, values) in there.items() if mine[n]}


def _read_kept(file: h5py.File) -> dict[str, KeptRecord]:
    found = {}
    for name, kind in kinds().items():
        if kind.GROUP in file:
            attributes = {key: _plain(value) for key, value in file[kind.GROUP].attrs.items()}
            found[name] = kind.read(attributes, _shapes(file, kind))
    return {name: record for name, record in found.items() if record is not None}


def _shapes(file: h5py.File, kind: type[KeptRecord]) -> dict[str, tuple[int, ...]]:
    """Shapes in one frame of those tables of a kind of records that there are."""
    tables, above = [of.table for of in kind.TABLES], file["observables"]
    return {table: above[f"{table}/value"].shape[1:] for table in tables if table in above}


def _read_fields(file: h5py.File) -> tuple[Field, ...]:
    values = {name: file[f"observables/{FIELDS}/{name}/value"] for name in _names_of_fields(file)}
    counts = {
        "object": len(file["parameters/mdanim"]["name"]),
        "particle": len(file["particles/all/id"]),
        "bond": len(file["connectivity/bonds"]),
    }
    found = []
    for name, value in values.items():
        per, rows, shape = _string(value.attrs.get("per", "object")), value.shape[1], value.shape[2:]
        if per == "pair":
            shape = () if shape == (3,) else (shape[0] - 2,)
        of = Field(name, _string(value.attrs["units"]), per, value.dtype.name, shape, table=f"{FIELDS}/{name}")
        found.append(replace(of, counts=(rows if per == "pair" else counts[per],)))
    return tuple(found)


def _names_of_fields(file: h5py.File) -> list[str]:
    group = file["observables"].get(FIELDS, {})
    if not isinstance(group, Mapping):
        raise KeyError(f"/observables/{FIELDS} is not a group")
    return sorted(group)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("mdanim-lammps")
    except PackageNotFoundError:
        return "source tree"


def _text(lines: Sequence[str]) -> np.ndarray:
    """UTF-8 in fields of fixed width: HDF5 keeps strings of variable length in a heap that has no checksums."""
    encoded = [line.encode() for line in lines]
    return np.array(encoded, dtype=f"S{max([1, *map(len, encoded)])}")


def _texts(dataset: h5py.Dataset) -> tuple[str, ...]:
    return tuple(line.decode() for line in dataset[:])


def _attribute(value: Any) -> Any:
    """Value of a record as an attribute of HDF5."""
    return _text([value]) if isinstance(value, str) else np.array(value) if isinstance(value, tuple) else value


def _plain(value: Any) -> Any:
    """The same back: text, a number, or tuples of numbers."""
    if isinstance(value, str) or (isinstance(value, np.ndarray) and value.dtype.kind in "SO"):
        return _string(value)
    tuples = lambda x: tuple(map(tuples, x)) if isinstance(x, list) else x
    return tuples(value.tolist()) if isinstance(value, np.ndarray | np.generic) else value


def _string(attribute: str | np.ndarray) -> str:
    """Text of an attribute; before format 3 its length was variable."""
    return attribute if isinstance(attribute, str) else attribute[0].decode()


@contextmanager
def _hdf5_errors(path: Path) -> Iterator[None]:
    """Turn the errors of HDF5 too into OutputError; it gives some without a number."""
    with disk_errors(path):
        try:
            yield
        except RuntimeError as error:
            full = "space" in str(error)
            raise OSError(errno.ENOSPC if full else errno.EIO, os.strerror(errno.ENOSPC) if full else str(error)) from error
