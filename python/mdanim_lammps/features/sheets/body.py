# SPDX-License-Identifier: GPL-2.0-only
"""A sheet: one layer of particles on a triangular lattice, springs between neighbours, and springs over two links where it
resists bending."""

from __future__ import annotations

import math
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from ...model import shapes
from ...model.bare import BareBody, BareFrame, bare_model
from ...model.bends import BendRing
from ...model.build import NothingHeld, caught_in_box
from ...model.lattice import Cells
from ...records import dataclass
from ...scene.formatting import say
from ...scene.scene import Accuracy, HoldAll, HoldFaces, HoldWithin, Sheet, Shell
from ..tearing.words import tears
from .bearing import fits
from .drawn import both_sides
from .refined import refined
from .tiled import Tiled, tiled
from .weave import Weave, weave
from .words import coarsest, finest, is_sheet, width

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


FARTHEST = 1.5
"""Distance of a point in a triangle from a corner of it over the spacing, at most."""


class SheetBody(BareBody):
    """An object with ``shape sheet``, or with the surface of another shape as a sheet."""

    name = "sheet"
    order = 65

    def takes(self, solid):
        return is_sheet(solid)

    def spacing(self, scene, h):
        accuracy, given = scene.control.accuracy, scene.control.resolution

        def own(solid):
            area, across = shapes.volume(solid.shape) / solid.shape.thickness, width(solid.shape)
            usual = min(math.sqrt(area / PARTICLES[accuracy]), across / ACROSS[accuracy])
            return max(usual, finest(solid.shape), min(given or 0.0, coarsest(solid.shape)))

        return own

    def particles(self, scene, solid, lattice, h):
        if isinstance(solid.shape, Sheet):
            return len(weave(solid.shape, h).place)
        return shapes.volume(solid.shape) / (solid.shape.thickness * math.sqrt(0.75) * h**2)

    def make(self, solid, h, shared):
        sheet, woven = solid.shape, layer(solid.shape, h)
        arm = np.zeros((len(woven.place), 3))
        arm[:, : woven.place.shape[1]] = woven.place
        arm = arm @ np.array(solid.rotation).T
        x = arm + solid.position
        held = held_particles(solid, woven, x)
        of_sheet = woven.springs(solid.elasticity.modulus, sheet.thickness, sheet.bending, held & ~held.all())
        cell = (woven.h, woven.apart, sheet.thickness)
        model = bare_model(solid, x, arm, woven.share, held, of_sheet, shared.once(_shared, sheet, h), cell)
        return replace(model, tears=tears(solid))

    def fitted(self, context):
        """With points and a hardness with which it bears what comes onto it (features/sheets/bearing.py)."""
        found = {}
        for m, (parts, hardness) in fits(context).items():
            frame = replace(context.models[m].frame, parts=parts, hardness=hardness)
            found[m] = replace(context.models[m], frame=frame)
        return found


@dataclass(frozen=True, eq=False)
class SheetFrame(BareFrame):
    """A layer of particles as contact sees it."""

    dimensions = 2
    woven: Weave | Tiled = field(kw_only=True)
    parts: int = field(kw_only=True, default=1)
    """Parts of a link: in triangles of the layer there are points as far apart."""
    hardness: float = field(kw_only=True, default=1.0)

    @property
    def spans(self) -> int:
        """A curved one has directions across, too."""
        return 2 if isinstance(self.woven, Weave) else 3

    def rings(self, held: np.ndarray) -> list[BendRing]:
        """Rings and lines that it bends by, from which particles are held, bool, shape (N,)."""
        return self.woven.rings_of(held & ~held.all())

    @property
    def closed(self) -> bool:
        """Whether it has no border, so that it encloses a volume."""
        return isinstance(self.woven, Tiled) and self.woven.closed

    @cached_property
    def triangle(self) -> np.ndarray:
        """Triangles of the layer between particles, counter-clockwise seen from +z of a flat object, from outside of a closed
        one, int32, shape (T, 3)."""
        return self.woven.triangle

    @cached_property
    def points(self) -> tuple[np.ndarray, float]:
        """Shares of POINT, and the half thickness or GAP."""
        area = POINT * self.shape.thickness * float(self.cells.edge[0])
        share = self.woven.share if self.parts == 1 else self.refined[2]
        return area * share, max(0.5 * self.shape.thickness, GAP * self.woven.h)

    @cached_property
    def refined(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Corners of triangles that are cut into ``parts``^2: the particles around each that is none itself, with weights, and
        shares of the area of all, those of particles first."""
        return refined(self.woven, self.parts)

    @property
    def between(self):
        return (*self.refined[:2], FARTHEST * self.woven.h) if self.parts > 1 else super().between


def layer(shape: Sheet | Shell, h: float) -> Weave | Tiled:
    """Particles of a sheet with a spacing of about h [m]. Raises mesh.MeshError."""
    return weave(shape, h) if isinstance(shape, Sheet) else tiled(shape, h)


def _shared(shared, sheet: Sheet | Shell, h: float):
    """Parts that sheets of one size, thickness and spacing share: what contact sees, and both sides as they are drawn."""
    woven = layer(sheet, h)
    n, edge = len(woven.place), (woven.h * woven.apart * sheet.thickness) ** (1.0 / 3.0)
    low = -0.5 * edge * np.array([n, 1, 1])
    surface = both_sides(woven.triangle, n, woven.creases)
    for array in (surface.triangle, surface.index, surface.weight):
        array.setflags(write=False)
    frame = SheetFrame(sheet, Cells(np.ones((1, 1, n), bool), low, -low), woven=woven)
    return frame, surface


def held_particles(solid, woven: Weave | Tiled, x: np.ndarray) -> np.ndarray:
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
