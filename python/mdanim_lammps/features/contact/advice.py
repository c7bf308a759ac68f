# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on objects that rest on something, and slide or fall over, and on those that something squeezes."""

from __future__ import annotations

from ...effects.envelope import Envelope
from ...errors import Problem
from . import squeezed
from .resting import frictionless, slopes
from .towers import towers


def notes(envelope: Envelope) -> list[Problem]:
    """Remarks on a scene in which something can move."""
    return [*frictionless(envelope), *slopes(envelope), *towers(envelope), *squeezed.notes(envelope)]
