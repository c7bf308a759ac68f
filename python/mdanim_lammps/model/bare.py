# SPDX-License-Identifier: GPL-2.0-only
"""Bodies of particles that fill no volume, as ropes and sheets: the particles themselves are their points of contact."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ..bodies import BodyKind, lets_go
from .contact_body import NO_SHARERS, NO_SHARES, BodyFrame, ContactBody
from .model import Layer, Model, Surface
from .shapes import mass
from .springs import reduced_mass, types


class BareBody(BodyKind):
    """A kind of such bodies."""

    sets_spacing = fills = False
    particle_bytes = 6000.0
    particle_seconds = 30e-6

    def cells(self, scene, solid):
        return 1


class BareFrame(BodyFrame):
    """Particles as contact sees them: points of its own, in one row of cells."""

    @cached_property
    def points(self) -> tuple[np.ndarray, float]:
        """Area of the surface that each point stands for [m^2], those of particles first, shape (P,), and the distance of the
        surface from it [m]."""
        raise NotImplementedError

    @property
    def radius(self):
        return self.points[1]

    @property
    def between(self) -> tuple[np.ndarray, np.ndarray, float]:
        """``sharer``, ``share`` and ``spread`` of a contact body (model/contact_body.py): points between particles."""
        return NO_SHARERS, NO_SHARES, 0.0

    @cached_property
    def contact(self) -> ContactBody:
        """The same object at every call."""
        area, radius = self.points
        sharer, share, spread = self.between
        n = len(area)
        number = np.arange(n, dtype=np.int32)
        at = np.stack([number + 0.5, np.full(n, 0.5), np.full(n, 0.5)], axis=1)
        body = ContactBody(
            count=np.array([n, 1, 1], np.int32),
            edge=self.cells.edge,
            node=number[: n - len(sharer)],
            filled=np.ones(n, np.uint8),
            cell=number,
            at=at,
            centre=at,
            normal=np.tile([0.0, 0.0, 1.0], (n, 1)),
            area=area,
            kind=np.full(n, 2, np.uint8),
            depth=None,
            open=np.zeros((0, 5)),
            radius=radius,
            hardness=self.hardness,
            sharer=sharer,
            share=share,
            spread=spread,
        )
        for array in (
            number,
            sharer,
            share,
            at,
            body.edge,
            body.filled,
            body.normal,
            body.area,
            body.kind,
            body.open,
            body.count,
        ):
            array.setflags(write=False)
        return body

    @cached_property
    def drawn(self) -> np.ndarray:
        """Which particles lie inside the shape, bool, shape (N,): all."""
        return np.ones(int(self.cells.count[0]), bool)


def bare_model(
    solid: Any,
    position: np.ndarray,
    arm: np.ndarray,
    share: np.ndarray,
    held: np.ndarray,
    springs: tuple[np.ndarray, np.ndarray],
    drawn: tuple[BareFrame, Surface],
    cell: tuple[float, float, float],
) -> Model:
    """The model of such a body: particles [m], shape (N, 3), ``arm`` from its place to each [m], shares of its mass, shape (N,),
    which are held, springs as of `rods.springs_of`, what contact and pictures see, and the edges of a cell [m]."""
    pair, of_spring = springs
    if held.all() and not lets_go(solid):
        pair, of_spring = pair[:0], of_spring[:0]
    m = mass(solid) * share / share.sum()
    kind, constants = types(np.column_stack([of_spring[:, :2], reduced_mass(m, pair), of_spring[:, 2]]))
    velocity = solid.velocity + np.cross(solid.spin, arm)
    velocity[held] = 0.0
    frame, surface = drawn
    return Model(
        name=solid.name,
        position=position,
        velocity=velocity,
        mass=m,
        share=share,
        layer=np.full(len(position), Layer.BOUNDARY, np.uint8),
        held=held,
        spring=pair,
        spring_type=kind,
        constants=constants,
        young=solid.elasticity.modulus,
        inertia_error=0.0,
        hexahedron=np.zeros((0, 8), np.int32),
        cell=cell,
        surface=surface,
        frame=frame,
    )
