# SPDX-License-Identifier: GPL-2.0-only
"""The facets of an effect: small interfaces, each for one reader, with defaults for an effect that has nothing to say there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..errors import Problem
from ..model.grid import Grid
from ..model.model import Model
from ..model.system import System
from ..scene.scene import SceneRecord
from .context import Context, Resolved
from .envelope import Envelope
from .fields import Field, Fields
from .margin import Margin
from .measured import Measured
from .readings import Readings


class Bounds:
    """Share of an effect in the bound on the time step, and its limits of a scene."""

    def rate(self, context: Context) -> np.ndarray | None:
        """Its share in the bound on the squared frequency of each particle, 2 lambda_max(D_i)/m_i [1/s^2], shape (N,)."""
        return None

    def own_rate(self, context: Context) -> np.ndarray | None:
        """The part of `rate` that comes of points of a particle's own surface in something else [1/s^2], shape (N,).

        No point is in two things at once: of these parts of all effects the largest alone counts.
        """
        return None

    def drag_rate(self, context: Context) -> np.ndarray | None:
        """The same as `rate` of its forces that depend on velocity, such as dashpots: 2 lambda_max(C_i)/m_i [1/s], shape (N,)."""
        return None

    def max_timestep(self, context: Context) -> float:
        """Longest time step that still resolves its motion [s]; stability is another matter, see `rate`."""
        return math.inf

    def friction(self, context: Context) -> np.ndarray | None:
        """Upper bound of its addition to each particle's lambda of the leap-frog, eq. (3.9) [N*s/m], shape (N,).

        A drag that a fix adds as a force has a `drag_rate` instead.
        """
        return None

    def margins(self, envelope: Envelope) -> list[Margin]:
        """Limits that a scene in which something can move has to keep because of the effect, each with the value that the scene
        reaches."""
        return []


class Accounts:
    """Its energies, losses and counts: columns of the ledger, entries of the summary, and seconds."""

    ledger = ""
    """The column of ledger.csv with the energy that it stores; empty when it stores none."""
    further_ledger: tuple[str, ...] = ()
    """Further columns of that kind, see `further_energies`."""
    has_potential = False
    """Whether its energy is a `potential`, that of a uniform field; no other effect has the same column then."""
    has_arbitrary_zero = False
    """Whether only changes of the energy in its column ``ledger`` have a meaning; that is always so for a potential."""
    gains = ""
    """Name of what it counts, see `gained`."""

    def energy(self, readings: Readings) -> float:
        """Present value of its column ``ledger`` [J]."""
        return self.potential(readings.context.scene, readings.system.mass, readings.array("x")) if self.has_potential else 0.0

    def kinetic(self, readings: Readings) -> float:
        """Kinetic energy of the solids that its fix moves in place of the leap-frog [J]."""
        return 0.0

    def drag_taken(self, readings: Readings) -> float:
        """Energy that drag has taken of these solids since the instance was made [J]."""
        return 0.0

    def further_energies(self, readings: Readings) -> dict[str, float]:
        """Present values of its columns ``further_ledger`` [J]."""
        return {}

    def potential(self, scene: SceneRecord, mass: np.ndarray, x: np.ndarray) -> float:
        """Its energy in a uniform field [J]; mass [kg], shape (n,), and x [m], shape (n, 3), are those of particles or, for
        the same energy, of objects and their centres of mass."""
        raise NotImplementedError

    def weighed(self, scene: SceneRecord, system: System) -> float:
        """Weights of all that it has a part in, times their distances from the origin [J]: as much as a run rounds."""
        return 0.0

    def unsettled(self, scene: SceneRecord, system: System) -> float:
        """Energy of vibrations that no account follows [J]."""
        return 0.0

    def sources(self, scene: SceneRecord) -> tuple[str, ...]:
        """The columns of ledger.csv with energies that it has brought in from outside so far; `lost` has their values, too."""
        return ()

    def losses(self, scene: SceneRecord) -> tuple[str, ...]:
        """The columns of ledger.csv with the energies that it has taken so far."""
        return ()

    def lost(self, readings: Readings) -> dict[str, float]:
        """Present values of the columns of `losses` and `sources` [J], counted since the instance was made: resumed runs and
        executors add what was before."""
        return {}

    def gained(self, first: Mapping[str, float], now: Mapping[str, float]) -> float | None:
        """Excess of a quantity that must be conserved, by two rows of the ledger; 0, or something is wrong. None for an effect
        that counts nothing."""
        return None

    def summary(self, first: Mapping[str, float], last: Mapping[str, float]) -> dict[str, float]:
        """Entries of summary.json, by two rows of the ledger."""
        return {}

    def counted(self, context: Context) -> tuple[str, dict]:
        """Text that ``check`` prints behind the number of particles, and its entries in the output for programs."""
        return "", {}

    def clocks(self, readings: Readings) -> dict[str, float]:
        """Wall seconds so far of each of its pieces.

        A piece that runs under the clock of another style has its part of that clock, as ``python bench/effects.py shares``
        measures it.
        """
        return {self.fix: readings.fix_seconds(self.fix)} if self.fix else {}


class Frames:
    """Values of an effect in every frame."""

    def fields(self, scene: SceneRecord) -> tuple[Field, ...]:
        """Fields that it has in a frame."""
        return ()

    def tell(self, readings: Readings) -> Fields:
        """The values of these `fields` now, of the part of the scene that is simulated there."""
        return {}

    def tell_start(self, context: Context) -> Fields:
        """The values of those per pair at the start, where they follow from the scene alone: for a picture before any step."""
        return {}

    def fault(self, scene: SceneRecord, time: float, fields: Fields) -> str:
        """Fault of a frame at this time [s] that can never be right, in words; empty where all is well."""
        return ""

    def penetration(self, readings: Readings) -> float:
        """Largest depth at which something has been where it should not be, in this run [m]."""
        return 0.0


class Passes:
    """Takes the steps."""

    in_passes = True
    """Whether passes over the particles have it in them."""


class StandardSteps(Passes):
    """An effect that passes do not have in them: beside it LAMMPS takes its standard steps, of which threads share less."""

    in_passes = False


class Advice:
    """Remarks on an effect, of ``check`` and of a run."""

    def problems(self, resolved: Resolved, models: Sequence[Model], grid: Grid | None) -> list[Problem]:
        """Parts of the start that it cannot work with."""
        return []

    def warnings(self, context: Context) -> list[Problem]:
        """Doubts about the start of a scene that the effect is on in."""
        return []

    def notes(self, envelope: Envelope) -> list[Problem]:
        """Further remarks of ``check`` on a scene in which something can move: nothing is doubtful, but it may not be known."""
        return []

    def doubts(self, context: Context, run: Measured) -> list[Problem]:
        """Doubts about a run that has ended, and what may not be known of it."""
        return []
