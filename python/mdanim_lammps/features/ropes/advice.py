# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on ropes: what they pass through."""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import shapes
from ...model.system import parts
from ...scene.formatting import say
from ..folds.layers import folds
from .words import is_rope, kind

FINE = 0.5
"""Distance of points over the thinnest part of what they may meet, above which that may slip through between them."""


def notes(envelope: Envelope) -> list[Problem]:
    """Remarks on a scene in which something can move."""
    ropes = np.flatnonzero([is_rope(solid) for solid in envelope.scene.solids])
    touches = any(effect.touches for effect in envelope.on)
    if not len(ropes) or not touches:
        return []
    return [*_each_other(envelope, ropes), *_long_links(envelope, ropes)]


def _each_other(envelope: Envelope, ropes: np.ndarray) -> list[Problem]:
    """Two ropes, or parts of one, do not touch."""
    ropes = np.array([m for m in ropes.tolist() if not folds(envelope.scene.solids[m])], int)
    if len(ropes) < 2:
        return []
    names = envelope.system.names
    more = f" and {len(ropes) - 2} more" if len(ropes) > 2 else ""
    cause = f"{names[ropes[0]]}, {names[ropes[1]]}{more} do not touch each other: ropes touch what is not a rope, and planes"
    return [
        Problem(
            envelope.place(int(ropes[1]), "shape"),
            cause,
            "keep them apart where that would show, or write touches-itself yes in both",
            severity="note",
        )
    ]


def _long_links(envelope: Envelope, ropes: np.ndarray) -> list[Problem]:
    """The rope of the longest links, beside the thinnest object that it may meet."""
    if (found := coarsest(envelope, ropes)) is None:
        return []
    longest, thinnest, least = found
    link, rope = float(envelope.system.spacing[longest]), envelope.scene.solids[longest].shape
    name, thing = envelope.system.names[longest], envelope.system.names[thinnest]
    cause = (
        f"links of {name} are {say(link, 'm')} long and {thing} is {say(least, 'm')} "
        f"thin: it may slip through between particles of the {kind(rope)}"
    )
    return [slips(envelope, found, cause, rope.thickness)]


def coarsest(envelope: Envelope, bare: np.ndarray) -> tuple[int, int, float] | None:
    """The coarsest of these ropes or sheets, the thinnest object that it may meet, and how thin that is [m], where it may slip
    through between particles."""
    system, solids = envelope.system, envelope.scene.solids
    others = np.flatnonzero(~system.bare)
    if not len(others):
        return None
    thin = np.array([shapes.thickness(solids[m].shape) for m in others.tolist()])
    apart = system.spacing / parts(system)
    m, least = int(bare[apart[bare].argmax()]), float(thin.min())
    return (m, int(others[thin.argmin()]), least) if float(apart[m]) > FINE * least else None


def slips(envelope: Envelope, found: tuple[int, int, float], cause: str, finest: float) -> Problem:
    """The note of what `coarsest` has found; particles may be ``finest`` [m] apart, or more."""
    m, thinnest, least = found
    fine, names = max(finest, FINE * least), envelope.system.names
    finer = fine < float(envelope.system.spacing[m])
    way_out = f"write resolution {say(fine, 'm')} in {names[m]}" if finer else f"make {names[thinnest]} thicker"
    return Problem(envelope.place(m, "resolution", "shape"), cause, way_out, severity="note")
