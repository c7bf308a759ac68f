# SPDX-License-Identifier: GPL-2.0-only
"""Checks of an output folder that comes from elsewhere: it can neither reach other files nor need more memory than it has
(docs/security.md)."""

from __future__ import annotations

import math
import os
import re
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import OutputError
from ..processes import available_memory

FARTHEST = 1e30
"""From the origin [m]: sums and single precision, in which pictures are drawn, hold what is nearer."""

if TYPE_CHECKING:
    import h5py

    from .trajectory_file import FrameTable
    from .trajectory_metadata import TrajectoryMetadata


BY_FRAME = ("particles/all/position/value", "particles/all/velocity/value", "observables/")
"""Tables of an HDF5 file of which one frame is read at a time, but for those of AT_ONCE."""
AT_ONCE = ("observables/center_of_mass/", "observables/center_of_mass_velocity/")


def check_folder(folder: Path) -> None:
    """Refuse a folder with a link, a pipe or a device anywhere in it: it could lead a command to other files, or never end.

    Raises OutputError.
    """
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            check_plain(Path(place, name))


def check_plain(path: Path) -> None:
    """Refuse a path of an output folder that is a link, a pipe or a device. Raises OutputError."""
    try:
        mode = os.lstat(path).st_mode
    except FileNotFoundError:  # or a run that is going on has renamed it
        return
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        what = "a link" if stat.S_ISLNK(mode) else "a pipe, a socket or a device"
        raise OutputError(f"{path} is {what}, which no run writes; remove it, or put a file in its place")


def check_room(needed: float, what: object) -> None:
    """Raises OutputError where data would take more than half of the free memory; ``needed`` in bytes."""
    if needed > 0.5 * available_memory():
        raise OutputError(
            f"{what}: would take {needed * 1e-9:.3g} GB of memory, which is not free; it is damaged, or needs a larger host"
        )


def check_hdf5(path: Path, file: h5py.File) -> None:
    """Refuse data that lie outside of the file, and tables that do not fit in memory. Raises OutputError."""
    import h5py

    needed = 0.0

    # A visitor that HDF5 calls. It must not raise; a value that it returns ends the visit.
    def foreign_link(name: str, link) -> str | None:
        return f"{name} leads to another file, {link.filename}" if isinstance(link, h5py.ExternalLink) else None

    def foreign_data(name: str, found) -> str | None:
        nonlocal needed
        if isinstance(found, h5py.Dataset):
            if found.external or found.is_virtual:
                return f"the data of {name} lie in another file"
            row = found.dtype.itemsize * float(np.prod(found.shape[1:], dtype=np.float64))
            # Quantities of frames are read one frame at a time, all other tables at once.
            by_frame = name.startswith(BY_FRAME) and not name.startswith(AT_ONCE)
            needed += row * (1 if by_frame or not found.shape else len(found))
        return None

    if foreign := file.visititems_links(foreign_link) or file.visititems(foreign_data):
        raise OutputError(f"{path}: {foreign}; no run writes that")
    check_room(needed, path)


def check_metadata(path: Path, m: TrajectoryMetadata) -> None:
    """Refuse numbers that name what is not there: they would be read beyond the ends of arrays. Raises OutputError."""
    count, particles = len(m.names), len(m.id)

    def must(holds, what: str) -> None:
        if not holds:
            raise OutputError(f"{path}: damaged: {what}")

    must(count > 0 or bool(m.kept), "it holds no object and no liquid")
    must(len(set(m.names)) == count, "two objects have one name")
    must(all(name and name.isprintable() for name in m.names), "a name of an object cannot be printed")
    must(all(re.fullmatch("(#[0-9a-fA-F]{6})?", color) for color in m.colors), "a colour is not written as #rrggbb")
    for kinds, names in (("iu", ("first", "id", "layer", "bond", "surface_of")), ("f", ("mass", "object_mass"))):
        for name in names:
            must(getattr(m, name).dtype.kind in kinds, f"{name} holds {getattr(m, name).dtype}")
    for field in m.fields:
        must(np.dtype(field.dtype).kind in "fiu", f"{field.name} holds {field.dtype}")
    for surface in m.surfaces:
        must(surface.index.ndim == 2 and surface.weight.shape == surface.index.shape, "a surface lacks weights")
        for kinds, array in (("iu", surface.triangle), ("iu", surface.index), ("f", surface.weight)):
            must(array.dtype.kind in kinds, f"a surface holds {array.dtype}")
    for name, shape in (
        ("colors", (count,)),
        ("still", (count,)),
        ("object_mass", (count,)),
        ("surface_of", (count,)),
        ("first", (count + 1,)),
        ("mass", (particles,)),
        ("layer", (particles,)),
        ("held", (particles,)),
        ("id", (particles,)),
        ("bond", (len(m.bond), 2)),
    ):
        must(np.shape(getattr(m, name)) == shape, f"{name} has the shape {np.shape(getattr(m, name))}, not {shape}")
    sizes = np.diff(m.first)
    must(m.first[0] == 0 and m.first[-1] == particles and (sizes > 0).all(), "objects do not share out the particles")
    must(
        particles == 0 or (m.id[0] >= 1 and (np.diff(m.id) > 0).all() and m.id[-1] <= m.total), "tags of particles do not ascend"
    )
    must(np.isin(m.bond, m.id).all(), "a spring joins a particle that is not stored")
    must(((m.surface_of >= 0) & (m.surface_of < len(m.surfaces))).all(), "an object has a surface that is not there")
    fewest = np.full(len(m.surfaces), np.iinfo(np.int64).max)
    np.minimum.at(fewest, m.surface_of, sizes)
    for surface, size in zip(m.surfaces, fewest):
        vertices = len(surface.index)
        must(((surface.index >= 0) & (surface.index < size)).all(), "a surface has a particle that its object does not have")
        must(((surface.triangle >= 0) & (surface.triangle < vertices)).all(), "a triangle has a vertex that is not there")
        must(np.isfinite(surface.weight).all(), "a weight of a surface is NaN or infinite")
        color = surface.color
        must(color is None or (color.shape == (vertices, 3) and color.dtype == np.uint8), "a vertex has no colour")
        if (patch := surface.patch) is not None:
            must(patch.shape == (vertices,) and patch.dtype.kind == "i", "a surface lacks patches")
            must(vertices > 0 and patch.min() >= -1 and patch.max() < vertices, "a surface has a patch that is not there")
        if (tube := surface.tube) is not None:
            must(size > 1 and tube.shape == (vertices, 4) and tube.dtype.kind == "f", "a tube lacks vertices")
            must(np.isfinite(tube).all() and ((tube[:, 0] >= 0) & (tube[:, 0] <= size - 1)).all(), "a tube is beyond its line")
    for mass in (m.object_mass, m.mass):
        must((np.isfinite(mass) & (mass > 0.0)).all(), "a mass is not above 0, NaN or infinite")
    for record in m.kept.values():
        must(not (fault := record.fault()), fault)
    check_room(8.0 * m.total, path)


def check_steps(path: Path, dt: float, steps_per_frame: int) -> None:
    """Refuse a time step [s] and steps of a frame that are not those of a run. Raises OutputError."""
    if not (0.0 < dt < math.inf and 1 <= steps_per_frame <= 2**53):
        raise OutputError(f"{path}: damaged: it declares {steps_per_frame} steps of {dt} s in a frame")


def check_places(path: Path, *places: np.ndarray, frame: int | None = None) -> None:
    """Refuse places [m] of a frame, or of all, that are nowhere. Raises OutputError."""
    if not all((np.abs(some) < FARTHEST).all() for some in places):
        which = "" if frame is None else f"frame {frame} is "
        raise OutputError(f"{path}: {which}damaged: positions are NaN, infinite or beyond {FARTHEST:g} m")


def check_frames(
    path: Path, shapes: Mapping[str, tuple[int, ...]], tables: Mapping[str, FrameTable], steps: np.ndarray, times: np.ndarray
) -> None:
    """Refuse quantities of another shape than the metadata say, and times that do not ascend. Raises OutputError.

    Args:
        path: for the message.
        shapes: of one frame of each quantity.
        tables: where the quantities are.
        steps, times: of the frames that are whole, shape (F,).
    """
    for name, shape in shapes.items():
        found = tables[name]
        if found.shape != shape or found.frames < len(steps):
            raise OutputError(f"{path}: damaged: {name} has frames of the shape {found.shape}, not {shape}, or too few")
        if found.dtype.kind not in ("fiu" if name.startswith("fields/") else "f"):
            raise OutputError(f"{path}: damaged: {name} holds {found.dtype}")
    if (np.diff(steps) <= 0).any() or not np.isfinite(times).all() or (np.diff(times) <= 0.0).any():
        raise OutputError(f"{path}: damaged: the times of its frames do not ascend")
