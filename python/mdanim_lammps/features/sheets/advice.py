# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on sheets: what they pass through, and what they do not bear."""

from __future__ import annotations

import numpy as np

from ...effects.envelope import Envelope
from ...errors import Problem
from ...scene.formatting import say
from ..folds.layers import as_layers, folds
from ..ropes.advice import coarsest, slips
from .bearing import borne, hardened, laid, pressed_through
from .words import finest, is_sheet


def notes(envelope: Envelope) -> list[Problem]:
    """Remarks on a scene in which something can move."""
    sheets = np.flatnonzero([is_sheet(solid) for solid in envelope.scene.solids])
    moving = sheets[~envelope.system.held_whole[sheets]]
    if not len(moving):
        return []
    touches = any(effect.touches for effect in envelope.on)
    return [
        *_themselves(envelope, moving),
        *([*_coarse(envelope, sheets), *pressed_through(envelope), *hardened(envelope), *laid(envelope)] if touches else []),
    ]


def _themselves(envelope: Envelope, sheets: np.ndarray) -> list[Problem]:
    """A sheet without ``touches-itself`` touches neither itself nor a rope: a warning where it may meet one."""
    system, solids = envelope.system, envelope.scene.solids
    for first in sheets.tolist():
        met = np.array(_met(envelope, first), int)
        if others := met[~as_layers(envelope.scene, first, met)].tolist():
            more = f" and {len(others) - 1} more" if len(others) > 1 else ""
            both = f"{system.names[first]} may meet {system.names[others[0]]}{more}"
            cause = f"{both}, and passes through: sheets and ropes touch each other where both have touches-itself"
            way_out = "keep them apart, or write touches-itself yes in both"
            return [Problem(envelope.place(first, "shape"), cause, way_out, severity="warning")]
    loose = [m for m in sheets.tolist() if not folds(solids[m])]
    if not loose:
        return []
    cause = f"{system.names[loose[0]]} does not touch itself: folds of it pass through each other"
    way_out = "write touches-itself yes in it, which takes time, where it folds"
    return [Problem(envelope.place(loose[0], "shape"), cause, way_out, severity="note")]


def _met(envelope: Envelope, m: int) -> list[int]:
    """Other sheets and ropes that a sheet may meet, but for what a joint ties to it."""
    swept = envelope.reach.region
    near = ((swept.low[m] < swept.high) & (swept.low < swept.high[m])).all(axis=1) & envelope.system.bare
    return [k for k in np.flatnonzero(near).tolist() if k != m and (min(k, m), max(k, m)) not in swept.passing]


def _coarse(envelope: Envelope, sheets: np.ndarray) -> list[Problem]:
    """The coarsest sheet, beside the thinnest object that it may meet, of those that nothing has made fine enough."""
    sheets = np.setdiff1d(sheets, list(borne(envelope)))
    if not len(sheets) or (found := coarsest(envelope, sheets)) is None:
        return []
    m, thinnest, least = found
    name, thing = envelope.system.names[m], envelope.system.names[thinnest]
    h = float(envelope.system.spacing[m])
    cause = f"particles of {name} are {say(h, 'm')} apart and {thing} is {say(least, 'm')} thin: it may slip through between them"
    return [slips(envelope, found, cause, finest(envelope.scene.solids[m].shape))]
