# SPDX-License-Identifier: GPL-2.0-only
"""A scene text brought to life without files, looked at as it runs: energies, gaps, turned-over cells, volume of liquid."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.state import State
from mdanim_lammps.errors import DivergedError
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.run.energy import energies as energies_of
from mdanim_lammps.run.energy import least_energy, ledger_terms, potential_terms
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

UNITS, START, LEVEL = 0, 1, 2
"""Entries of the vector of fix mdanim/liquid."""
CORNER = ((0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7), (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3))
"""Each corner of a VTK hexahedron and its three neighbours, right-handed."""


class Trial:
    """A running scene; use as a context manager. Lengths are in metres: scenes have a spacing of 1."""

    def __init__(self, text: str, *, unstable: bool = False):
        self.ready = prepare(parse_scene(text, folder=Path(__file__).parent), allow_unstable=unstable)
        self.system, self.timestep = self.ready.system, self.ready.certificate.timestep
        self.instance = Instance(self.ready.plan)
        self.ledger = Ledger(
            ledger_terms(self.ready.plan),
            floor=least_energy(self.ready.scene, self.system),
            potentials=potential_terms(self.ready.plan),
        )
        self.lost_cells = 0.0
        try:
            self.instance.setup()
        except BaseException:
            self.instance.close()
            raise
        self._look(self.instance.array("f").copy())

    def put(self, x: np.ndarray) -> None:
        """Start anew, at rest, from these positions [m], shape (N, 3)."""
        still = np.zeros_like(x)
        self.instance.put(0, State(x, still, still))
        self.instance.setup()
        self.ledger.rows.clear()
        self._look(self.instance.array("f").copy())

    def __enter__(self) -> Trial:
        return self

    def __exit__(self, *_) -> None:
        self.instance.close()

    # --- running ----------------------------------------------------------------------------------------------------

    def run(self, steps: int, looks: int = 20, watch=None) -> None:
        """Advance, looking at the energies and calling ``watch()`` at evenly spaced steps. Raises DivergedError."""
        done = 0
        for look in range(1, looks + 1):
            part, done = steps * look // looks - done, steps * look // looks
            if part == 0:
                continue
            if part > 1:
                self.instance.run(part - 1)
            before = self.instance.array("f").copy()
            self.instance.run(1)
            self._look(before)
            if watch:
                watch()

    def run_for(self, time: float, looks: int = 20, watch=None) -> None:
        """The same for a time [s]."""
        self.run(math.ceil(time / self.timestep), looks, watch)

    def _look(self, before: np.ndarray) -> None:
        if not (np.isfinite(self.x).all() and np.isfinite(self.v).all()):
            raise DivergedError("positions or velocities are NaN or infinite")
        energies = {**energies_of(self.instance, self.system.center_of_mass(self.x)), "kinetic": self.kinetic(before)}
        self.ledger.add(self.instance.step * self.timestep, energies)
        if self.ready.plan.grid:
            gained = self.instance.fix_value("liquid", UNITS) - self.instance.fix_value("liquid", START)
            self.lost_cells = max(self.lost_cells, abs(gained))

    # --- looking ----------------------------------------------------------------------------------------------------

    @property
    def x(self) -> np.ndarray:
        """Positions [m], shape (N, 3)."""
        return self.instance.array("x")

    @property
    def v(self) -> np.ndarray:
        """Velocities [m/s], shape (N, 3)."""
        return self.instance.array("v")

    @property
    def drift(self) -> float:
        """Largest energy residual so far [-]."""
        return self.ledger.residual

    def kinetic(self, before: np.ndarray) -> float:
        """Kinetic energy with what makes the sum a constant of leap-frog to fourth order, from the last two forces.

        T + U + dt^2 (v.U''.v / 12 - F.F / 24 m): Hairer, Lubich & Wanner, Geometric Numerical Integration, IX.3.
        """
        m, dt, f = self.system.mass, self.timestep, self.instance.array("f")
        half = self.v - 0.5 * dt * f / m[:, None]
        each = 0.5 * m * (self.v**2).sum(1) - dt / 12.0 * (half * (f - before)).sum(1) - dt**2 / (24.0 * m) * (f**2).sum(1)
        return float(each[~self.system.held].sum())

    def of(self, name: str) -> slice:
        """Particles of an object."""
        k = self.system.names.index(name)
        return slice(self.system.first[k], self.system.first[k + 1])

    def centre(self, name: str) -> np.ndarray:
        """Centre of mass [m], shape (3,)."""
        return self.system.center_of_mass(self.x)[self.system.names.index(name)]

    def velocity(self, name: str) -> np.ndarray:
        """Velocity of the centre of mass [m/s], shape (3,)."""
        return self.system.center_of_mass(self.v)[self.system.names.index(name)]

    def face(self, name: str, axis: int, side: int) -> np.ndarray:
        """Numbers of the particles that were outermost along an axis at the start; side is 1 or -1."""
        x = self.system.position[self.of(name)][:, axis] * side
        return np.flatnonzero(x > x.max() - 1e-9) + self.of(name).start

    def gap(self, lower: np.ndarray, upper: np.ndarray, axis: int) -> float:
        """Mean distance of two faces along an axis [m]; negative when they overlap."""
        return float(self.x[upper, axis].mean() - self.x[lower, axis].mean())

    def strain(self) -> float:
        """Largest relative change of length of a spring."""
        i, j = self.system.spring.T
        return float(np.abs(np.linalg.norm(self.x[i] - self.x[j], axis=1) / self.system.rest - 1.0).max(initial=0.0))

    def inverted(self) -> int:
        """Cells that have a corner turned inside out."""
        cell = self.x[self.system.hexahedron]
        worst = np.full(len(cell), np.inf)
        for c, i, j, k in CORNER:
            a, b, d = (cell[:, n] - cell[:, c] for n in (i, j, k))
            worst = np.minimum(worst, (np.cross(a, b) * d).sum(1))
        return int((worst < 0.0).sum())

    def immersed(self, name: str, seed: int = 1) -> float:
        """Share of an object's cells below the mean surface, from 512 points a cell at random in equal strata."""
        k = self.of(name)
        cells = self.x[
            self.system.hexahedron[(self.system.hexahedron[:, 0] >= k.start) & (self.system.hexahedron[:, 0] < k.stop)]
        ]
        level, stratum = self.instance.fix_value("liquid", LEVEL), (np.arange(8) + 0.5) / 8
        grid = np.stack(np.meshgrid(stratum, stratum, stratum, indexing="ij"), -1).reshape(-1, 3)
        random, below = np.random.default_rng(seed), 0
        for z in cells[:, :, 2]:
            u, v, w = (grid + random.uniform(-1 / 16, 1 / 16, grid.shape)).T
            low = ((1 - u) * z[0] + u * z[1]) * (1 - v) + ((1 - u) * z[3] + u * z[2]) * v
            high = ((1 - u) * z[4] + u * z[5]) * (1 - v) + ((1 - u) * z[7] + u * z[6]) * v
            below += ((1 - w) * low + w * high < level).sum()
        return float(below / (len(cells) * len(grid)))
