# SPDX-License-Identifier: GPL-2.0-only
"""The interface of an effect: when a scene calls for it, its lines in LAMMPS's input, and its parts of the ledger and of the
bound."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from ..errors import Problem
from ..model.grid import Grid
from ..model.model import Model
from ..model.planes import Plane
from ..model.system import System
from ..reach import Bodies, Drive, Reach
from ..scene.formatting import number
from ..scene.scene import ContactModel, SceneRecord
from .context import Context, Resolved, Verdict
from .envelope import Envelope
from .fields import Field, Fields
from .margin import Margin
from .readings import Readings


class Effect:
    """One physical effect. A subclass is one file in a folder of features/ and holds everything that belongs to the effect.

    An effect that is off leaves no trace: no column, no command, no term.
    """

    name = ""
    """As in ``effects { name off }``; also its name in the cost table."""
    styles: tuple[tuple[str, str], ...] = ()
    """Styles of the plugin that it uses: kind and name."""
    order = 1000
    """Place of its forces in the sum of all, ascending, by name where two have the same."""
    fix = ""
    """ID of its LAMMPS fix of ours, which times itself; empty when it has none."""
    ledger = ""
    """The column of ledger.csv with the energy that it stores; empty when it stores none."""
    further_ledger: tuple[str, ...] = ()
    """Further columns of that kind, see `further_energies`."""
    has_potential = False
    """Whether its energy is a `potential`, that of a uniform field; no other effect has the same column then."""
    has_arbitrary_zero = False
    """Whether only changes of the energy in its column ``ledger`` have a meaning; that is always so for a potential."""
    on_grid = False
    """Whether it uses the cells of a `grid`, as a whole that one process has."""
    touches = False
    """Whether it acts where surfaces meet."""
    presses = False
    """Whether it is on only where objects are likely to be pressed against something."""
    at_surfaces = False
    """Whether it costs next to nothing until surfaces meet."""
    brakes = False
    """Whether it makes dashpots along springs."""
    binds = False
    """Whether it holds the particles of a solid together."""
    sees_driven = True
    """Whether held particles act on it as they move where they are driven; else a scene with both is refused."""
    keeps_apart = False
    """Whether objects cannot be inside each other where it is on."""
    needs: tuple[str, ...] = ()
    """Effects that this one requires; they stand before it in the sum."""
    gains = ""
    """Name of what it counts, see `gained`."""
    if_off = ""
    """Fault that shows when a scene needs the effect and it is switched off."""

    def __init__(self, on_surfaces: Effect | None = None):
        self.on_surfaces = on_surfaces
        """The effect that takes its place under ``contact-model surface``; None where it is the same."""

    def of(self, scene: SceneRecord) -> Effect:
        """The effect that takes its place under the contact model of a scene."""
        surface = scene.control.contact_model is ContactModel.SURFACE
        return self.on_surfaces if surface and self.on_surfaces else self

    def called_for(self, scene: SceneRecord, reach: Reach) -> Verdict:
        """Whether the scene, by itself, calls for the effect; ``reach`` tells where solids can be by all effects that are not
        switched off."""
        raise NotImplementedError

    # --- how it moves solids: what reach/ asks, of any scene -------------------------------------------------------------

    def acceleration(self, scene: SceneRecord) -> np.ndarray | None:
        """Acceleration that it gives to everything that is free to move [m/s^2], shape (3,); None for nothing."""
        return None

    def planes(self, scene: SceneRecord) -> tuple[Plane, ...]:
        """The planes that push solids back, whether the effect is on or not."""
        return ()

    def slows(self, scene: SceneRecord) -> np.ndarray | None:
        """Solids that it slows down wherever they are, bool, shape (M,)."""
        return None

    def rough(self, scene: SceneRecord) -> np.ndarray | None:
        """Solids that its planes may push along themselves, bool, shape (M,)."""
        return None

    def pushes_below(self, scene: SceneRecord) -> float:
        """Height below which it may push solids in any direction [m]; minus infinity where it does so nowhere."""
        return -math.inf

    def most_push(self, scene: SceneRecord, bodies: Bodies) -> np.ndarray | float:
        """Largest force of that kind on each solid over its mass [m/s^2], shape (M,)."""
        return 0.0

    def surface(self, scene: SceneRecord) -> float | None:
        """Height below which solids are immersed in it [m]; None where it immerses nothing."""
        return None

    def lift(self, scene: SceneRecord, system: System) -> np.ndarray | float:
        """Part of the mass of each immersed solid that it carries [kg], shape (M,)."""
        return 0.0

    def untold(self, scene: SceneRecord) -> str:
        """Reason why frames do not tell its forces on objects from those of contact; empty where they do."""
        return ""

    def joins(self, scene: SceneRecord) -> Iterable[tuple[int, int]]:
        """Pairs of solids, by number, that it couples wherever they are: one process simulates both."""
        return ()

    def drives(self, scene: SceneRecord) -> Mapping[int, Drive]:
        """Motions that it gives to the held particles of solids, by number. Its fix, in the group `Context.pushed`, sets their
        positions and velocities, and counts the work that they do."""
        return {}

    # --- what it brings into a run --------------------------------------------------------------------------------------

    def grid(self, scene: SceneRecord, h: float) -> Grid | None:
        """Cells that it uses, for a particle spacing h [m]; None where it needs none. Raises SceneError where they do not fit in
        memory."""
        return None

    def problems(self, resolved: Resolved, models: Sequence[Model], grid: Grid | None) -> list[Problem]:
        """Parts of the start that it cannot work with."""
        return []

    def columns(self, context: Context) -> dict[Field, np.ndarray]:
        """Values at the start of all particles, springs or objects, each of shape (N, ...), (S, ...) or (M, ...), by their
        `fields.column`: its commands name them as ``d_NAME`` and the like.

        With ``body``, the kind of each particle's body (System.contact_kind), its fix is given the contact bodies of all kinds.
        """
        return {}

    def commands(self, context: Context) -> list[str]:
        """LAMMPS commands; group ``mobile`` exists by then."""
        return []

    def rate(self, context: Context) -> np.ndarray | None:
        """Its share in the bound on the squared frequency of each particle, 2 lambda_max(D_i)/m_i [1/s^2], shape (N,)."""
        return None

    def own_rate(self, context: Context) -> np.ndarray | None:
        """The part of `rate` that comes of points of a particle's own surface in something else [1/s^2], shape (N,).

        No point is in two things at once: of these parts of all effects the largest alone counts.
        """
        return None

    def drag_rate(self, context: Context) -> np.ndarray | None:
        """The same as `rate` of its dashpots, 2 lambda_max(C_i)/m_i [1/s], shape (N,)."""
        return None

    def max_timestep(self, context: Context) -> float:
        """Longest time step that still resolves its motion [s]; stability is another matter, see `rate`."""
        return math.inf

    def friction(self, context: Context) -> np.ndarray | None:
        """Upper bound of its addition to each particle's lambda, eq. (3.9) [N*s/m], shape (N,)."""
        return None

    def energy(self, readings: Readings) -> float:
        """Present value of its column ``ledger`` [J]."""
        return self.potential(readings.context.scene, readings.system.mass, readings.array("x")) if self.has_potential else 0.0

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

    def counted(self, context: Context) -> tuple[str, dict]:
        """Text that ``check`` prints behind the number of particles, and its entries in the output for programs."""
        return "", {}

    def sources(self, scene: SceneRecord) -> tuple[str, ...]:
        """The columns of ledger.csv with energies that it has brought in from outside so far; `lost` has their values, too."""
        return ()

    def losses(self, scene: SceneRecord) -> tuple[str, ...]:
        """The columns of ledger.csv with the energies that it has taken so far."""
        return ()

    def lost(self, readings: Readings) -> dict[str, float]:
        """Present values of the columns of `losses` and `sources` [J]."""
        return {}

    def margins(self, envelope: Envelope) -> list[Margin]:
        """Limits that a scene in which something can move has to keep because of the effect, each with the value that the scene
        reaches."""
        return []

    def fields(self, scene: SceneRecord) -> tuple[Field, ...]:
        """Fields that it has in a frame."""
        return ()

    def tell(self, readings: Readings) -> Fields:
        """The values of these `fields` now, of the part of the scene that is simulated there."""
        return {}

    def fault(self, scene: SceneRecord, time: float, fields: Fields) -> str:
        """Fault of a frame at this time [s] that can never be right, in words; empty where all is well."""
        return ""

    def doubts(self, context: Context, time: float, ledger: Callable[[str], np.ndarray]) -> list[Problem]:
        """Doubts about a run of this length [s] that has ended; ``ledger`` gives a column."""
        return []

    def gained(self, first: Mapping[str, float], now: Mapping[str, float]) -> float | None:
        """Excess of a quantity that must be conserved, by two rows of the ledger; 0, or something is wrong. None for an effect
        that counts nothing."""
        return None

    def summary(self, first: Mapping[str, float], last: Mapping[str, float]) -> dict[str, float]:
        """Entries of summary.json, by two rows of the ledger."""
        return {}

    def acts_on(self, context: Context) -> bool:
        """Whether it acts on anything in a part of a scene: some of its solids, with or without the cells of a grid."""
        return True

    def matters_below(self, context: Context) -> float:
        """Height from which on a solid does not matter to its cells, nor these to the solid [m]."""
        return -math.inf

    def warnings(self, context: Context) -> list[Problem]:
        """Doubts about the start of a scene that the effect is on in."""
        return []

    def notes(self, envelope: Envelope) -> list[Problem]:
        """Further remarks of ``check`` on a scene in which something can move: nothing is doubtful, but it may not be known."""
        return []

    def gap(self, context: Context) -> np.ndarray | float:
        """Gap from which on a solid does not feel another by it, the larger one of both counts [m], shape (M,)."""
        return 0.0

    @property
    def fixes(self) -> tuple[str, ...]:
        """IDs of the fixes whose scalars are its energy."""
        return (self.fix,) if self.fix else ()

    def clocks(self, readings: Readings) -> dict[str, float]:
        """Wall seconds so far of each of its pieces.

        A piece that runs under the clock of another style has its part of that clock, as ``python bench/effects.py shares``
        measures it.
        """
        return {self.fix: readings.fix_seconds(self.fix)} if self.fix else {}

    def penetration(self, readings: Readings) -> float:
        """Largest depth at which something has been where it should not be, in this run [m]."""
        return 0.0


def stiffness_told(scene: SceneRecord) -> str:
    """Addition to the reason of an effect that pushes back, about ``contact-stiffness``; empty where it is the usual one."""
    factor = scene.control.contact_stiffness
    return "" if factor == 1.0 else f", {number(factor)} times as stiff as usual"
