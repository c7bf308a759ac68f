# SPDX-License-Identifier: GPL-2.0-only
"""A rope: particles in a line, springs between neighbours, and springs over two links where it resists bending."""

from __future__ import annotations

import numpy as np

from ...bodies import BodyKind, lets_go
from ...model.build import NothingHeld, caught_in_box
from ...model.model import Layer, Model, Surface
from ...model.shapes import mass
from ...model.springs import reduced_mass, types
from ...model.tube import OF_TORN, make_tube
from ...scene.formatting import say
from ...scene.scene import Accuracy, HoldAll, HoldEnds, HoldWithin, Rope
from ..tearing.words import tears
from .chain import line_frame, links_of, places, springs
from .words import is_rope

MOST_LINKS = {Accuracy.PREVIEW: 100, Accuracy.BALANCED: 200, Accuracy.REFERENCE: 400}
"""Links of a rope without a ``resolution``, whose links are as long as it is thick where these are fewer."""
LEAST_LINKS = {Accuracy.PREVIEW: 10, Accuracy.BALANCED: 20, Accuracy.REFERENCE: 40}


class RopeBody(BodyKind):
    """An object with ``shape rope`` or ``shape chain``."""

    name = "rope"
    order = 60
    sets_spacing = fills = False
    particle_bytes = 6000.0
    particle_seconds = 30e-6

    def takes(self, solid):
        return is_rope(solid)

    def cells(self, scene, solid):
        return 1

    def spacing(self, scene, h):
        accuracy, given = scene.control.accuracy, scene.control.resolution

        def own(solid):
            rope = solid.shape
            finest = max(rope.thickness, given or 0.0)
            links = max(min(rope.length / finest, MOST_LINKS[accuracy]), LEAST_LINKS[accuracy])
            return rope.length / links_of(rope, max(rope.thickness, rope.length / links))

        return own

    def particles(self, scene, solid, lattice, h):
        return links_of(solid.shape, h) + 1

    def make(self, solid, h, shared):
        rope = solid.shape
        links = links_of(rope, h)
        x = places(rope, links)
        pair, of_spring = springs(rope, solid.elasticity.modulus, links)
        share = np.ones(links + 1)
        share[[0, -1]] = 0.5
        m = mass(solid) * share / links
        held = held_particles(solid, x)
        if held.all() and not lets_go(solid):
            pair, of_spring = pair[:0], of_spring[:0]
        kind, constants = types(np.column_stack([of_spring[:, :2], reduced_mass(m, pair), of_spring[:, 2]]))
        velocity = solid.velocity + np.cross(solid.spin, x - solid.position)
        velocity[held] = 0.0
        rings = OF_TORN if tears(solid) else 0
        frame, surface = shared.once(_shared, rope.thickness, rope.length, links, rings)
        return Model(
            name=solid.name,
            position=x,
            velocity=velocity,
            mass=m,
            share=share,
            layer=np.full(links + 1, Layer.BOUNDARY, np.uint8),
            held=held,
            spring=pair,
            spring_type=kind,
            constants=constants,
            young=solid.elasticity.modulus,
            inertia_error=0.0,
            hexahedron=np.zeros((0, 8), np.int32),
            cell=tuple(frame.cells.edge.tolist()),
            surface=surface,
            frame=frame,
        )


def _shared(shared, thickness: float, length: float, links: int, rings: int):
    """Parts that ropes of one length, thickness and number of links share, and of rings that are drawn."""
    straight = Rope((0.0, 0.0, 0.0), (length, 0.0, 0.0), thickness, length)
    triangle, index, weight, tube = make_tube(links, 0.5 * thickness, rings)
    for array in (triangle, index, weight, tube):
        array.setflags(write=False)
    return line_frame(straight, links), Surface(triangle, index, weight, tube=tube)


def held_particles(solid, x: np.ndarray) -> np.ndarray:
    """Particles [m], shape (N, 3), in any ``hold`` of a rope, bool, shape (N,). Raises NothingHeld."""
    held = np.zeros(len(x), bool)
    for hold in solid.hold:
        if isinstance(hold, HoldEnds):
            held[0] |= hold.start
            held[-1] |= hold.end
        elif isinstance(hold, HoldWithin):
            caught = caught_in_box(hold, x, float(np.linalg.norm(x[1] - x[0])))
            if not caught.any():
                apart = say(float(np.linalg.norm(x[1] - x[0])), "m")
                raise NothingHeld(
                    "hold within this box catches no particle", f"its particles are {apart} apart; hold ends holds both ends"
                )
            held |= caught
        else:
            assert isinstance(hold, HoldAll)
            held[:] = True
    return held


KINDS = (RopeBody(),)
