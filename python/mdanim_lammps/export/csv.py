# SPDX-License-Identifier: GPL-2.0-only
"""A table with a row for each object and frame; its columns are what the frames hold, and nothing that they do not."""

from __future__ import annotations

import csv
from collections.abc import Callable
from functools import cached_property
from pathlib import Path

import numpy as np

from ..errors import MdanimError
from ..model.build import build_models
from ..model.system import assemble
from ..results import motion
from ..scene.parse import parse_scene
from ..scene.scene import Save
from .cut import Cut

CENTRE = ("x", "y", "z", "vx", "vy", "vz")
ROTATION = ("wx", "wy", "wz", "kinetic")


class Table:
    """Columns by frame: frame, time [s], object, centre of mass [m], its velocity [m/s]; where all particles are stored also
    spin [rad/s] and kinetic energy [J]; where the folder holds the scene also elastic energy [J]."""

    def __init__(self, cut: Cut):
        self.cut, self.notes = cut, ["contact_force is left out: no frame holds forces"]
        self.columns = ["frame", "time", "object", *CENTRE]
        self._whole = cut.metadata.save is Save.ALL
        self._elastic = self._whole and self._springs is not None
        if self._whole:
            self.columns += ROTATION
        else:
            self.notes.append("spin and energy are left out: the run has stored boundary particles only; set 'save all'")
        if self._elastic:
            self.columns.append("elastic")
        elif self._whole:
            self.notes.append("elastic energy is left out: the scene of this run, or one of its meshes, cannot be read here")

    def frame(self, frame: int) -> list[tuple]:
        """Rows of a frame of the trajectory."""
        cut, t = self.cut, self.cut.trajectory
        numbers = [t.centers[frame, cut.objects], t.center_velocities[frame, cut.objects]]
        if self._whole:
            m, first = cut.metadata, cut.metadata.first[:-1]
            x, v = cut.position(frame), cut.velocity(frame)
            numbers += [motion.spin(m.mass, first, x, v), motion.kinetic(m.mass, first, v)]
        if self._elastic:
            numbers.append(self._energy(t.position(frame))[cut.objects])
        table = np.column_stack(numbers).tolist()
        time = float(t.times[frame])
        return [(int(frame), time, name, *row) for name, row in zip(cut.metadata.names, table)]

    @cached_property
    def _springs(self):
        """Object, ends, length at rest [m] and constant [N/m] of all springs, as the stored scene has them."""
        m = self.cut.trajectory.metadata
        try:
            scene = parse_scene(m.scene_text, folder=self.cut.trajectory.path.parent)
            system = assemble(build_models(scene), scene)
        except MdanimError:  # of an older language, or its meshes are elsewhere
            return None
        if tuple(system.names) != m.names or system.particles != m.total:
            return None
        i, j = system.spring.T
        return system.object[i], i, j, system.rest, system.stiffness

    def _energy(self, position: np.ndarray) -> np.ndarray:
        own, i, j, rest, stiffness = self._springs
        stretch = np.linalg.norm(position[i] - position[j], axis=1) - rest
        return np.bincount(own, 0.5 * stiffness * stretch**2, len(self.cut.trajectory.names))


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    table = Table(cut)
    with open(folder / f"{stem}.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(table.columns)
        for done, frame in enumerate(cut.frames, 1):
            writer.writerows(table.frame(frame))
            on_frame(done)
    return ["lengths are metres, velocities m/s, spin (wx, wy, wz) rad/s, energies J", *table.notes]
