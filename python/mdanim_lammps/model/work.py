# SPDX-License-Identifier: GPL-2.0-only
"""Processor time and memory that it takes to model a scene, before it is done. `bench/modelling.py forecast` compares."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..bodies import kind_of
from ..features import facets
from ..scene.scene import Box, Mesh, PieceShape, SceneRecord, Shape
from . import shapes
from .contact_body import DENSITY
from .limits import bounding_cells
from .spread import SAMPLES

VERTEX_BYTES, POINT_BYTES, SAMPLE_BYTES = 200.0, 300.0, 250.0
"""Memory [bytes]: of a vertex of the drawn surface; of a point of contact; of a sample of a mesh, of which points are chosen.
That of a particle is the kind of body's."""
VERTEX_TIME, POINT_TIME, CELL_TIME = 2.4e-6, 1.1e-6, 0.5e-6
"""Processor time [s] of each of them, and of a cell of the bounding box, as `bench/modelling.py forecast` has it."""
MESH_POINT_TIME, MESH_CELL_TIME, MESH_TIME = 18e-6, 5e-6, 0.18
"""The same of meshes, whose points are found among samples, and distances among triangles; and what any mesh takes."""


def memory(scene: SceneRecord, h: float | Sequence[float], particles: Sequence[int]) -> float:
    """Memory [bytes] of so many particles of each solid, at a spacing of h [m], one for all or one for each solid; equal
    objects share surfaces and points of contact."""
    own = sum(kind_of(s).particle_bytes * n for s, n in zip(scene.solids, particles))
    return own + sum(_bytes(shape, own, _touches(scene)) for shape, own in _bodies(scene, h))


def seconds(scene: SceneRecord, h: float | Sequence[float], particles: Sequence[int]) -> float:
    """Processor time [s] of models and time step, with the same arguments."""
    own = sum(kind_of(s).particle_seconds * n for s, n in zip(scene.solids, particles))
    return own + sum(_seconds(shape, own, _touches(scene)) for shape, own in _bodies(scene, h))


def _bodies(scene: SceneRecord, h: float | Sequence[float]) -> set[tuple[Shape, float]]:
    rows = zip(scene.solids, np.broadcast_to(h, len(scene.solids)).tolist())
    return {(s.shape, own) for s, own in rows if (kind := kind_of(s)).fills and not kind.bare(scene, s)}


def _touches(scene: SceneRecord) -> bool:
    """Whether there is something that an object can touch with points of its surface."""
    words = list(facets("words"))
    others = len(scene.solids) > 1 or any(w.touched(scene) for w in words if hasattr(w, "touched"))
    return others and any(w.points(scene) for w in words if hasattr(w, "points"))


def _bytes(shape: Shape, h: float, touches: bool) -> float:
    if isinstance(shape, Box | PieceShape):
        return 0.0
    samples = SAMPLES * _points(shape, h) if isinstance(shape, Mesh) else 0.0
    return VERTEX_BYTES * shapes.vertices(shape, h) + touches * (POINT_BYTES * _points(shape, h) + SAMPLE_BYTES * samples)


def _seconds(shape: Shape, h: float, touches: bool) -> float:
    if isinstance(shape, Box | PieceShape):
        return 0.0
    cells, points, mesh = bounding_cells(shape, h), _points(shape, h), isinstance(shape, Mesh)
    if mesh:
        return MESH_TIME + CELL_TIME * cells + touches * (MESH_POINT_TIME * points + MESH_CELL_TIME * cells)
    return VERTEX_TIME * shapes.vertices(shape, h) + CELL_TIME * cells + touches * POINT_TIME * points


def _points(shape: Shape, h: float) -> float:
    return DENSITY**2 * shapes.area(shape) / h**2
