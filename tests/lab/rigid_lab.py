# SPDX-License-Identifier: GPL-2.0-only
"""Rigid bodies with shapes, and LAMMPS instances of them, for tests and benchmarks of fix mdanim/rigid.

A body has eight particles at the corners of a cuboid. Mass and moments are those of the shape, in closed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import plugin_lab as lab

SIGNS = np.array([[i, j, k] for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)], float)


def about(axis, angle: float) -> np.ndarray:
    """Unit quaternion (w, x, y, z) of a rotation by an angle [rad]."""
    axis = np.asarray(axis, float)
    return np.r_[np.cos(angle / 2), np.sin(angle / 2) * axis / np.linalg.norm(axis)]


def times(p, q) -> np.ndarray:
    """The product of two quaternions: rotates by q, then by p."""
    return np.r_[p[0] * q[0] - np.dot(p[1:], q[1:]), p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])]


def matrix(q) -> np.ndarray:
    """Rotation matrix of a unit quaternion, shape (3, 3)."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@dataclass(frozen=True)
class Rigid:
    """A body at its start."""

    shape: str
    """Words of its shape in the file of shapes."""
    mass: float
    moments: np.ndarray
    """About its own axes, shape (3,)."""
    spread: np.ndarray
    """Half sizes of the cuboid of its particles, shape (3,)."""
    thin: float
    at: np.ndarray = field(default_factory=lambda: np.zeros(3))
    q: np.ndarray = field(default_factory=lambda: np.array([1.0, 0, 0, 0]))
    v: np.ndarray = field(default_factory=lambda: np.zeros(3))
    spin: np.ndarray = field(default_factory=lambda: np.zeros(3))
    mu: float = 0.5
    beta: float = 0.3
    held: bool = False
    offset: float = 0.0
    """How far the origin of the shape is from the centre of mass, along the third axis."""

    def put(self, at=None, q=None, **more) -> Rigid:
        """The same body elsewhere, or with other values."""
        more |= {name: float(more[name]) for name in ("mu", "beta") if name in more}
        arrays = {name: np.asarray(more.pop(name), float) for name in ("v", "spin") if name in more}
        place = {} if at is None else {"at": np.asarray(at, float)}
        return replace(self, **place, **({} if q is None else {"q": np.asarray(q, float)}), **arrays, **more)


def box(size, density=600.0, **more) -> Rigid:
    """A box by its full sizes."""
    size = np.asarray(size, float)
    mass = density * size.prod()
    return Rigid(
        f"box {' '.join(map(repr, size.tolist()))}", mass, mass / 12 * ((size**2).sum() - size**2), size / 2, size.min()
    ).put(**more)


def polyhedron(corners, faces) -> str:
    """Words of a polyhedron with these corners, and the numbers of those around each face."""
    numbers = " ".join(repr(float(c)) for corner in corners for c in corner)
    around = " ".join(" ".join(map(str, [len(f), *f])) for f in faces)
    return f"polyhedron {len(corners)} {numbers} {len(faces)} {around}"


def prism(sides: int, radius: float, height: float) -> str:
    """Words of a prism over a regular polygon with this radius, along its third axis."""
    angle = 2 * np.pi * np.arange(sides) / sides
    corners = [(radius * np.cos(a), radius * np.sin(a), z) for z in (-height / 2, height / 2) for a in angle]
    low = [sides - 1 - k for k in range(sides)]
    faces = [low, [k + sides for k in range(sides)]]
    faces += [[k, (k + 1) % sides, (k + 1) % sides + sides, k + sides] for k in range(sides)]
    return polyhedron(corners, faces)


def blade(half: float, height: float, length: float) -> Rigid:
    """A held wedge whose edge is on the first axis, and its back this far below it and twice `half` wide."""
    x, y, z = length / 2, half, -height
    corners = [(-x, 0, 0), (x, 0, 0), (-x, -y, z), (-x, y, z), (x, -y, z), (x, y, z)]
    faces = [[0, 2, 4, 1], [0, 1, 5, 3], [2, 3, 5, 4], [0, 3, 2], [1, 4, 5]]
    return Rigid(polyhedron(corners, faces), 0.0, np.zeros(3), np.zeros(3), half, held=True)


def ball(radius, density=600.0, **more) -> Rigid:
    """A full ball."""
    mass = density * 4 / 3 * np.pi * radius**3
    return Rigid(f"ball {radius!r}", mass, np.full(3, 0.4 * mass * radius**2), np.full(3, radius / 2), 2 * radius).put(**more)


def cylinder(radius, height, density=600.0, **more) -> Rigid:
    """A full cylinder about its third axis."""
    mass = density * np.pi * radius**2 * height
    across = mass * (3 * radius**2 + height**2) / 12
    spread = np.array([radius / 2, radius / 2, height / 2])
    moments = np.array([across, across, 0.5 * mass * radius**2])
    return Rigid(f"cylinder {radius!r} {height!r}", mass, moments, spread, min(2 * radius, height)).put(**more)


def cone(radius, height, density=600.0, **more) -> Rigid:
    """A full cone about its third axis; its place is the centre of mass, a quarter of the height above the base."""
    mass = density * np.pi / 3 * radius**2 * height
    across = 3 * mass * (radius**2 / 20 + height**2 / 80)
    moments = np.array([across, across, 0.3 * mass * radius**2])
    spread = np.array([radius / 3, radius / 3, height / 5])
    return Rigid(f"cone {radius!r} {height!r}", mass, moments, spread, min(radius, height), offset=height / 4).put(**more)


def ellipsoid(half_axes, density=600.0, **more) -> Rigid:
    """A full ellipsoid."""
    a = np.asarray(half_axes, float)
    mass = density * 4 / 3 * np.pi * a.prod()
    moments = mass / 5 * ((a**2).sum() - a**2)
    return Rigid(f"ellipsoid {' '.join(map(repr, a.tolist()))}", mass, moments, a / 2, 2 * a.min()).put(**more)


def torus(radius, tube, density=600.0, **more) -> Rigid:
    """A ring about its third axis, by the radii of its middle line and of its tube."""
    mass = density * 2 * np.pi**2 * radius * tube**2
    across = mass * (4 * radius**2 + 5 * tube**2) / 8
    moments = np.array([across, across, mass * (radius**2 + 0.75 * tube**2)])
    return Rigid(f"torus {radius!r} {tube!r}", mass, moments, np.array([radius / 2, radius / 2, tube / 2]), 2 * tube).put(**more)


NAMES = (
    *("bodies", "translation", "rotation", "seconds", "drag_loss", "contact", "friction_heat", "damping_loss", "let_go"),
    *("deepest", "touching", "near", "worst_bound", "most_touching", "work", "kinetic", "torn", "broken_faces", "stress_share"),
    *("stilled", "asleep"),
)


def mesh(points, triangles, thin: float, **more) -> Rigid:
    """A held surface of triangles, counter-clockwise from outside, with the thickness of its thinnest part."""
    numbers = " ".join(repr(float(c)) for point in points for c in point)
    corners = " ".join(str(int(k)) for triangle in triangles for k in triangle)
    shape = f"mesh {float(thin)!r} {len(points)} {numbers} {len(triangles)} {corners}"
    return Rigid(shape, 0.0, np.zeros(3), np.zeros(3), thin, held=True).put(**more)


class World(lab.Running):
    """An instance with rigid bodies. The time step is 0.35 of 1/frequency, if nothing else is told."""

    fix = "r"
    outputs = NAMES

    def __init__(
        self,
        folder: Path,
        bodies: Sequence[Rigid],
        *,
        frequency: float,
        planes: Sequence[str] = ("plane z lo 0.0",),
        gravity=(0.0, 0.0, -9.81),
        objects: bool = True,
        thin: float | None = None,
        step: float = 0.35,
        words: str = "",
        commands: Sequence[str] = (),
        molecules: Sequence[int] | None = None,
    ):
        self.bodies, self.dt = list(bodies), step / float(frequency)
        self.molecules = list(molecules or range(1, len(bodies) + 1))
        self.free = sorted((m, n) for n, (m, b) in enumerate(zip(self.molecules, bodies)) if not b.held)
        self.setup = setup(folder, self.bodies, self.molecules)
        onset = 0.005 * float(thin or min(b.thin for b in bodies))
        contact = f"shapes {folder}/shapes contact {float(frequency)!r} {onset!r}"
        self.commands = [
            f"fix r all mdanim/rigid inertia {folder}/inertia {contact}{' objects' * objects} {' '.join(planes)} {words}",
            *([f"fix g all mdanim/gravity {' '.join(repr(float(g)) for g in gravity)}"] if np.any(gravity) else []),
            f"timestep {self.dt!r}",
            *commands,
        ]
        self.folder = folder
        self.started = False

    def __enter__(self) -> World:
        self.lmp = lab.load(self.setup, self.folder, [*self.commands, "thermo_modify lost ignore"], cutoff=0.2, skin=0.1)
        self.lmp.command("run 0")
        return self

    def rows(self) -> np.ndarray:
        """Centre, velocity, quaternion of the principal axes, angular velocity of each free body in the order given, shape
        (M, 13)."""
        rows = np.array([[self.lmp.extract_fix("r", 0, 2, k, c) for c in range(13)] for k in range(len(self.free))])
        order = np.argsort([n for _, n in self.free])
        return rows[order]

    def energy(self, gravity=9.81) -> float:
        """All energy, with what was lost."""
        rows, mass = self.rows(), np.array([b.mass for b in self.bodies if not b.held])
        names = ("translation", "rotation", "contact", "friction_heat", "damping_loss", "let_go", "drag_loss")
        return sum(map(self.number, names)) + gravity * (mass * rows[:, 2]).sum()


def setup(folder: Path, bodies: Sequence[Rigid], molecules: Sequence[int]) -> lab.Body:
    """Writes the files of moments and shapes; gives the particles of the bodies."""
    inertia, shapes, x, v, mass, molecule = [], [], [], [], [], []
    for number, body in zip(molecules, bodies):
        turn = matrix(body.q)
        full = turn @ np.diag(body.moments) @ turn.T
        numbers = " ".join(repr(float(a)) for a in (*(body.at + body.offset * turn[:, 2]), *body.q))
        shapes.append(f"{number} {body.mu!r} {body.beta!r} {'held' if body.held else 'free'} {numbers} {body.shape}")
        if body.held:
            continue
        inertia.append(f"{number} " + " ".join(repr(float(a)) for a in (*np.diag(full), full[0, 1], full[0, 2], full[1, 2])))
        arms = (SIGNS * body.spread) @ turn.T
        x.append(body.at + arms)
        v.append(body.v + np.cross(body.spin, arms))
        mass.append(np.full(8, body.mass / 8))
        molecule.append(np.full(8, number))
    (folder / "inertia").write_text("\n".join(inertia) + "\n")
    (folder / "shapes").write_text("\n".join(shapes) + "\n")
    return lab.particles(np.concatenate(x), np.concatenate(molecule), v=np.concatenate(v), mass=np.concatenate(mass))


def frequency_of(speed: float, thin: float, depth: float = 0.02) -> float:
    """Frequency of contacts at which a blow goes this deep, over the thinnest part."""
    return speed / (depth * thin)
