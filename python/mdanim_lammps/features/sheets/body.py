# SPDX-License-Identifier: GPL-2.0-only
"""A sheet: one layer of particles on a triangular lattice, springs between neighbours, and springs over two links where it
resists bending."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ...bodies import BodyKind, lets_go
from ...model.build import NothingHeld, caught_in_box
from ...model.contact_body import BodyFrame, ContactBody
from ...model.lattice import Cells
from ...model.model import Layer, Model
from ...model.shapes import mass
from ...model.springs import reduced_mass, types
from ...scene.formatting import say
from ...scene.scene import Accuracy, HoldAll, HoldFaces, HoldWithin, Sheet
from .drawn import both_sides
from .weave import Weave, weave
from .words import finest, is_sheet

PARTICLES = {Accuracy.PREVIEW: 400, Accuracy.BALANCED: 1200, Accuracy.REFERENCE: 4800}
"""Particles of a sheet without a ``resolution``, about."""
ACROSS = {Accuracy.PREVIEW: 4, Accuracy.BALANCED: 6, Accuracy.REFERENCE: 12}
"""Spacings across a narrow one, at least."""
POINT = 0.5
"""Area of the surface that a point of contact stands for, over t V^(1/3), V the volume of a cell of the thickness t: pressed on,
it gives way about as the sheet itself does in its plane, so that contact sets no time step of its own."""

GAP = 1.0 / 12.0
"""Radius of the surface around each particle over the spacing, at least: it sinks in a little, and no triangle between particles
shows what it lies on."""


class SheetBody(BodyKind):
    """An object with ``shape sheet``."""

    name = "sheet"
    order = 65
    sets_spacing = fills = False
    particle_bytes = 6000.0
    particle_seconds = 30e-6

    def takes(self, solid):
        return is_sheet(solid)

    def cells(self, scene, solid):
        return 1

    def spacing(self, scene, h):
        accuracy, given = scene.control.accuracy, scene.control.resolution

        def own(solid):
            lx, ly = solid.shape.size
            usual = min(math.sqrt(lx * ly / PARTICLES[accuracy]), min(lx, ly) / ACROSS[accuracy])
            return max(usual, finest(solid.shape), given or 0.0)

        return own

    def particles(self, scene, solid, lattice, h):
        return len(weave(solid.shape, h).place)

    def make(self, solid, h, shared):
        sheet, woven = solid.shape, weave(solid.shape, h)
        arm = np.zeros((len(woven.place), 3))
        arm[:, :2] = woven.place
        arm = arm @ np.array(solid.rotation).T
        x = arm + solid.position
        held = held_particles(solid, woven, x)
        pair, of_spring = woven.springs(solid.elasticity.modulus, sheet.thickness, sheet.bending, held & ~held.all())
        if held.all() and not lets_go(solid):
            pair, of_spring = pair[:0], of_spring[:0]
        m = mass(solid) * woven.share / woven.share.sum()
        kind, constants = types(np.column_stack([of_spring[:, :2], reduced_mass(m, pair), of_spring[:, 2]]))
        velocity = solid.velocity + np.cross(solid.spin, arm)
        velocity[held] = 0.0
        frame, surface = shared.once(_shared, sheet, h)
        return Model(
            name=solid.name,
            position=x,
            velocity=velocity,
            mass=m,
            share=woven.share,
            layer=np.full(len(x), Layer.BOUNDARY, np.uint8),
            held=held,
            spring=pair,
            spring_type=kind,
            constants=constants,
            young=solid.elasticity.modulus,
            inertia_error=0.0,
            hexahedron=np.zeros((0, 8), np.int32),
            cell=(woven.h, woven.apart, sheet.thickness),
            surface=surface,
            frame=frame,
        )


@dataclass(frozen=True, eq=False)
class SheetFrame(BodyFrame):
    """A layer of particles as contact sees it: points of its own, in one row of cells."""

    dimensions = 2
    woven: Weave = field(kw_only=True)

    @cached_property
    def triangle(self) -> np.ndarray:
        """Triangles of the layer between particles, counter-clockwise seen from +z of the object, int32, shape (T, 3)."""
        return self.woven.triangle

    @cached_property
    def contact(self) -> ContactBody:
        """The same object at every call."""
        n = len(self.woven.place)
        number, area = np.arange(n, dtype=np.int32), POINT * self.shape.thickness * float(self.cells.edge[0])
        at = np.stack([number + 0.5, np.full(n, 0.5), np.full(n, 0.5)], axis=1)
        body = ContactBody(
            count=self.cells.count.astype(np.int32),
            edge=self.cells.edge,
            node=number,
            filled=np.ones(n, np.uint8),
            cell=number,
            at=at,
            centre=at,
            normal=np.tile([0.0, 0.0, 1.0], (n, 1)),
            area=area * self.woven.share,
            kind=np.full(n, 2, np.uint8),
            depth=None,
            open=np.zeros((0, 5)),
            radius=max(0.5 * self.shape.thickness, GAP * self.woven.h),
        )
        for array in (number, at, body.edge, body.filled, body.normal, body.area, body.kind, body.open, body.count):
            array.setflags(write=False)
        return body

    @cached_property
    def drawn(self) -> np.ndarray:
        """Which particles lie inside the shape, bool, shape (N,): all."""
        return np.ones(len(self.woven.place), bool)


def _shared(shared, sheet: Sheet, h: float):
    """Parts that sheets of one size, thickness and spacing share: what contact sees, and both sides as they are drawn."""
    woven = weave(sheet, h)
    n, edge = len(woven.place), (woven.h * woven.apart * sheet.thickness) ** (1.0 / 3.0)
    low = -0.5 * edge * np.array([n, 1, 1])
    surface = both_sides(woven.triangle, n)
    for array in (surface.triangle, surface.index, surface.weight):
        array.setflags(write=False)
    frame = SheetFrame(sheet, Cells(np.ones((1, 1, n), bool), low, -low), woven=woven)
    return frame, surface


def held_particles(solid, woven: Weave, x: np.ndarray) -> np.ndarray:
    """Particles at x [m], shape (N, 3), in any ``hold`` of a sheet, bool, shape (N,). Raises NothingHeld."""
    held = np.zeros(len(x), bool)
    for hold in solid.hold:
        if isinstance(hold, HoldFaces):
            for side in hold.sides:
                held[woven.sides[side.value]] = True
        elif isinstance(hold, HoldWithin):
            caught = caught_in_box(hold, x, woven.h, solid.position)
            if not caught.any():
                low, high = (", ".join(f"{c:.4g}" for c in end) for end in (x.min(axis=0), x.max(axis=0)))
                raise NothingHeld(
                    "hold within this box catches no particle",
                    f"the sheet reaches from ({low}) to ({high}) m, its particles are {say(woven.h, 'm')} apart; "
                    "hold face -x holds a side",
                )
            held |= caught
        else:
            assert isinstance(hold, HoldAll)
            held[:] = True
    return held


KINDS = (SheetBody(),)
