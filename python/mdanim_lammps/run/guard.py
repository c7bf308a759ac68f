# SPDX-License-Identifier: GPL-2.0-only
"""The guard: looks at the state of every frame, and stops a run that has gone wrong, with the cause and a way out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..effects.fields import Fields
from ..engine.geometry import Geometry
from ..errors import DivergedError, Problem
from ..model.system import System
from ..reach import wave_speed
from ..results.ledger import Ledger
from ..scene.formatting import number, say
from ..scene.scene import Accuracy, SceneRecord
from .observe import Observation
from .prepare import Prepared

CLASSES = {Accuracy.PREVIEW: 1e-2, Accuracy.BALANCED: 1e-3, Accuracy.REFERENCE: 1e-4}
"""Largest energy residual that a scene without losses is to have, by its accuracy."""
RESIDUAL_FACTOR, LEAST_RESIDUAL = 50.0, 0.05
"""The run stops at this multiple of the class, and never below this residual."""
RINGS = 10.0
"""Times that a wave crosses an object until cells that are inside out count as stuck: in a hard impact some at the surface are so
for a moment, and come back."""
CRUMPLED = 0.05
"""Part of the cells of a solid that may stay inside out: a dent, with which a body keeps its shape and its energy. With more of
them it does not (docs/physics-solids.md)."""
SQUEEZED = "it is probably hit or squeezed harder than its lattice bears"
TOO_LONG = "the step is probably too long for what happens here: no cell is inside out"
"""The cause given for a stop where every margin is kept."""
FLOWN_APART = (
    "lost its bond partner",
    "springs were given",
    "Bond atoms",
    "Lost atoms",
    "Non-numeric",
    "Out of range atoms",
    "out of range",
)
"""Parts of messages of LAMMPS about particles where they should not be."""


class Guard:
    """Watches a run, and keeps its findings so far."""

    def __init__(self, ready: Prepared, folder: Path):
        self.ready, self.folder = ready, folder
        self.cells = np.diff(Geometry(ready.system).first_cell)
        """Number of cells of each solid, shape (M,)."""
        self.sides = ready.context.reach.acting.planes
        self.columns = [s.axis if s.sign > 0 else 3 + s.axis for s in self.sides]
        """Column of an object's reach: the one towards the plane, for objects below it."""
        self.allowed = np.where(ready.system.still, np.inf, ready.system.spacing)[:, None]
        """How far beyond a plane solids may be [m], shape (M, 1); those of which nothing can move, anywhere."""
        self.limit = max(LEAST_RESIDUAL, RESIDUAL_FACTOR * energy_class(ready.scene))
        self.inverted = self.since = np.zeros(0, np.int64)
        """Cells that were inside out at the last look, ascending, and the step since which each has been so at every frame."""
        self.crumpled = False
        """Whether some cell was inside out at the last look."""
        self.most_inverted = 0
        self.dents: dict[int, int] = {}
        """Most cells of a solid that have stayed inside out."""
        self.folds: dict[int, tuple[int, np.ndarray, int]] = {}
        """For each solid that has folded through itself: the step at which that was seen, the place [m], shape (3,), and the most
        particles that lay among others of it."""
        low, high = ready.system.bounds(ready.system.position)
        self.patience = RINGS * (high - low).max(1) / wave_speed(ready.system) / ready.certificate.timestep
        """Steps that a cell of each solid may stay inside out, shape (M,)."""

    def check(self, step: int, seen: Observation) -> None:
        """Raise DivergedError when what all objects of the scene tell is not what bodies in their places tell."""
        system = self.ready.system
        if seen.not_finite is not None:
            raise self.error_at(
                step,
                "its positions or velocities are NaN or infinite",
                system.object[seen.not_finite],
                "time step",
                "amplitude",
                "load",
            )
        if len(seen.inverted) or self.crumpled:
            self._look_at_cells(step, seen.inverted)
        self._look_at_sides(step, seen.reach)
        for n in np.flatnonzero(seen.folded).tolist():
            when, where, most = self.folds.get(m := int(seen.objects[n]), (step, seen.fold[n], 0))
            self.folds[m] = when, where, max(most, int(seen.folded[n]))
        if seen.sunk:
            m, other = seen.sunk
            limits = ("narrow part", "slim tip", "closing speed", "time step", "amplitude", "thinnest part")
            raise self.error_at(step, f"it is inside {system.names[other]}", m, *limits)

    def _look_at_cells(self, step: int, cells: np.ndarray) -> None:
        """Cells may be inside out for a moment only; these are so, ascending."""
        self.crumpled = len(cells) > 0
        self.most_inverted = max(self.most_inverted, len(cells))
        since = np.full(len(cells), step)
        _, now, before = np.intersect1d(cells, self.inverted, assume_unique=True, return_indices=True)
        since[now] = self.since[before]
        self.inverted, self.since = cells, since
        owner = self.ready.system.object[self.ready.system.hexahedron[cells, 0]]
        stuck = np.bincount(owner[step - since > self.patience[owner]], minlength=len(self.patience))
        for m in np.flatnonzero(stuck).tolist():
            self.dents[m] = max(self.dents.get(m, 0), int(stuck[m]))
        parts = stuck / np.maximum(self.cells, 1)
        m = int(parts.argmax())
        if parts[m] > CRUMPLED and not self.ready.insist:
            raise self.error_at(
                step,
                f"{stuck[m]} of its {self.cells[m]} cells have been inside out since step "
                f"{since[owner == m].min()}; springs do not tell a cell from its mirror image, so these would stay so",
                m,
                "amplitude",
                "load",
                "time step",
                "closing speed",
            )

    def _look_at_sides(self, step: int, reach: np.ndarray) -> None:
        """An object has left when all of its box is beyond a plane, by more than a spacing;
        ``reach`` as in `Observation`."""
        if not self.sides:
            return
        places = [side.at_time(step * self.ready.certificate.timestep) for side in self.sides]
        beyond = np.array([side.sign * at for side, at in zip(self.sides, places)]) - reach[:, self.columns]
        gone = beyond > self.allowed
        if gone.any():
            n = int(np.where(gone, beyond, -np.inf).argmax())
            m, k = divmod(n, len(self.sides))
            side, at = self.sides[k], say(places[k], "m", 6)
            raise self.error_at(
                step,
                f"it has left {side.name}: all of it is beyond {'xyz'[side.axis]} = {at}, by {say(float(beyond.flat[n]), 'm')}",
                m,
                "time step",
                "amplitude",
                "load",
            )

    def energy(self, step: int, residual: float, speed: np.ndarray) -> None:
        """Raise DivergedError when the energies do not add up any more. ``residual`` as in results/ledger.py, ``speed`` as in
        `Observation`."""
        if self.ready.scene.lammps:
            return  # the work of its commands is not in the ledger
        if not abs(residual) <= self.limit:
            raise self.error_at(
                step,
                f"the energies do not add up, residual {number(residual)}; its particles are the fastest",
                fastest_for_its_waves(self.ready.system, speed),
                "time step",
                "amplitude",
                "load",
                "closing speed",
                suspicion=SQUEEZED if self.crumpled else TOO_LONG,
            )

    def fields(self, step: int, fields: Fields) -> None:
        """Raise DivergedError where an effect finds a fault in the fields of a frame."""
        time = step * self.ready.certificate.timestep
        for effect in self.ready.plan.effects:
            if fault := effect.fault(self.ready.scene, time, fields):
                kept = f"{self._kept()[0].upper()}{self._kept()[1:]}"
                raise DivergedError(f"{self._when(step)}: internal error: {fault}; please report it. {kept}")

    def explain_failure(self, step: int, error: DivergedError, solid: int | None) -> DivergedError:
        """The error for LAMMPS's own end of a run in the steps up to this one; ``solid`` is the `fastest`."""
        words = " ".join(str(error).split())
        if any(sign in words for sign in FLOWN_APART):
            suspect = self.ready.system.names.index(self.ready.certificate.object) if solid is None else solid
            return self.error_at(step, words, suspect, "time step", "amplitude", "load", "closing speed")
        return DivergedError(f"{self._when(step)}: {words}", self._kept())

    def error_at(self, step: int, what: str, m: int, *margins: str, suspicion: str = SQUEEZED) -> DivergedError:
        """The error that stops the run at a step for what solid ``m`` does;
        the first of these margins that is passed says why, and where none is the suspicion."""
        cause, cure = self._why(margins, suspicion)
        return DivergedError(
            f"{self._when(step)}: {self.ready.system.names[m]}: {what}.\n  cause: {cause}\n  change: {cure}", self._kept()
        )

    def _why(self, margins: Sequence[str], suspicion: str) -> tuple[str, str]:
        """Cause and cure: of the first of these margins that is passed, where none is the suspicion."""
        c = self.ready.certificate
        passed = {found.name: found for found in reversed(c.margins) if found.severity != "ok"}
        why = next((passed[name] for name in margins if name in passed), None)
        if why:
            return why.text, why.hint
        return (
            f"every limit of the certificate is kept (time step {c.fraction:.2f} of the bound), so {suspicion}",
            "try a lower speed, a stiffer object, a coarser resolution (edges, corners and tips of fine lattices "
            "fold first) or a smaller timestep",
        )

    def _when(self, step: int) -> str:
        return f"step {step}, t = {number(step * self.ready.certificate.timestep, 4)} s"

    def _kept(self) -> str:
        return f"the last good frame and checkpoint are kept in {self.folder}"

    def warnings(self, ledger: Ledger) -> list[Problem]:
        """Warnings about a finished run: where bodies have got dents or folded through themselves, and whether it has missed the
        class of energy of its accuracy."""
        scene, goal, found = self.ready.scene, energy_class(self.ready.scene), []
        if self.dents:
            m = max(self.dents, key=lambda m: self.dents[m] / self.cells[m])
            cause, cure = self._why(("amplitude", "load"), SQUEEZED)
            others = f" and {len(self.dents) - 1} more" if len(self.dents) > 1 else ""
            found.append(
                Problem(
                    scene.solids[m].spans.get("elasticity"),
                    f"{self.ready.system.names[m]}{others} got a dent: {self.dents[m]} of its "
                    f"{self.cells[m]} cells have been turned inside out by a blow; {cause}",
                    cure,
                    severity="warning",
                )
            )
        found += self._folded()
        if ledger.residual > goal:
            found.append(self._missed(ledger, goal))
        return found

    def _folded(self) -> list[Problem]:
        if not self.folds:
            return []
        scene, dt = self.ready.scene, self.ready.certificate.timestep
        m = min(self.folds, key=lambda m: self.folds[m][0])
        step, place, most = self.folds[m]
        others = f" and {len(self.folds) - 1} more" if len(self.folds) > 1 else ""
        near = "(" + ", ".join(number(c, 3) for c in place.tolist()) + ") m"
        spans, acts = scene.solids[m].spans, "contact acts between objects, not between parts of one"
        ways = "write touches-itself yes in it, or a higher elasticity, a lower density, speed or height"
        if scene.solids[m].touches_itself.value == "yes":
            acts = "its parts touch each other, and came too fast for that, or are too near each other in its shape"
            ways = "write a higher elasticity, a lower density, speed or height, or a finer resolution"
        return [
            Problem(
                spans.get("elasticity"),
                f"{self.ready.system.names[m]}{others} folds through itself, from t = {number(step * dt, 4)} s on near {near}: "
                f"up to {most} of its particles lie among others of it; {acts}",
                ways,
                severity="warning",
            )
        ]

    def _missed(self, ledger: Ledger, goal: float) -> Problem:
        """The energies do not add up as well as they should: names the frame in which most of the error arose, and the events
        there."""
        scene, rows = self.ready.scene, ledger.rows
        change = [abs(b["residual"] - a["residual"]) for a, b in pairwise(rows)]
        worst = change.index(max(change))
        if scene.lammps:
            cause = f"the energy residual {number(ledger.residual)} holds the work of the scene's commands for LAMMPS"
            return Problem(scene.lammps[0].span, cause, "the ledger knows nothing of it", severity="warning")
        cause, cure = "", ", a smaller timestep, or some damping: impacts add energy to undamped objects"
        touched = {e.ledger for e in self.ready.plan.effects if e.touches and e.rests_inside}
        if any(rows[k].get(term) for k in (worst, worst + 1) for term in touched):
            cause, cure = ", where surfaces met: a step is long for the onset of their contact", " or a smaller timestep"
        return Problem(
            scene.control.spans.get("accuracy"),
            f"the energy residual {number(ledger.residual)} is above {number(goal)}, which "
            f"'accuracy {scene.control.accuracy.value}' stands for; most of it came from "
            f"t = {number(rows[worst]['time'], 4)} to {number(rows[worst + 1]['time'], 4)} s" + cause,
            f"where it matters, write a higher accuracy{cure}",
            severity="warning",
        )


def fastest(system: System, v: np.ndarray) -> int | None:
    """The solid with the fastest particle for its wave speed, or one that is not finite; None when LAMMPS has lost particles.

    v [m/s], shape (N, 3).
    """
    if len(v) < system.particles:
        return None
    return fastest_for_its_waves(system, np.maximum.reduceat(np.abs(v).max(1), system.first[:-1]))


def fastest_for_its_waves(system: System, speed: np.ndarray) -> int:
    """The solid with the highest of these speeds over its wave speed, or one whose speed is NaN; [m/s], shape (M,)."""
    return int((np.nan_to_num(speed, nan=np.inf) / wave_speed(system)).argmax())


def energy_class(scene: SceneRecord) -> float:
    """Energy residual that the scene's accuracy stands for [-]."""
    return CLASSES[scene.control.accuracy]
