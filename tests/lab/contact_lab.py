# SPDX-License-Identifier: GPL-2.0-only
"""Small cuboids that touch, for the tests of fix mdanim/contact: particles, contact bodies, instances, records of contacts."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import plugin_lab as lab
import plugin_path
import state_lab
from mdanim_lammps.engine.plugin import folder
from mdanim_lammps.model.contact_body import NO_SHARERS, NO_SHARES, frame_of, make_contact_body
from mdanim_lammps.model.lattice import Cells
from mdanim_lammps.scene.shapes import Box

ARRAYS = (
    "count",
    "edge",
    "node",
    "filled",
    "cell",
    "at",
    "centre",
    "normal",
    "area",
    "kind",
    "depth",
    "open",
    "frame",
    "frame_at",
)
COLUMNS = ("body", "young", "friction", "moves")
MEMORY = [
    ("offset", "f8"),
    ("depth", "f8"),
    ("pull", "f8", 3),
    ("stick", "f8"),
    ("stick_energy", "f8"),
    ("damping", "f8"),
    ("drag", "f8", 3),
]
"""ContactMemory in plugin/contact/law.h."""
FIELD = np.dtype(
    [
        ("point", "i4"),
        ("side", "i4"),
        ("cell", "i4", 3),
        ("spare", "i4"),
        ("X", "f8", 3),
        ("change", "f8", 3),
        ("anchor", "f8", 3),
        *MEMORY,
        ("force", "f8", 3),
        ("moved", "f8", 3),
        ("energy", "f8"),
    ]
)
"""FieldContact in plugin/contact/field_contact.h."""
PLANE = np.dtype([("point", "i4"), ("plane", "i4"), ("anchor", "f8", 3), *MEMORY])
"""PlaneContact in plugin/contact/plane_field.h."""


@dataclass(frozen=True)
class Cuboid:
    """An elastic cuboid of cubic cells at rest in a place, turned about its centre."""

    cells: tuple[int, int, int]
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spacing: float = 1.0
    young: float = 1.0
    density: float = 1.0
    friction: float = 0.0
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    angle: float = 0.0
    """[deg]"""
    held: bool = False
    rigid: bool = False

    @property
    def particles(self) -> lab.Body:
        """Particles and springs, one object."""
        h, unit = self.spacing, lab.block(self.cells)
        x = (unit.x - 0.5 * np.array(self.cells)) * h @ rotation(self.axis, self.angle).T + self.centre
        v = np.tile(np.asarray(self.velocity, float), (len(x), 1))
        return replace(unit, x=x, v=v, mass=self.density * h**3 * unit.mass, k=self.young * h * unit.k, r0=h * unit.r0)

    @property
    def arrays(self) -> dict:
        """The arrays of its contact body."""
        return cuboid_arrays(self.cells, (self.spacing,) * 3, self.rigid)


def rotation(axis, angle: float) -> np.ndarray:
    """The matrix (3, 3) that turns by an angle [deg] about an axis."""
    a, s, c = np.asarray(axis, float) / np.linalg.norm(axis), np.sin(np.radians(angle)), np.cos(np.radians(angle))
    cross = np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
    return c * np.eye(3) + s * cross + (1.0 - c) * np.outer(a, a)


def cuboid_arrays(cells, edge, rigid: bool = False) -> dict:
    """The arrays of a cuboid's contact body."""
    size = np.array(cells) * edge
    body = make_contact_body(Box(tuple(size.tolist())), Cells(np.ones(cells[::-1], bool), -size / 2, size / 2))
    return {name: getattr(frame_of(body) if rigid else body, name) for name in (*ARRAYS, "radius", "tears")}


def line_arrays(particles: int, edge: float, radius: float) -> dict:
    """The arrays of the contact body of a line of round particles, in cells of these edges."""
    at = np.stack([np.arange(particles) + 0.5, np.full(particles, 0.5), np.full(particles, 0.5)], axis=1)
    number = np.arange(particles, dtype=np.int32)
    return {
        "count": np.array([particles, 1, 1], np.int32),
        "edge": np.full(3, edge),
        "node": number,
        "filled": np.ones(particles, np.uint8),
        "cell": number,
        "at": at,
        "centre": at,
        "normal": np.tile([0.0, 0.0, 1.0], (particles, 1)),
        "area": np.full(particles, 2.0 * radius * edge),
        "kind": np.full(particles, 2, np.uint8),
        "depth": None,
        "open": np.zeros((0, 5)),
        "frame": None,
        "frame_at": None,
        "radius": radius,
        "hardness": 1.0,
        "spread": 0.0,
        "sharer": NO_SHARERS,
        "share": NO_SHARES,
    }


def give_body(lmp, fix: str, kind: int, arrays: dict) -> None:
    """Hand a contact body over; RuntimeError with the plugin's message."""
    library = ctypes.CDLL(f"{folder()}/mdanimplugin.so")
    kept = {name: None if arrays[name] is None else np.ascontiguousarray(arrays[name]) for name in ARRAYS}
    count, edge, node, filled, *of_points, open_parts, frame, frame_at = (
        a if a is None else a.ctypes.data_as(ctypes.c_void_p) for a in kept.values()
    )
    sizes = ctypes.c_int(len(kept["node"])), ctypes.c_int(len(kept["cell"]))
    sharer, share = arrays.get("sharer", NO_SHARERS), arrays.get("share", NO_SHARES)
    error = ctypes.create_string_buffer(1024)
    handle = ctypes.c_void_p(ctypes.cast(lmp.lmp, ctypes.c_void_p).value)
    if library.mdanim_contact_body(
        handle,
        fix.encode(),
        ctypes.c_int(kind),
        count,
        edge,
        sizes[0],
        node,
        filled,
        sizes[1],
        *of_points,
        ctypes.c_int64(0 if kept["depth"] is None else len(kept["depth"])),
        ctypes.c_int(len(kept["open"])),
        open_parts,
        frame,
        frame_at,
        ctypes.c_double(arrays.get("radius", 0.0)),
        ctypes.c_double(arrays.get("hardness", 1.0)),
        ctypes.c_double(arrays.get("spread", 0.0)),
        ctypes.c_int(len(sharer)),
        sharer.ctypes.data_as(ctypes.c_void_p),
        share.ctypes.data_as(ctypes.c_void_p),
        ctypes.c_int(arrays.get("tears", False)),
        error,
        ctypes.c_int(1024),
    ):
        raise RuntimeError(error.value.decode())


def scene(cuboids) -> tuple[lab.Body, dict]:
    """All particles, and the columns that the fix is told."""
    parts = [one.particles for one in cuboids]
    sizes = [len(part.x) for part in parts]
    table = [(float(n), one.young, one.friction, float(not one.held)) for n, one in enumerate(cuboids)]
    return lab.join(*parts), dict(zip(COLUMNS, np.repeat(np.array(table).T, sizes, axis=1)))


def commands(cuboids, words: str, dt: float, more=(), before=()) -> list[str]:
    """Commands after the particles: some ``before``, the group of those that move, contact, leap-frog."""
    first = np.cumsum([0] + [len(one.particles.x) for one in cuboids])
    of = lambda some: " ".join(f"{a + 1}:{b}" for one, a, b in zip(cuboids, first, first[1:]) if some(one))
    stiff = of(lambda one: one.rigid and not one.held)
    groups = [f"group stiff id {stiff}", "group bent subtract mobile stiff", "fix stiff stiff mdanim/rigid"] if stiff else []
    return [
        *before,
        f"group mobile id {of(lambda one: not one.held)}",
        f"fix contact mobile mdanim/contact d_body d_young d_friction {words}",
        *more,
        *groups,
        f"fix run {'bent' if stiff else 'mobile'} mdanim/leapfrog",
        f"timestep {dt!r}",
        "thermo_style custom step ebond",
    ]


def load(
    cuboids,
    folder: Path,
    words: str = "objects",
    dt: float = 0.2,
    more=(),
    before=(),
    *,
    setup: bool = True,
    give: bool = True,
    comm=None,
    **options,
):
    """A LAMMPS instance of cuboids that has their contact bodies, set up for runs with ``pre no``; on a communicator all of its
    processes share it."""
    body, columns = scene(cuboids)
    if comm is None or comm.rank == 0:
        script = lab.script(body, folder, commands(cuboids, words, dt, more, before), columns=columns, **options)
    if comm is not None:
        script = comm.bcast(script if comm.rank == 0 else None)
    lmp = plugin_path.lammps(comm=comm)
    for command in script:
        lmp.command(command)
        if command.startswith("thermo_style"):  # which forgets thermo_modify
            lmp.command("thermo_modify norm no")
    for n, one in enumerate(cuboids if give else ()):
        give_body(lmp, "contact", n, one.arrays)
    if setup:
        lmp.command("run 0 post no")
    return lmp


class State(NamedTuple):
    """All that a run goes on from, in tag order."""

    x: np.ndarray
    v: np.ndarray
    f: np.ndarray
    contacts: state_lab.Records

    @classmethod
    def of(cls, lmp) -> State:
        arrays = (np.ctypeslib.as_array(lmp.gather_atoms(name, 1, 3)).reshape(-1, 3).copy() for name in "xvf")
        return cls(*arrays, state_lab.pack(lmp, "contact"))

    def put(self, lmp) -> None:
        """Take it up on one process; then a run with ``pre no`` goes on from it."""
        order = lmp.numpy.extract_atom("id")[: len(self.x)] - 1
        write = lambda name, values: lmp.numpy.extract_atom(name)[: len(order)].__setitem__(slice(None), values[order])
        write("x", self.x)
        write("v", self.v)
        state_lab.put(lmp, "contact", self.contacts)
        lmp.command("run 0 post no")
        write("v", self.v)
        write("f", self.f)

    def same(self, other: State) -> bool:
        """Whether all bits of it are the same."""
        return all(a.tobytes() == b.tobytes() for a, b in zip(self[:3], other[:3])) and self.contacts.same(other.contacts)


def pile(seed: int, friction: bool = True) -> tuple[Cuboid, ...]:
    """Cuboids of several sizes, stiffnesses and spacings, turned at random, that come together and fall on a ground at z = 0."""
    random, found = np.random.default_rng(seed), []
    for place in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)):
        centre = 3.4 * (np.array(place) + 0.05 * random.uniform(-1, 1, 3)) + (0, 0, 1.9)
        found.append(
            Cuboid(
                tuple(random.integers(1, 4, 3).tolist()),
                tuple(centre.tolist()),
                spacing=float(random.choice([0.7, 0.8, 1.0])),
                young=float(random.uniform(0.7, 2.0)),
                friction=float(random.uniform(0.2, 0.8)) if friction else 0.0,
                velocity=tuple((-0.15 * (np.array(place) - (0.4, 0.3, -0.2)) + 0.03 * random.standard_normal(3)).tolist()),
                axis=tuple(random.standard_normal(3).tolist()),
                angle=float(random.uniform(0, 180)),
            )
        )
    return tuple(found)


PILE = {"words": "objects plane z lo 0.0", "dt": 0.1, "more": ("fix weight mobile mdanim/gravity 0 0 -0.005",)}
"""How a pile is loaded."""


def contacts(records: state_lab.Records) -> dict[tuple[int, int], np.ndarray]:
    """Rows of all contacts by (object of the points, object or -1 - plane that they are in), both from 0."""
    found = {}
    for a, b in records.key.tolist():
        data = records.record(a, b).tobytes()[8:]
        if b == 0:
            rows = np.frombuffer(data[8:], PLANE)
            found |= {(a - 1, -1 - int(p)): rows[rows["plane"] == p] for p in np.unique(rows["plane"])}
            continue
        lower = int(np.frombuffer(data[:8], "i8")[0])
        end = 8 + lower * FIELD.itemsize
        found[a - 1, b - 1] = np.frombuffer(data[8:end], FIELD)
        found[b - 1, a - 1] = np.frombuffer(data[end + 8 :], FIELD)
    return {key: rows for key, rows in found.items() if len(rows)}


def rows(cuboids) -> list[slice]:
    """Particles of each object."""
    first = np.cumsum([0] + [len(one.particles.x) for one in cuboids]).tolist()
    return [slice(a, b) for a, b in pairwise(first)]
