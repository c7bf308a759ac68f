# SPDX-License-Identifier: GPL-2.0-only
"""Data that never change during a run: which particle belongs to which object, and which surfaces the particles carry."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..effects.fields import GONE, OF_OBJECTS, Field
from ..effects.kept import KeptRecord, records_of
from ..model.grid import Grid
from ..model.model import Layer, Model, Surface
from ..model.patches import Patches, with_patches
from ..model.tube import Tubes
from ..records import dataclass
from ..scene.scene import Save, SceneRecord
from ..scene.shown import TEXTURES
from .weights import Carry, Weights

FIELDS = "fields"
"""Tables of what effects tell of each object, by name."""


@dataclass(frozen=True)
class TrajectoryMetadata:
    """Objects, particles and surfaces of one trajectory; O objects, N stored particles."""

    title: str
    names: tuple[str, ...]
    """Object names, in particle order."""
    colors: tuple[str, ...]
    """``#rrggbb``, or empty where the renderer chooses."""
    still: np.ndarray
    """Objects that are held as a whole, bool, shape (O,)."""
    object_mass: np.ndarray
    """Mass of each whole object, stored or not [kg], shape (O,)."""
    first: np.ndarray
    """First stored particle of each object, and N at the end, int64, shape (O + 1,)."""
    total: int
    """Particles of the simulation, stored or not."""
    id: np.ndarray
    """1-based tag of each stored particle, as in the LAMMPS data file, int64, shape (N,)."""
    mass: np.ndarray
    """[kg], shape (N,)."""
    layer: np.ndarray
    """``Layer`` of each stored particle, int8, shape (N,)."""
    held: np.ndarray
    """Particles that never move, bool, shape (N,)."""
    bond: np.ndarray
    """Springs between stored particles as pairs of tags (1-based), int32, shape (B, 2)."""
    surfaces: tuple[Surface, ...]
    """Different surfaces; ``index`` counts from an object's first stored particle."""
    surface_of: np.ndarray
    """Which of ``surfaces`` each object has, int64, shape (O,)."""
    kept: Mapping[str, KeptRecord] = field(default_factory=dict)
    """Records of features, by name."""
    fields: tuple[Field, ...] = ()
    """Further values of frames, each with its table, in the order of their checksums."""
    save: Save = Save.ALL
    single: bool = False
    """Positions and velocities in single precision."""
    scene_text: str = ""
    """The expanded scene (``scene.lock.txt``)."""

    @property
    def object_of(self) -> np.ndarray:
        """Object index of each stored particle, int32, shape (N,)."""
        return np.repeat(np.arange(len(self.names), dtype=np.int32), np.diff(self.first))

    @cached_property
    def skin(self) -> Skin:
        """All surfaces as one mesh."""
        return merge_surfaces(self)


@dataclass(frozen=True)
class Skin:
    """The surfaces of all objects as one mesh of V vertices and T triangles."""

    carry: Weights
    """Weights of particles in vertices, shape (V, N)."""
    triangle: np.ndarray
    """Vertex indices, counter-clockwise seen from outside, int32, shape (T, 3)."""
    object_of_triangle: np.ndarray
    """int32, shape (T,)."""
    object_of_vertex: np.ndarray
    """int32, shape (V,)."""
    first: np.ndarray
    """The first vertex of each object, int64, shape (O,)."""
    painted: np.ndarray
    """Vertices that have a colour of their own, bool, shape (V,)."""
    patched: np.ndarray
    """Vertices of objects that may tear, bool, shape (V,)."""
    paint: np.ndarray
    """These colours, uint8 RGB, shape (painted.sum(), 3)."""

    def vertices(self, position: np.ndarray, gone: np.ndarray | None = None) -> np.ndarray:
        """Vertex positions [m], shape (V, 3), for stored particle positions [m], shape (N, 3), and the ends of springs that are
        gone (`ends_gone`)."""
        return self.carry.places(position, gone)

    def boxes(self, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corners of the boxes around objects [m], each of shape (O, 3), by `vertices`."""
        return np.minimum.reduceat(vertices, self.first), np.maximum.reduceat(vertices, self.first)


def springs_gone(metadata: TrajectoryMetadata, value: Callable[[str], np.ndarray]) -> np.ndarray | None:
    """Which stored springs are gone in a frame, bool, shape (B,); None where none may be. ``value`` reads a table of it."""
    of = next((field for field in metadata.fields if field.name == GONE and field.per == "bond" and not field.shape), None)
    return None if of is None else np.asarray(value(of.table)) > 0.0


def ends_gone(metadata: TrajectoryMetadata, value: Callable[[str], np.ndarray]) -> np.ndarray | None:
    """Ends of the springs that are gone in a frame, as numbers of stored particles, int64, shape (G, 2); None where none may be.
    ``value`` reads a table of the frame by its name."""
    gone = springs_gone(metadata, value)
    return None if gone is None else np.searchsorted(metadata.id, metadata.bond[gone]).reshape(-1, 2)


def stored_particles(model: Model, save: Save) -> np.ndarray:
    """Particles of one object that the trajectory holds, bool, shape (N,).

    With ``save boundary`` these are the boundary particles and all others that carry the surface.
    """
    if save is Save.ALL:
        return np.ones(len(model.position), dtype=bool)
    stored = np.asarray(model.layer) >= Layer.BOUNDARY
    surface = _surface_of(model)
    stored[surface.index[surface.weight != 0.0]] = True
    return stored


def metadata_of(
    scene: SceneRecord, models: Sequence[Model], scene_text: str = "", grid: Grid | None = None, fields: Iterable[Field] = ()
) -> TrajectoryMetadata:
    """Collect what a trajectory of these models must know; objects in the order of ``models``.

    Args:
        scene: for title, colours, ``control save``, and what its features keep.
        models: one per solid, named like the solids.
        scene_text: the expanded scene, kept so that pictures need nothing but the trajectory.
        grid: cells of the scene's liquid; None where there is none, or where it is switched off.
        fields: what effects tell of a frame; those of things that objects have are stored, besides those of features.
    """
    solids = {solid.name: solid for solid in scene.solids}
    named, records = [solids[model.name] for model in models], records_of(scene, grid)
    stored = [stored_particles(model, scene.control.save) for model in models]
    offsets = np.cumsum([0] + [len(model.position) for model in models])
    surfaces, surface_of = distinct_surfaces(models, stored)
    bonds = [m.spring[stored_springs(m, kept)] + (o + 1) for m, kept, o in zip(models, stored, offsets)]
    everywhere = _joined(stored, bool)
    return TrajectoryMetadata(
        title=scene.title,
        names=tuple(model.name for model in models),
        colors=tuple(solid.color or (TEXTURES[solid.texture.pattern] if solid.texture else "") for solid in named),
        still=np.array([model.still for model in models], dtype=bool),
        object_mass=np.array([model.mass.sum() for model in models], dtype=np.float64),
        first=np.cumsum([0] + [int(kept.sum()) for kept in stored]),
        total=int(offsets[-1]),
        id=np.flatnonzero(everywhere) + 1,
        mass=_joined([m.mass for m in models], np.float64)[everywhere],
        layer=_joined([m.layer for m in models], np.int8)[everywhere],
        held=_joined([m.held for m in models], bool)[everywhere],
        bond=np.concatenate([np.zeros((0, 2), np.int32), *bonds]).astype(np.int32),
        surfaces=surfaces,
        surface_of=surface_of,
        kept=records,
        fields=kept_fields(records, fields, models, scene.control.save),
        save=scene.control.save,
        single=scene.control.single,
        scene_text=scene_text,
    )


def stored_springs(model: Model, stored: np.ndarray) -> np.ndarray:
    """Springs of one object that the trajectory holds, those between `stored_particles`, bool, shape (S,)."""
    return stored[model.spring].all(axis=1)


def kept_fields(
    records: Mapping[str, KeptRecord], fields: Iterable[Field], models: Sequence[Model], save: Save
) -> tuple[Field, ...]:
    """Fields that frames of a trajectory have: those of the records of features, and those per object, pair of objects, stored
    particle or stored spring, by name."""
    told = sorted((of for of in fields if of.per in OF_OBJECTS), key=lambda of: of.name)
    counts = {"object": len(models)}
    if any(of.per in ("particle", "bond") for of in told):
        stored = [stored_particles(model, save) for model in models]
        counts["particle"] = sum(int(kept.sum()) for kept in stored)
        counts["bond"] = sum(int(stored_springs(model, kept).sum()) for model, kept in zip(models, stored))
    tables = (
        replace(of, table=f"{FIELDS}/{of.name}", counts=of.counts if of.per == "pair" else (counts[of.per],)) for of in told
    )
    return (*(of for record in records.values() for of in record.fields()), *tables)


def distinct_surfaces(models: Sequence[Model], stored: Sequence[np.ndarray]) -> tuple[tuple[Surface, ...], np.ndarray]:
    """The different surfaces among the models, in stored particles, and which of them each model has."""
    kinds: dict[bytes, int] = {}
    surfaces: list[Surface] = []
    used = []
    for model, kept in zip(models, stored):
        surface = _within(_surface_of(model), kept)
        kind = kinds.setdefault(_fingerprint(surface), len(surfaces))
        if kind == len(surfaces):
            surfaces.append(surface)
        used.append(kind)
    return tuple(surfaces), np.array(used, dtype=np.int64)


def merge_surfaces(metadata: TrajectoryMetadata) -> Skin:
    """Put the surfaces of all objects into one mesh; done once, so that a frame is one matrix product."""
    used = [metadata.surfaces[kind] for kind in metadata.surface_of]
    vertices = np.array([len(surface.index) for surface in used], dtype=np.int64)
    triangles = np.array([len(surface.triangle) for surface in used], dtype=np.int64)
    weight = _joined([surface.weight.ravel() for surface in used], np.float64)
    particle = _joined([surface.index.ravel() + first for surface, first in zip(used, metadata.first)], np.int64)
    corners = np.repeat(np.array([surface.index.shape[1] for surface in used], np.int64), vertices)
    first_vertex = np.cumsum(vertices) - vertices
    vertex = np.repeat(np.arange(len(corners)), corners)
    kept = weight != 0.0
    kept[np.cumsum(corners) - corners] = True  # a vertex hangs on one particle at least
    objects = np.arange(len(used), dtype=np.int32)
    triangle = [surface.triangle + first for surface, first in zip(used, first_vertex)]
    return Skin(
        carry=_carry(Weights.of(vertex[kept], particle[kept], weight[kept]), used, metadata.first, first_vertex),
        triangle=np.concatenate([np.zeros((0, 3), np.int32), *triangle]).astype(np.int32),
        object_of_triangle=np.repeat(objects, triangles),
        object_of_vertex=np.repeat(objects, vertices),
        first=first_vertex,
        painted=np.repeat([surface.color is not None for surface in used], vertices).astype(bool),
        patched=np.repeat([surface.patch is not None for surface in used], vertices).astype(bool),
        paint=np.concatenate([np.zeros((0, 3), np.uint8), *(s.color for s in used if s.color is not None)]),
    )


def _carry(carry: Weights, used: Sequence[Surface], first: np.ndarray, first_vertex: np.ndarray) -> Weights:
    """The same weights with what stands around lines of particles, and patches of what may tear, where there are any."""
    lines = [n for n, surface in enumerate(used) if surface.tube is not None]
    patched = [n for n, surface in enumerate(used) if surface.patch is not None]
    if not lines and not patched:
        return carry
    particles = [slice(int(a), int(b)) for a, b in pairwise(first)]
    chains = [(particles[n], np.asarray(used[n].tube)) for n in lines]
    around, row = np.full(len(carry), -1, np.int64), 0
    for n, (_, vertex) in zip(lines, chains):
        around[first_vertex[n] : first_vertex[n] + len(vertex)] = np.arange(row, row + len(vertex))
        row += len(vertex)
    patches = Patches([(particles[n], int(first_vertex[n]), used[n]) for n in patched])
    rows = np.arange(len(carry))
    return Carry(carry.weight, carry.index, carry.first, Tubes(chains), around, patches, rows, len(rows))


def _within(surface: Surface, kept: np.ndarray) -> Surface:
    """The surface with particles counted among the kept ones; corners without weight name particle 0."""
    rank = np.cumsum(kept) - 1
    index = np.where(surface.weight != 0.0, rank[surface.index], 0)
    return Surface(
        triangle=np.ascontiguousarray(surface.triangle, dtype=np.int32),
        index=index.astype(np.int32),
        weight=np.ascontiguousarray(surface.weight, dtype=np.float64),
        color=surface.color,
        tube=surface.tube,
        patch=surface.patch,
    )


def _surface_of(model: Model) -> Surface:
    return with_patches(model) if model.tears else model.surface


def _fingerprint(surface: Surface) -> bytes:
    import hashlib

    digest = hashlib.blake2b(digest_size=16)
    more = [np.ascontiguousarray(array) for array in (surface.color, surface.tube, surface.patch) if array is not None]
    for array in (surface.triangle, surface.index, surface.weight, *more):
        digest.update(str(array.shape).encode())
        digest.update(array)
    return digest.digest()


def _joined(arrays, dtype) -> np.ndarray:
    """The arrays end to end; also right when there are none."""
    return np.concatenate([np.zeros(0, dtype), *arrays]).astype(dtype, copy=False)
