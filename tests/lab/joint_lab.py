# SPDX-License-Identifier: GPL-2.0-only
"""Bodies with joints between them, and LAMMPS instances of them, for tests of fix mdanim/joint.

A rigid body is a box with eight particles at the corners of a smaller one, whose mass and moments are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import plugin_lab as lab
import rigid_lab

COLUMNS = ("force", "torque", "way", "rate", "driving", "gap", "broken", "ax", "ay", "az", "bx", "by", "bz")
"""Columns of the array of the fix."""
OUTPUTS = ("joints", "joint_heat", "work", "broken", "seconds")


def box(size, mass=1.0, at=(0, 0, 0), q=(1.0, 0, 0, 0), v=(0, 0, 0), spin=(0, 0, 0)) -> lab.Body:
    """Particles of a rigid box by its full sizes."""
    turn = rigid_lab.matrix(np.asarray(q, float))
    from_centre = (rigid_lab.SIGNS * np.asarray(size, float) / np.sqrt(12.0)) @ turn.T
    velocity = np.asarray(v, float) + np.cross(np.asarray(spin, float), from_centre)
    return lab.particles(from_centre + np.asarray(at, float), np.ones(8, int), v=velocity, mass=np.full(8, mass / 8.0))


def elastic(size, spacing, density, modulus, corner, moved=lambda x: x) -> lab.Body:
    """A lattice of a box [cells], which ``moved`` takes from its place to another, without strain."""
    body = lab.block(size)
    return replace(
        body,
        x=moved(body.x * spacing + np.asarray(corner, float)),
        mass=body.mass * density * spacing**3,
        k=body.k * modulus * spacing,
        r0=body.r0 * spacing,
    )


@dataclass
class World(lab.Running):
    """An instance of bodies with joints; all that is not in ``elastic`` or ``held`` is rigid. Molecules count from 1."""

    folder: Path
    bodies: Sequence[lab.Body]
    joints: Sequence[str]
    dt: float
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)
    elastic: tuple[int, ...] = ()
    held: tuple[int, ...] = ()
    commands: tuple[str, ...] = ()
    skin: float = 0.3

    fix = "j"
    outputs = OUTPUTS

    def __post_init__(self):
        self.dt = float(self.dt)
        self.body = lab.join(*self.bodies)
        self.options = {"cutoff": 3.0, "skin": self.skin}
        numbers = range(1, len(self.bodies) + 1)
        rigid = [m for m in numbers if m not in self.elastic + self.held]
        lists = {"rigid": rigid, "soft": [*self.elastic], "moving": [*rigid, *self.elastic]}
        commands = [f"group {name} molecule {' '.join(map(str, some))}" for name, some in lists.items() if some]
        commands += ["fix r rigid mdanim/rigid"] * bool(rigid) + ["fix l soft mdanim/leapfrog"] * bool(self.elastic)
        if any(self.gravity):
            commands.append(f"fix g moving mdanim/gravity {' '.join(repr(float(g)) for g in self.gravity)}")
        words = [f"joint {joint}" for joint in self.joints]
        commands.append(f"fix j moving mdanim/joint {' '.join(words)}")
        self.script = [*commands, f"timestep {self.dt!r}", "thermo_modify lost ignore", *self.commands]

    def __enter__(self) -> World:
        self.lmp = lab.load(self.body, self.folder, self.script, **self.options)
        self.lmp.command("thermo_style custom step pe ebond")
        self.lmp.command("thermo_modify norm no lost ignore")
        self.lmp.command("run 0")
        return self

    def rows(self) -> np.ndarray:
        """The array of the fix, shape (J, 13)."""
        return np.array([[self.lmp.extract_fix("j", 0, 2, n, c) for c in range(len(COLUMNS))] for n in range(len(self.joints))])

    def told(self, column: str, joint: int = 0) -> float:
        """An entry of the array."""
        return self.lmp.extract_fix("j", 0, 2, joint, COLUMNS.index(column))

    def array(self, name: str) -> np.ndarray:
        """Values of particles in tag order."""
        return lab.by_tag(self.lmp, name)

    def centre(self, body: int) -> np.ndarray:
        """Centre of mass of a body, counted from 1."""
        of = self.body.molecule == body
        return np.average(self.array("x")[of], axis=0, weights=self.body.mass[of])

    def energy(self) -> float:
        """Kinetic energy, that of gravity, of springs and of joints, with what joints lost and less what motors brought in."""
        x, v, m = self.array("x"), self.array("v"), self.body.mass
        free = ~np.isin(self.body.molecule, self.held)
        spent = self.number("joint_heat") - self.number("work")
        elastic = self.lmp.get_thermo("ebond") if len(self.body.bond) else 0.0
        kinetic = 0.5 * (m * (v**2).sum(1))[free].sum()
        return kinetic - (m * (x @ np.array(self.gravity)))[free].sum() + elastic + self.number("joints") + spent

    def momenta(self) -> np.ndarray:
        """Momentum and angular momentum about the origin of all, shape (6,)."""
        x, p = self.array("x"), self.body.mass[:, None] * self.array("v")
        return np.r_[p.sum(0), np.cross(x, p).sum(0)]
