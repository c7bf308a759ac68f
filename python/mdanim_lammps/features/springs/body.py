# SPDX-License-Identifier: GPL-2.0-only
"""The lattice of hexahedra: particles at the corners of cells, tied to their neighbours by springs (Wcislo 1999, sec. 5.2)."""

from __future__ import annotations

from dataclasses import replace

from ...bodies import BodyKind
from ...model.build import lattice_model
from ..tearing.words import tears


class LatticeBody(BodyKind):
    """An elastic object; every object that no other kind takes."""

    name = "lattice"
    order = 10_000

    def takes(self, solid):
        return True

    def make(self, solid, h, shared):
        model = lattice_model(solid, h, shared)
        return replace(model, tears=True, frame=shared.once(_that_tears, model.frame)) if tears(solid) else model


def _that_tears(shared, frame):
    """The frame of bodies that may tear, the same for all of one shape."""
    return replace(frame, tears=True)


KINDS = (LatticeBody(),)
