# SPDX-License-Identifier: GPL-2.0-only
"""A table with a row for each object and frame; its columns are what the frames hold, and nothing that they do not."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..effects.fields import BENT, GROWN
from ..errors import MdanimError
from ..model.build import build_models
from ..model.spacing import plan_spacing
from ..model.system import System, assemble
from ..results.motion import MotionTable
from ..results.trajectory import Trajectory
from .cut import Cut

MORE = 4
"""How many times as many particles may be foreseen as there turn out to be."""


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    table, t = MotionTable(cut.trajectory, cut.objects), cut.trajectory
    notes = ["lengths are metres, velocities m/s, spin (wx, wy, wz) rad/s, energies J"]
    if table.forces.why:
        notes.append(f"contact forces are left out: {table.forces.why}")
    else:
        notes.append("contact_fx, contact_fy, contact_fz [N] are means since the frame before, by momentum")
    system = system_of(t) if table.whole else None
    if not table.whole:
        notes.append("spin and energy are left out: the run has stored boundary particles only; set 'save all'")
    elif system is None:
        notes.append("elastic energy is left out: the scene of this run, or one of its meshes, cannot be read here")
    with open(folder / f"{stem}.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*table.columns, *(["elastic"] if system else []), *cut.of_objects(cut.frames[0])])
        for done, frame in enumerate(cut.frames.tolist(), 1):
            numbers = table.numbers(frame)
            if system:
                energy = elastic(system, t.position(frame), t.gone(frame), grown_in(t, frame))
                energy[np.unique(system.object[_is_bent(t, frame)])] = np.nan
                numbers = np.column_stack([numbers, energy[cut.objects]])
            numbers = np.column_stack([numbers, *cut.of_objects(frame).values()])
            time = float(t.times[frame])
            rows = (["" if number != number else number for number in row] for row in numbers.tolist())
            writer.writerows((frame, time, name, *row) for name, row in zip(cut.metadata.names, rows))
            on_frame(done)
    return notes


def system_of(trajectory: Trajectory) -> System | None:
    """Springs and particles as the stored scene has them; None where it cannot be read, or is another one.

    A scene that would have far more particles than the run is not built.
    """
    m, scene = trajectory.metadata, trajectory.scene
    try:
        if scene is None or plan_spacing(scene).total > MORE * m.total:
            return None
        forms = (assemble(build_models(scene, inside=inside), scene) for inside in (False, True))
        return next((one for one in forms if tuple(one.names) == m.names and one.particles == m.total), None)
    except MdanimError:  # its meshes are elsewhere
        return None


def grown_in(trajectory: Trajectory, frame: int) -> np.ndarray | float:
    """By how much the rest lengths of springs have changed for good in a frame [m], shape (S,); 0 where none may."""
    return trajectory.field(GROWN, frame) if GROWN in [field.name for field in trajectory.metadata.fields] else 0.0


def _is_bent(trajectory: Trajectory, frame: int) -> np.ndarray:
    """Particles of sheets across which something is bent for good, whose energy is not in springs alone, bool, shape (N,)."""
    if BENT not in [field.name for field in trajectory.metadata.fields]:
        return np.zeros(trajectory.metadata.total, bool)
    return trajectory.field(BENT, frame).any(axis=1)


def elastic(system: System, position: np.ndarray, gone: np.ndarray | None = None, grown: np.ndarray | float = 0.0) -> np.ndarray:
    """Energy of the springs of each object [J], shape (O,), for positions of all particles [m], shape (N, 3), the ends of
    springs that are gone, shape (G, 2), and `grown_in`; NaN for objects that are torn, whose springs are no longer those of the
    scene."""
    i, j = system.spring.T
    stretch = np.linalg.norm(position[i] - position[j], axis=1) - system.rest - grown
    energy = 0.5 * system.stiffness * stretch**2 - system.preload_energy + system.preload * grown
    found = np.bincount(system.object[i], energy, len(system.names)).astype(float)  # integers where there is no spring
    if gone is not None:
        found[np.unique(system.object[gone[:, 0]])] = np.nan
    return found
