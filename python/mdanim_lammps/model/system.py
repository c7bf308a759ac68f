# SPDX-License-Identifier: GPL-2.0-only
"""All solids of a scene in one set of arrays, in the order of the scene: the data that effects, certificate and engine read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..records import dataclass
from ..scene.scene import SceneRecord
from . import shapes
from .contact_body import BodyFrame, ContactBody
from .model import Layer, Model, Particles
from .springs import types


@dataclass(frozen=True)
class System(Particles):
    """M solids; particle ``i`` has the LAMMPS tag ``i + 1``, solid ``m`` the molecule ``m + 1``."""

    names: tuple[str, ...]
    first: np.ndarray
    """First particle of each solid, and N at the end, int64, shape (M + 1,)."""
    young: np.ndarray
    """Young's modulus of each solid [Pa], shape (M,)."""
    spacing: np.ndarray
    """Longest cell edge of each solid [m], shape (M,)."""
    cell_volume: np.ndarray
    """Volume of a lattice cell of each solid [m^3], shape (M,)."""
    per_share: np.ndarray
    """True volume of each solid over the sum of its shares [m^3], shape (M,)."""
    inertia_error: np.ndarray
    """Largest error of a moment of inertia of each solid, see `Model` [-], shape (M,)."""
    contact_kind: np.ndarray
    """Kind of body of each solid as contact sees it, by which solid has it first, int32, shape (M,)."""
    frames: tuple[BodyFrame, ...]
    """The frames from which the contact body of each kind of the scene is made."""
    driven: np.ndarray
    """Solids whose held particles some effect moves, bool, shape (M,)."""
    pinned: np.ndarray
    """Particles that are held until they are let go, bool, shape (N,)."""
    inertia: np.ndarray
    """Tensor of inertia of each solid that moves as a whole, see `Model` [kg m^2], shape (M, 3, 3); zeros of all others."""

    @property
    def particles(self) -> int:
        return len(self.position)

    @cached_property
    def object(self) -> np.ndarray:
        """Solid of each particle, 0-based, int32, shape (N,)."""
        return np.repeat(np.arange(len(self.names), dtype=np.int32), np.diff(self.first))

    @cached_property
    def boundary(self) -> np.ndarray:
        """Particles on a surface, bool, shape (N,)."""
        return self.layer >= Layer.BOUNDARY

    @property
    def volume(self) -> np.ndarray:
        """Share of each particle in the true volume of its solid, V_i [m^3], shape (N,): by filled cells, not by mass."""
        return self.share * self.per_share[self.object]

    @cached_property
    def contact_bodies(self) -> dict[int, ContactBody]:
        """The undeformed bodies of the kinds that some solid has, by kind, ascending; made when they are first asked for, and
        the same objects in all systems that are cut out of one."""
        return {kind: self.frames[kind].contact for kind in sorted({*self.contact_kind.tolist()})}

    @cached_property
    def held_whole(self) -> np.ndarray:
        """Solids that are held as a whole, driven or not, bool, shape (M,)."""
        return np.logical_and.reduceat(self.held, self.first[:-1])

    @cached_property
    def still(self) -> np.ndarray:
        """Solids that are held as a whole and never move, bool, shape (M,)."""
        return self.held_whole & ~self.driven

    @cached_property
    def rigid(self) -> np.ndarray:
        """Solids that move as a whole, with six degrees of freedom, bool, shape (M,)."""
        return self.inertia.any(axis=(1, 2))

    @cached_property
    def bare(self) -> np.ndarray:
        """Solids whose particles are their points of contact, and which nothing is ever in: lines and sheets of particles, bool,
        shape (M,)."""
        return np.array([frame.bare for frame in self.frames], bool)[self.contact_kind]

    @property
    def moved(self) -> np.ndarray | None:
        """Held particles that some effect moves, bool, shape (N,); None where there are none."""
        return (self.held | self.pinned) & self.driven[self.object] if self.driven.any() else None

    def stretches(self, solids: Sequence[int]) -> list[slice]:
        """Particles of some solids, in their order; one stretch of those that are side by side:
        row by row copies take five times as long."""
        which = np.asarray(solids, np.int64)
        return [places for (places,) in side_by_side(self.first[which + 1] - self.first[which], self.first[which])]

    def springs_of(self, solid: int) -> slice:
        """Springs of a solid: they are sorted by their first particles."""
        return slice(*np.searchsorted(self.spring[:, 0], self.first[solid : solid + 2]).tolist())

    def bounds(self, vector: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest components in each solid of a particle vector, shape (N, 3); each of shape (M, 3), same unit.

        Of positions, its box, Wcislo 1999, eq. (3.14).
        """
        low, high = (f.reduceat(vector, self.first[:-1]) for f in (np.minimum, np.maximum))
        return low, high

    def top_speed(self, velocity: np.ndarray) -> np.ndarray:
        """Speed of the fastest particle of each solid [m/s], shape (M,); velocities have the shape (N, 3)."""
        return np.sqrt(np.maximum.reduceat(np.einsum("id,id->i", velocity, velocity), self.first[:-1]))

    @cached_property
    def mass_of(self) -> np.ndarray:
        """Mass of each solid [kg], shape (M,)."""
        return np.add.reduceat(self.mass, self.first[:-1])

    @cached_property
    def density(self) -> np.ndarray:
        """Density of each solid [kg/m^3], shape (M,)."""
        return self.mass_of / (np.add.reduceat(self.share, self.first[:-1]) * self.cell_volume)

    def center_of_mass(self, position: np.ndarray) -> np.ndarray:
        """Mass-weighted mean of each solid for particle vectors of shape (N, 3); shape (M, 3), same unit."""
        return centers(self.mass, self.first[:-1], position)


def hardness(system: System) -> np.ndarray:
    """Stiffness with which each solid touches others, over that which its material gives [-], shape (M,)."""
    return np.array([frame.hardness for frame in system.frames])[system.contact_kind]


def parts(system: System) -> np.ndarray:
    """Distance of particles over that of points of contact, of lines and sheets [-], shape (M,)."""
    return np.array([frame.parts for frame in system.frames])[system.contact_kind]


def centers(mass: np.ndarray, first: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Mass-weighted means of particle vectors, shape (n, 3), over objects that begin at these rows, shape (m,); shape (m, 3).

    The mean of an object has the same bits in whatever company: its terms are summed by themselves. ``mass`` [kg], shape (n,).
    """
    sums = [np.add.reduceat(mass * values[:, d], first) for d in range(3)]  # twice as fast as rows of three
    return np.stack(sums, axis=1) / np.add.reduceat(mass, first)[:, None]


def assemble(models: Sequence[Model], scene: SceneRecord) -> System:
    """Join the models of a scene, in order, into one System; of none, a scene of liquid alone, an empty one."""
    if not models:
        return _empty()
    first = np.concatenate([[0], np.cumsum([len(m.position) for m in models])]).astype(np.int64)

    def join(arrays):
        # A single large solid is passed through: no second copy of a million particles.
        return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)

    # Each model has types of its own.
    merged, constants = types(np.concatenate([m.constants for m in models]))
    start = np.cumsum([0, *(len(m.constants) for m in models)])
    offsets = first[:-1].astype(np.int32)
    frames = tuple({id(m.frame): m.frame for m in models}.values())
    kind = {id(frame): k for k, frame in enumerate(frames)}
    return System(
        names=tuple(m.name for m in models),
        first=first,
        position=join([m.position for m in models]),
        velocity=join([m.velocity for m in models]),
        mass=join([m.mass for m in models]),
        share=join([m.share for m in models]),
        layer=join([m.layer for m in models]),
        held=join([m.held for m in models]),
        spring=join([m.spring + o if o else m.spring for m, o in zip(models, offsets)]),
        spring_type=join([m.spring_type if len(models) == 1 else merged[s:][m.spring_type - 1] for m, s in zip(models, start)]),
        constants=constants,
        young=np.array([m.young for m in models]),
        spacing=np.array([m.spacing for m in models]),
        cell_volume=np.array([np.prod(m.cell) for m in models]),
        per_share=np.array([shapes.volume(s.shape) / m.share.sum() for m, s in zip(models, scene.solids)]),
        inertia_error=np.array([m.inertia_error for m in models]),
        hexahedron=join([m.hexahedron + o if o else m.hexahedron for m, o in zip(models, offsets)]),
        contact_kind=np.array([kind[id(m.frame)] for m in models], np.int32),
        frames=frames,
        driven=np.array([m.driven for m in models], bool),
        pinned=join([np.zeros_like(m.held) if m.pinned is None else m.pinned for m in models]),
        inertia=np.array([np.zeros((3, 3)) if m.inertia is None else m.inertia for m in models]),
    )


def _empty() -> System:
    numbers, vectors, flags = np.zeros(0), np.zeros((0, 3)), np.zeros(0, bool)
    return System(
        names=(),
        first=np.zeros(1, np.int64),
        position=vectors,
        velocity=vectors,
        mass=numbers,
        share=numbers,
        layer=np.zeros(0, np.uint8),
        held=flags,
        spring=np.zeros((0, 2), np.int32),
        spring_type=np.zeros(0, np.uint8),
        constants=np.zeros((0, 4)),
        young=numbers,
        spacing=numbers,
        cell_volume=numbers,
        per_share=numbers,
        inertia_error=numbers,
        hexahedron=np.zeros((0, 8), np.int32),
        contact_kind=np.zeros(0, np.int32),
        frames=(),
        driven=flags,
        pinned=flags,
        inertia=np.zeros((0, 3, 3)),
    )


def as_parts(models: Sequence[Model], system: System) -> tuple[Model, ...]:
    """The models of which a system was assembled, whose own data are views of the system's arrays, without copies."""
    own = ("position", "velocity", "held")
    return tuple(
        replace(m, **{name: getattr(system, name)[a:b] for name in own})
        for m, a, b in zip(models, system.first, system.first[1:])
    )


def side_by_side(size: np.ndarray, *begins: np.ndarray) -> list[tuple[slice, ...]]:
    """Pieces of ``size`` rows that begin at these places of one array or several, ascending, as stretches: pieces that follow
    each other in all of them are one."""
    if not len(size):
        return []
    apart = np.flatnonzero(np.any([np.diff(b) != size[:-1] for b in begins], axis=0)) + 1
    first, last = np.append(0, apart), np.append(apart, len(size)) - 1
    return list(zip(*(map(slice, b[first].tolist(), (b[last] + size[last]).tolist()) for b in begins)))
