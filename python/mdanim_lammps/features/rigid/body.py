# SPDX-License-Identifier: GPL-2.0-only
"""A rigid body: few particles without springs, which show where it is, and the moments of inertia of its shape."""

from __future__ import annotations

import math
from dataclasses import replace

from ...bodies import BodyKind, all_held, beneath, kind_of, unguided
from ...model import shapes
from ...model.added import tensor_of
from ...model.build import lattice_model, single_cell_model
from ...model.cells import fill_cells
from ...model.contact_body import BodyFrame
from ...model.held import free_model
from ...model.largest import largest
from ...model.polyhedron import polyhedron
from ...scene.once import once_for
from ...scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Sphere, Torus
from .shapes import hidden, is_known, is_rigid, on_objects, on_planes, only_balls_move

DISPLACED = 0.9
"""Part of the volume of the rigid objects in a scene with a liquid that those have whose thinnest parts set its cells."""
ACROSS, ROUND = 2, 4
"""Cells across its thinnest part: the least that have an inside; and of what is round there, or touches others at points of its
surface, a third of a cell apart: a torus of 2 rolls so down a slope with 0.96 of its acceleration, one of 4 with 0.995."""
OF_CORNERS = (Cone, Cylinder, Ellipsoid, Torus, Mesh)
"""Shapes whose particles are the corners of a box around the drawn surface."""


class RigidBody(BodyKind):
    """An object with ``elasticity rigid``. Its particles are points of the body: corners of a box around it, or a lattice of
    hexahedra without springs where something reads its inside or points of its surface."""

    name = "rigid"
    order = 100
    deforms = sets_spacing = False
    particle_bytes = 500.0

    def takes(self, solid):
        return is_rigid(solid) and not all_held(solid)

    def cells(self, scene, solid):
        if scene.liquid is not None:
            return super().cells(scene, solid)
        return _across(solid)

    def asks(self, scene):
        """Objects that displace most of a liquid have one, where nothing else moves in it. Its cells are not those of its
        banks."""
        others = any(s.resolution is None and not all_held(s) and kind_of(s).sets_spacing for s in scene.solids)
        if scene.liquid is None or others:
            return lambda solid: False
        large = displacing(scene)
        return lambda solid: solid.name in large

    def spacing(self, scene, h):
        """Two cells across, four of what is round or has no known features; no coarser than the scene where there is a liquid or
        something soft, whose forces find the body at its particles and at points as far apart as these. A cuboid in a liquid may
        have one."""
        soft = any(is_soft(s) and not is_line(s) for s in scene.solids)
        finest = h if scene.liquid is not None or soft else math.inf
        usual = lambda s: 1 if scene.liquid is not None and isinstance(s.shape, Box) else _across(s)
        across = lambda s: max(usual(s), beneath(scene, s) if isinstance(s.shape, Sphere) else 0)
        return lambda s: finest if _may_be_thin(scene, s) else min(finest, shapes.thickness(s.shape) / across(s))

    def least(self, scene, solid):
        return 0.0 if _may_be_thin(scene, solid) else super().least(scene, solid)

    def has_spacing(self, scene):
        return not by_features(scene)

    def particles(self, scene, solid, lattice, h):
        return 8 if is_cornered(scene, solid.shape) else lattice

    def bare(self, scene, solid):
        """A mesh that others touch by its features, or that planes alone touch, by its hull."""
        alone = len(scene.solids) == 1 and scene.liquid is None
        return isinstance(solid.shape, Mesh) and (by_features(scene) or (alone and on_planes(solid.shape)))

    def make(self, solid, h, shared):
        boxed = isinstance(solid.shape, Box | Sphere)  # the box around them has their middle
        if boxed and shared.by_features:
            model = single_cell_model(solid, h, shared)
        elif boxed and lines_alone(shared.scene):
            model = single_cell_model(solid, h, shared)
            model = replace(model, frame=shared.once(_framed, solid.shape, h))
        elif is_cornered(shared.scene, solid.shape):
            model = free_model(solid, h, shared, hollow=is_hollow(solid.shape), bare=self.bare(shared.scene, solid))
        else:
            model = lattice_model(solid, h, shared, loose=True)
        return replace(model, inertia=tensor_of(solid))


def displacing(scene) -> set[str]:
    """Names of the rigid objects without a spacing of their own, from the largest on until they have `DISPLACED` of the volume of
    all of them: a mast or a sail on a hull has no part in it."""
    asked = [s for s in scene.solids if s.resolution is None and isinstance(kind_of(s), RigidBody)]
    return {asked[k].name for k in largest([s.shape for s in asked], DISPLACED)}


def is_hollow(shape) -> bool:
    """Whether the middle of the box around a shape may be outside of it, as in the hole of a torus: an object there is not one
    inside the other (engine.geometry.Geometry.sunk)."""
    return isinstance(shape, Torus) or (isinstance(shape, Mesh) and polyhedron(shape) is None)


def _framed(shared, shape, h: float) -> BodyFrame:
    """The frame of a cuboid or a ball whose particles are the corners of the box around it, with cells of h [m]."""
    corner, cells = shared.body(shape, math.inf).lattice.position, fill_cells(shape, h)
    return BodyFrame(shape, cells, rigid=True, corners=(corner - cells.low) / cells.edge)


def _may_be_thin(scene, solid) -> bool:
    """Whether an object may be thinner than its spacing: a cuboid where a liquid alone reads its cells, one across, which it
    fills."""
    return isinstance(solid.shape, Box) and scene.liquid is not None and _features_alone(scene)


def _across(solid) -> int:
    shape = solid.shape
    is_disc = isinstance(shape, Cylinder) and shape.height <= shape.radius  # two across its height are four around
    return ACROSS if is_disc or (isinstance(shape, Box | Sphere | Mesh) and on_objects(shape)) else ROUND


def is_cornered(scene, shape) -> bool:
    """Whether the corners of a box around a shape are all its particles. Of a mesh they are where no liquid reads its cells:
    points of its surface are found by these corners, too."""
    return by_features(scene) or (isinstance(shape, Mesh) and scene.liquid is None)


@once_for(lambda scene: scene)
def by_features(scene) -> bool:
    """Whether rigid objects move, and all contacts are of shapes that know each other by their features, so that nothing reads
    points of their surfaces, nor particles inside. Beside held cuboids that cover sides of each other in part, balls alone touch
    by features; what an effect moves without telling where it is (reach.Motion.guides) is found at points."""
    return scene.liquid is None and not any(map(is_line, scene.solids)) and _features_alone(scene)


def lines_alone(scene) -> bool:
    """The same but for lines of particles that there are: these find places in a rigid object by four of its particles."""
    return scene.liquid is None and any(map(is_line, scene.solids)) and _features_alone(scene)


def is_line(solid) -> bool:
    """Whether an object is a line of particles that moves."""
    return is_soft(solid) and not kind_of(solid).fills


@once_for(lambda scene: scene)
def _features_alone(scene) -> bool:
    """Whether rigid objects move, and they and all that is held touch by their features."""
    solids = [s for s in scene.solids if kind_of(s).fills]
    if all(map(all_held, solids)) or any(map(is_soft, solids)) or unguided(scene):
        return False
    if not all(map(is_known, solids)):
        return False
    return only_balls_move(solids) or hidden(scene) is not None


def is_soft(solid) -> bool:
    """Whether an object moves and deforms."""
    return kind_of(solid).deforms and not all_held(solid)


KINDS = (RigidBody(),)
