# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on ropes: what they pass through."""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import shapes
from ...scene.formatting import say
from .words import is_rope, kind

FINE = 0.5
"""Length of a link over the thinnest part of what it may meet, above which that may slip through between particles."""


def notes(envelope: Envelope) -> list[Problem]:
    """Remarks on a scene in which something can move."""
    ropes = np.flatnonzero([is_rope(solid) for solid in envelope.scene.solids])
    touches = any(effect.touches for effect in envelope.on)
    if not len(ropes) or not touches:
        return []
    return [*_each_other(envelope, ropes), *_long_links(envelope, ropes)]


def _each_other(envelope: Envelope, ropes: np.ndarray) -> list[Problem]:
    """Two ropes, or parts of one, do not touch."""
    if len(ropes) < 2:
        return []
    names = envelope.system.names
    more = f" and {len(ropes) - 2} more" if len(ropes) > 2 else ""
    cause = f"{names[ropes[0]]}, {names[ropes[1]]}{more} do not touch each other: ropes touch what is not a rope, and planes"
    return [Problem(envelope.place(int(ropes[1]), "shape"), cause, "keep them apart where that would show", severity="note")]


def _long_links(envelope: Envelope, ropes: np.ndarray) -> list[Problem]:
    """The rope of the longest links, beside the thinnest object that it may meet."""
    system, solids = envelope.system, envelope.scene.solids
    others = np.flatnonzero(~system.bare)
    if not len(others):
        return []
    thin = np.array([shapes.thickness(solids[m].shape) for m in others.tolist()])
    thinnest, longest = int(others[thin.argmin()]), int(ropes[system.spacing[ropes].argmax()])
    link = float(system.spacing[longest])
    if link <= FINE * thin.min():
        return []
    rope = solids[longest].shape
    finest = max(rope.thickness, FINE * float(thin.min()))
    cause = (
        f"links of {system.names[longest]} are {say(link, 'm')} long and {system.names[thinnest]} is {say(thin.min(), 'm')} "
        f"thin: it may slip through between particles of the {kind(rope)}"
    )
    finer = f"write resolution {say(finest, 'm')} in {system.names[longest]}"
    way_out = finer if finest < link else f"make {system.names[thinnest]} thicker"
    return [Problem(envelope.place(longest, "resolution", "shape"), cause, way_out, severity="note")]
