# SPDX-License-Identifier: GPL-2.0-only
"""A rope: particles in a line, springs between neighbours, and springs over two links where it resists bending."""

from __future__ import annotations

import numpy as np

from ...model.bare import BareBody, bare_model
from ...model.build import NothingHeld, caught_in_box
from ...model.model import Surface
from ...model.tube import OF_TORN, make_tube
from ...scene.formatting import say
from ...scene.scene import Accuracy, HoldAll, HoldEnds, HoldWithin, Rope
from ..tearing.words import tears
from .chain import line_frame, links_of, places, springs
from .words import is_rope

MOST_LINKS = {Accuracy.PREVIEW: 100, Accuracy.BALANCED: 200, Accuracy.REFERENCE: 400}
"""Links of a rope without a ``resolution``, whose links are as long as it is thick where these are fewer."""
LEAST_LINKS = {Accuracy.PREVIEW: 10, Accuracy.BALANCED: 20, Accuracy.REFERENCE: 40}


class RopeBody(BareBody):
    """An object with ``shape rope`` or ``shape chain``."""

    name = "rope"
    order = 60

    def takes(self, solid):
        return is_rope(solid)

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
        share = np.ones(links + 1)
        share[[0, -1]] = 0.5
        rings = OF_TORN if tears(solid) else 0
        drawn = shared.once(_shared, rope.thickness, rope.length, links, rings)
        of_rope = springs(rope, solid.elasticity.modulus, links)
        cell = tuple(drawn[0].cells.edge.tolist())
        return bare_model(solid, x, x - solid.position, share, held_particles(solid, x), of_rope, drawn, cell)


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
