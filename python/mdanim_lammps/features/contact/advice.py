# SPDX-License-Identifier: GPL-2.0-only
"""What ``check`` tells of objects that rest on something: what slides, and what falls over."""

from __future__ import annotations

from ...effects.envelope import Envelope
from ...errors import Problem
from .resting import frictionless, slopes
from .towers import towers


def notes(envelope: Envelope) -> list[Problem]:
    """Of a scene in which something can move."""
    return [*frictionless(envelope), *slopes(envelope), *towers(envelope)]
