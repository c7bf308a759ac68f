# SPDX-License-Identifier: GPL-2.0-only
"""The interface of an effect: when a scene calls for it, its lines in LAMMPS's input, and its parts of the ledger and of the
bound."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..model.grid import Grid
from ..model.model import Model
from ..reach import Motion, Reach
from ..scene.scene import SceneRecord
from .context import Context, Verdict
from .facets import Accounts, Advice, Bounds, Frames, Passes
from .fields import Field
from .steered import Steered


class Effect(Motion, Passes, Bounds, Accounts, Frames, Steered, Advice):
    """One physical effect. A subclass is one file in a folder of features/ and holds everything that belongs to the effect.

    An effect that is off leaves no trace: no column, no command, no term. Each facet has defaults that say nothing, so a subclass
    has what its law needs; a facet is what one reader asks: reach/, the certificate, the ledger, frames, messages. The docstring
    of a subclass names its equation, "eq. (N)", or its page, "docs/physics-...".
    """

    name = ""
    """As in ``effects { name off }``; also its name in the cost table."""
    styles: tuple[tuple[str, str], ...] = ()
    """Styles of the plugin that it uses: kind and name."""
    order = 1000
    """Place of its forces in the sum of all, ascending, by name where two have the same."""
    fix = ""
    """ID of its LAMMPS fix of ours, which times itself; empty when it has none."""
    on_grid = False
    """Whether it uses the cells of a `grid`, as a whole that one process has."""
    touches = False
    """Whether it acts where surfaces meet."""
    presses = False
    """Whether it is on only where objects are likely to be pressed against something."""
    at_surfaces = False
    """Whether it costs next to nothing until surfaces meet."""
    rests_inside = 0.0
    """Part of a spacing by which surfaces that rest on each other by it may be in each other; 0 where it acts before they
    meet."""
    keeps_apart = False
    """Whether objects cannot be inside each other where it is on."""
    needs: tuple[str, ...] = ()
    """Effects that this one requires; they stand before it in the sum."""
    if_off = ""
    """Fault that shows when a scene needs the effect and it is switched off."""

    @property
    def forms(self) -> tuple[Effect, ...]:
        """All that `of` may give."""
        return (self,)

    def of(self, scene: SceneRecord) -> Effect:
        """The effect that takes its place in a scene."""
        return self

    def called_for(self, scene: SceneRecord, reach: Reach) -> Verdict:
        """Whether the scene, by itself, calls for the effect; ``reach`` tells where solids can be by all effects that are not
        switched off."""
        raise NotImplementedError

    # --- what it brings into a run --------------------------------------------------------------------------------------

    def grid(self, scene: SceneRecord, h: float) -> Grid | None:
        """Cells that it uses, for a particle spacing h [m]; None where it needs none. Raises SceneError where they do not fit in
        memory."""
        return None

    def needs_inside(self, context: Context) -> bool:
        """Whether it acts on particles inside of what never moves, which otherwise has the corners of a box alone."""
        return False

    def columns(self, context: Context) -> dict[Field, np.ndarray]:
        """Values at the start of all particles, springs or objects, each of shape (N, ...), (S, ...) or (M, ...), by their
        `fields.column`: its commands name them as ``d_NAME`` and the like.

        With ``body``, the kind of each particle's body (System.contact_kind), its fix is given the contact bodies of all kinds.
        """
        return {}

    def damping_ratio(self, context: Context) -> np.ndarray | None:
        """Fraction of critical damping of the dashpots beside the springs of each solid [-], shape (M,); None for none."""
        return None

    def drag(self, context: Context) -> np.ndarray | None:
        """Its drag of each particle that the leap-frog takes and that never changes, eq. (3.9) [N*s/m], shape (N,); None where it
        brings none. Its column is `leapfrog.LAMBDA`, with `Context.drag`."""
        return None

    def clearance(self, first: Model, second: Model) -> float:
        """Gap between the boxes of two solids from which it has no energy [m]; asked of what keeps solids apart."""
        return 0.0

    def outline(self, scene: SceneRecord, m: int) -> str | None:
        """A solid, by number, as its fix has the features with which it touches: a line of the file of shapes of fix mdanim/rigid
        after the molecule ID (docs/fix_mdanim_rigid.md); None where it touches otherwise."""
        return None

    def commands(self, context: Context) -> list[str]:
        """LAMMPS commands; group ``mobile`` exists by then. A word ``table:NAME`` is the path of one of its `tables`."""
        return []

    def tables(self, context: Context) -> Mapping[str, str]:
        """Texts of files that its commands read, by name."""
        return {}

    def integrates(self, context: Context) -> tuple[np.ndarray, str] | None:
        """Solids that its fix moves in place of the leap-frog, bool, shape (M,), and the group of their particles, which its
        commands make; None for no solid. It takes drag by the same words as the leap-frog. The ledger has their energy by
        `kinetic`, what drag takes by `drag_taken`."""
        return None

    def settles(self, context: Context, *, planes: bool = False) -> tuple[np.ndarray, str] | None:
        """Solids whose contact with each other, or else with planes, is in its own fix, bool, shape (M,), and the group of their
        particles, which its commands make; None for no solid."""
        return None

    def acts_on(self, context: Context) -> bool:
        """Whether it acts on anything in a part of a scene: some of its solids, with or without the cells of a grid."""
        return True

    def matters_below(self, context: Context) -> float:
        """Height from which on a solid does not matter to its cells, nor these to the solid [m]."""
        return -math.inf

    def gap(self, context: Context) -> np.ndarray | float:
        """Gap from which on a solid does not feel another by it, the larger one of both counts [m], shape (M,)."""
        return 0.0

    @property
    def fixes(self) -> tuple[str, ...]:
        """IDs of the fixes whose scalars are its energy."""
        return (self.fix,) if self.fix else ()
