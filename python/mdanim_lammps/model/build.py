# SPDX-License-Identifier: GPL-2.0-only
"""From a scene to its models (Wcislo 1999, sec. 5.2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache, singledispatch
from typing import Any

import numpy as np

from ..bodies import kind_of, lets_go, only_features
from ..errors import Problem, SceneError
from ..records import dataclass
from ..scene.formatting import number, say
from ..scene.scene import Elasticity, HoldAll, HoldFaces, HoldWithin, Mesh, SceneRecord, Shape, Solid
from . import mesh, shapes
from .added import weighed
from .cells import TooThin, fill_cells
from .contact_body import BodyFrame
from .cover import with_covers
from .embed import make_surface
from .held import corner_model, one_cell_as
from .lattice import Lattice, make_lattice
from .limits import bounding_cells
from .masses import Fit, fit_masses
from .mesh import MeshError
from .mesh_parts import pieces
from .model import Model, Surface
from .spacing import plan_spacing
from .springs import equivalent_modulus, reduced_mass, rest_lengths, stiffness, types


def build_models(
    scene: SceneRecord, h: float | Sequence[float] | None = None, driven: Container[int] = (), inside: bool = False
) -> tuple[Model, ...]:
    """Make the model of every solid, in the order of the scene, with a particle spacing h [m], one for all or one for each; None
    is that of the scene.

    ``driven`` are the numbers of those whose held particles some effect moves; ``inside`` asks for particles inside of those that
    never move. Objects of equal shape, elasticity and mass share
    their arrays of springs, masses, layers, surface and contact body, which are read-only; positions, velocities and held are
    their own.

    Raises SceneError with all problems of all solids in one pass: those of plan_spacing, a body that falls
    apart at this spacing, a ``hold`` without particles.
    """
    spacing = np.broadcast_to(plan_spacing(scene).of if h is None else h, len(scene.solids)).tolist()
    shared = SharedParts(scene, inside)
    models, problems = [], []
    for m, solid in enumerate(scene.solids):
        try:
            model = weighed(kind_of(solid).make(solid, spacing[m], shared), solid)
            if lets_go(solid):
                model = _let_go(model)
            models.append(replace(model, driven=True) if m in driven else model)
        except TooThin as error:
            problems.append(_too_thin(solid, spacing[m], error))
        except MeshError as error:
            problems.append(Problem(solid.spans.get("shape"), f"{solid.name}: {error}", error.hint))
        except NothingHeld as error:
            problems.append(Problem(solid.spans.get("hold"), f"{solid.name}: {error}", error.hint))
    if problems:
        raise SceneError(problems)
    return with_covers(models, scene.solids)


def _let_go(model: Model) -> Model:
    """The same of an object that is held at first: all of one that does not deform."""
    pinned = model.held if model.held.any() else np.ones_like(model.held)
    return replace(model, held=np.zeros_like(pinned), pinned=pinned, velocity=np.where(pinned[:, None], 0.0, model.velocity))


# --- what equal objects share -------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Body:
    """A lattice, its surface, and what its contact body is made from; body frame."""

    lattice: Lattice
    surface: Surface
    frame: BodyFrame

    @cached_property
    def fit(self) -> Fit:
        """Factors of masses; made when they are first asked for."""
        return fit_masses(self.lattice, shapes.second_moments(self.frame.shape))


@dataclass(frozen=True, slots=True, eq=False)
class _Material:
    """Masses and springs of a body of one material."""

    mass: np.ndarray
    spring: np.ndarray
    spring_type: np.ndarray
    constants: np.ndarray
    young: float


class SharedParts:
    """Makes every body and material of one scene once; lives as long as one call of build_models (bodies.Shared)."""

    def __init__(self, scene: SceneRecord, inside: bool = False):
        self.scene, self.inside = scene, inside
        self._made: dict[tuple, Any] = {}
        self.body = lru_cache(maxsize=None)(_make_body)
        self.material = lru_cache(maxsize=None)(_make_material)

    def once(self, make: Callable, *of):
        """make(self, *of), made when it is first asked for."""
        key = (make, *of)
        if key not in self._made:
            self._made[key] = make(self, *of)
        return self._made[key]

    @cached_property
    def by_features(self) -> bool:
        """Whether nothing reads points of surfaces, nor particles inside (bodies.only_features)."""
        return only_features(self.scene)


def _make_body(shape: Shape, h: float, loose: bool = False) -> _Body:
    lattice = make_lattice(fill_cells(shape, h, loose), tied=not loose and h < math.inf)  # springs are of what deforms
    surface = make_surface(shape, lattice)
    _freeze(lattice.position, lattice.share, lattice.layer, lattice.spring, lattice.hexahedron)
    _freeze(surface.triangle, surface.index, surface.weight)
    return _Body(lattice, surface, BodyFrame(shape, lattice.cells))


def _make_material(body: _Body, mass: float, elasticity: Elasticity, loose: bool) -> _Material:
    """Masses fitted to the moments of the shape, and springs; ``loose``: masses by shares, and no springs."""
    lattice = body.lattice
    even = lattice.share * (mass / lattice.share.sum())
    m = even if loose else even * body.fit.weight
    m *= mass / m.sum()
    edge = lattice.cells.edge
    k = np.zeros(len(lattice.spring)) if loose else stiffness(lattice, elasticity)
    spring, kind = lattice.spring, lattice.kind
    if not k.all():  # the paper's literal springs have no braces
        keep = k > 0
        spring, kind, k = spring[keep], kind[keep], k[keep]
    # Masses by shares are of few kinds.
    rest = rest_lengths(edge)[kind]
    spring_type, constants = types(np.stack([k, rest, reduced_mass(even, spring)], axis=1))
    constants = constants[:, [0, 1, 2, 1]]
    _freeze(m, spring_type, constants)
    return _Material(m, spring, spring_type, constants, equivalent_modulus(edge, elasticity))


def _freeze(*arrays: np.ndarray) -> None:
    for array in arrays:
        array.setflags(write=False)


# --- one object ---------------------------------------------------------------------------------------------


def single_cell_model(solid: Solid, h: float, shared: SharedParts) -> Model:
    """The model of a cuboid or a ball that does not deform and whose contact is found elsewhere: eight particles at the corners
    of the box around it, which say where it is. It counts as resolved with h [m]."""
    body = shared.body(solid.shape, math.inf)
    cell = one_cell_as(body.lattice.cells.edge, h)
    arm, mass = _rotated(solid, body.lattice.position), np.full(8, shapes.mass(solid) / 8.0)
    return corner_model(solid, cell, arm, mass, body.surface, body.frame, free=body.lattice.hexahedron)


def lattice_model(solid: Solid, h: float, shared: SharedParts, *, loose: bool = False) -> Model:
    """The model of a lattice of hexahedra with a particle spacing h [m]. A body that is all held never turns, and has no springs;
    nor has a ``loose`` one, whose particles something else keeps together.

    Raises cells.TooThin, mesh.MeshError, NothingHeld.
    """
    body = shared.body(solid.shape, h, loose)
    lattice = body.lattice
    held = _held(solid, lattice)
    mass = shapes.mass(solid)
    loose = loose or bool(held.all() and not lets_go(solid))
    material = shared.material(body, mass, solid.elasticity, loose)
    arm = _rotated(solid, lattice.position)
    velocity = solid.velocity + np.cross(solid.spin, arm)
    velocity[held] = 0.0
    return Model(
        name=solid.name,
        position=arm + solid.position,
        velocity=velocity,
        mass=material.mass,
        share=lattice.share,
        layer=lattice.layer,
        held=held,
        spring=material.spring,
        spring_type=material.spring_type,
        constants=material.constants,
        young=material.young,
        inertia_error=0.0 if loose else body.fit.error,
        hexahedron=lattice.hexahedron,
        cell=tuple(lattice.cells.edge.tolist()),
        surface=body.surface,
        frame=body.frame,
    )


def _rotated(solid: Solid, points: np.ndarray) -> np.ndarray:
    """Body-frame points [m], shape (N, 3), as arms from the centre of mass in the world frame."""
    return points @ np.array(solid.rotation).T


class NothingHeld(Exception):
    """A ``hold`` without particles."""

    def __init__(self, message: str, hint: str):
        super().__init__(message)
        self.hint = hint


def _held(solid: Solid, lattice: Lattice) -> np.ndarray:
    """Particles in any ``hold`` of the solid, bool, shape (N,); raise where a ``hold`` has none."""
    held = np.zeros(len(lattice.position), bool)
    for hold in solid.hold:
        caught = _caught(hold, solid, lattice)
        if not caught.any():
            raise NothingHeld(*_missed(hold, solid, lattice))
        held |= caught
    return held


@singledispatch
def _caught(hold, solid: Solid, lattice: Lattice) -> np.ndarray:
    raise TypeError(f"no rule for {hold!r}")


@_caught.register
def _(hold: HoldAll, solid: Solid, lattice: Lattice) -> np.ndarray:
    return np.ones(len(lattice.position), bool)


@_caught.register
def _(hold: HoldFaces, solid: Solid, lattice: Lattice) -> np.ndarray:
    """The outermost layer of particles; for a cuboid exactly those on the face."""
    caught = np.zeros(len(lattice.position), bool)
    for side in hold.sides:
        sign, axis = (-1 if side.value[0] == "-" else 1), "xyz".index(side.value[1])
        out = sign * lattice.position[:, axis]
        caught |= out > out.max() - 0.5 * lattice.cells.edge[axis]
    return caught


@_caught.register
def _(hold: HoldWithin, solid: Solid, lattice: Lattice) -> np.ndarray:
    return caught_in_box(hold, _rotated(solid, lattice.position) + solid.position, lattice.cells.edge.max(), solid.position)


def caught_in_box(hold: HoldWithin, position: np.ndarray, h: float, middle: Sequence[float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Particles [m], shape (N, 3), so far apart [m] around a place [m], in a held box, bool, shape (N,)."""
    # Particles on the border, by the scene's round numbers, belong to the box.
    hair = 1e-9 * (h + np.abs(middle).max())
    return ((position >= np.array(hold.low) - hair) & (position <= np.array(hold.high) + hair)).all(axis=1)


def _missed(hold: HoldWithin, solid: Solid, lattice: Lattice) -> tuple[str, str]:
    position = _rotated(solid, lattice.position) + solid.position
    low, high = (", ".join(number(x, 4) for x in side) for side in (position.min(axis=0), position.max(axis=0)))
    return (
        "hold within this box catches no particle",
        f"the object reaches from ({low}) to ({high}) m, its particles are {say(lattice.cells.edge.max(), 'm')} apart",
    )


MOST_TRIED = 3e7
"""Cells that are looked at for a finer resolution at which a body holds together: some five seconds."""


def _too_thin(solid: Solid, h: float, error: TooThin) -> Problem:
    """Name a sufficient resolution, by trying finer ones."""
    tried, left, where = [h], MOST_TRIED, "control" if solid.resolution is None else "it"
    # Two digits, so that the resolution that is tried is the one in the message.
    for trial in [float(f"{finer:.2g}") for finer in h * 0.8 ** np.arange(1, 6)]:
        left -= bounding_cells(solid.shape, trial)
        if left < 0.0:
            break
        tried.append(trial)
        try:
            fill_cells(solid.shape, trial)
        except TooThin:
            continue
        return Problem(
            solid.spans.get("shape"),
            f"{solid.name}: thinner than the spacing allows, {error} at {say(h, 'm')}",
            f"write resolution {say(trial, 'm')} in {where}, or make its thin parts thicker",
        )
    found = [say(size, "m") for size in tried]
    return Problem(
        solid.spans.get("shape"),
        f"{solid.name}: {error}, " + (f"neither at {found[0]} nor at {found[-1]}" if len(tried) > 1 else f"at {found[0]}"),
        _in_parts(solid),
    )


def _in_parts(solid: Solid) -> str:
    """Way out of what is never in one piece."""
    if isinstance(solid.shape, Mesh) and (parts := _parts(mesh.load(solid.shape))) > 1:
        cause = f"{solid.shape.path.name} has {parts} parts that do not hang together"
        return (
            f"{cause}: write elasticity rigid, or an object for each, part 1 to part {parts} with origin file, which keeps places"
        )
    return "make separate bodies, and parts that touch in a point, separate objects"


def _parts(found: mesh.Triangles) -> int:
    """How many parts of its file a mesh consists of."""
    return len(found.names) or int(pieces(found.points, found.triangles).max()) + 1
