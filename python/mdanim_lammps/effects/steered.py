# SPDX-License-Identifier: GPL-2.0-only
"""Steering of a run while it goes on, kept as lines of a scene: how an effect takes it up."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..records import dataclass
from ..scene.scene import SceneRecord
from ..scene.schema import Vector
from .context import Context


@dataclass(frozen=True)
class Steering:
    """A pull at a point of an object, from key to key, in commands for LAMMPS and in lines of a scene."""

    begin: str
    """The command that takes hold."""
    key: Callable[[float, Sequence[float]], str]
    """The command that brings it to a place [m] at a time [s], straight on from the last key."""
    rows: np.ndarray
    """Particles of the system whose places, with these weights, are that of the point; int64, shape (P,)."""
    weights: np.ndarray
    """Shape (P,)."""
    speed: float
    """Largest speed from key to key that the certificate has [m/s]."""
    head: str
    """Lines of the scene that begin it."""
    line: Callable[[float, Sequence[float]], str]
    """The line of a key."""
    tail: str
    """The line that ends it."""


class Steered:
    """The facet of an effect that takes up what is done to a run while it goes on."""

    def steers(self, scene: SceneRecord) -> bool:
        """Whether a scene is such that this can be done."""
        return False

    def steering(self, context: Context, name: str, point: Vector) -> Steering | None:
        """How a point of the object of this name [m], as that is at the start, is pulled at; None where the effect does no such
        thing, or not at this object."""
        return None

    def steered(self, context: Context, scene: SceneRecord, after: float) -> list[tuple[float, str]]:
        """Ends [s] of what such pulls of a scene do from a time on [s], with the commands that do it; the scene has those of the
        context and more behind them, of which alone it is asked."""
        return []
