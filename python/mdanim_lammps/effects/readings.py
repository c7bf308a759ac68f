# SPDX-License-Identifier: GPL-2.0-only
"""Values that effects read from a simulation that is under way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ..model.system import System
from .fields import Field

if TYPE_CHECKING:
    from .context import Context


LEAPFROG = "leap-frog"
"""Clock of the integrator; the parts of it that effects take are not counted with the integrator's own time."""


class Readings(Protocol):
    """Values of an instance, at the last step of a `run` or after `setup` (engine/instance.py)."""

    context: Context
    """The simulated part: all solids of the scene, or some."""
    system: System

    def array(self, name: str) -> np.ndarray:
        """Positions ``x`` [m], shape (N, 3), or a property ``d_NAME`` of each particle, shape (N,)."""

    def column(self, name: str) -> np.ndarray:
        """Values of a declared column now: of particles, shape (N, ...), springs, (S, ...), or objects, (M, ...)."""

    def pairs(self, fix: str, field: Field) -> np.ndarray:
        """Values that a fix keeps for pairs of objects, in its records: `fields.pair_rows` by ascending pairs."""

    def elastic_energy(self) -> float:
        """Energy of all springs [J]."""

    def damping_loss(self) -> float:
        """Energy that dashpots have taken so far [J]."""

    def bond_seconds(self) -> float:
        """Wall seconds of the springs so far."""

    def fix_scalar(self, fix: str) -> float:
        """Energy of a fix [J]."""

    def fix_value(self, fix: str, entry: str | int) -> float:
        """Entry of a fix's vector, by its name in the list of the fix's page, or by its place from 0."""

    def fix_rows(self, fix: str, rows: int, columns: int) -> np.ndarray:
        """The first rows of a fix's array, shape (rows, columns)."""

    def call(self, what: str, function: str, fix: str, *arguments: Any) -> None:
        """Call a C function of the plugin that asks a fix; arrays are given as pointers. Raises SetupError."""

    def fix_seconds(self, fix: str) -> float:
        """Wall seconds of one of our fixes so far."""
