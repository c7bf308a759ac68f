# SPDX-License-Identifier: GPL-2.0-only
"""Hand-made models and motions for the tests of trajectory and pictures; no simulation behind them."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.features.liquid.basin import plan_grid
from mdanim_lammps.features.liquid.record import Liquid
from mdanim_lammps.model.model import Layer, Model, Surface
from mdanim_lammps.model.springs import types
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from mdanim_lammps.scene import scene as records

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def lattice(size, cells, inside=None):
    """Corners [m] (x fastest) and filled cells of a box of cells around the origin; unused corners go."""
    cells = np.array(cells)
    n = cells + 1
    grid = np.stack(np.meshgrid(*(np.arange(k) for k in n), indexing="ij"), axis=-1).transpose(2, 1, 0, 3)
    points = grid.reshape(-1, 3) / cells * size - np.array(size) / 2
    corner = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
    low = np.stack(np.meshgrid(*(np.arange(k) for k in cells), indexing="ij"), axis=-1).reshape(-1, 3)
    hexahedron = ((low[:, None] + corner) @ [1, n[0], n[0] * n[1]]).astype(np.int32)
    if inside is not None:
        hexahedron = hexahedron[inside(points[hexahedron]).any(axis=1)]
    used, hexahedron = np.unique(hexahedron, return_inverse=True)
    return points[used], hexahedron.reshape(-1, 8).astype(np.int32)


QUADS = np.array([(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (3, 7, 6, 2), (0, 4, 7, 3), (1, 2, 6, 5)])


def outer_quads(hexahedron):
    """Faces that belong to one cell only, seen counter-clockwise from outside, shape (Q, 4)."""
    quads = hexahedron[:, QUADS].reshape(-1, 4)
    _, inverse, count = np.unique(np.sort(quads, axis=1), axis=0, return_inverse=True, return_counts=True)
    return quads[count[inverse.ravel()] == 1]


def model(name, points, hexahedron, position, surface, held=None, mass=1.0):
    """A model of the given lattice; springs along cell edges only, enough for a trajectory."""
    n = len(points)
    edges = hexahedron[:, [(0, 1), (1, 2), (3, 2), (0, 3), (4, 5), (5, 6), (7, 6), (4, 7), (0, 4), (1, 5), (2, 6), (3, 7)]]
    spring = np.unique(np.sort(edges.reshape(-1, 2), axis=1), axis=0).astype(np.int32)
    share = np.bincount(hexahedron.ravel(), minlength=n) / 8
    layer = np.where(share < 1, Layer.BOUNDARY, Layer.SUB_BOUNDARY).astype(np.uint8)
    where = points + np.array(position)
    length = np.linalg.norm(points[spring[:, 0]] - points[spring[:, 1]], axis=1)
    spring_type, constants = types(np.column_stack([np.ones(len(spring)), length, np.zeros(len(spring))]))
    return Model(
        name=name,
        position=where,
        velocity=np.zeros((n, 3)),
        mass=mass * share / share.sum(),
        share=share,
        layer=layer,
        held=np.zeros(n, bool) if held is None else held,
        spring=spring,
        spring_type=spring_type,
        constants=constants,
        hexahedron=hexahedron,
        cell=(0.1, 0.1, 0.1),
        young=1e5,
        inertia_error=0.0,
        surface=surface,
        frame=None,
    )


def box(name, size, cells, position, **options):
    """A box whose surface vertices are its boundary particles."""
    points, hexahedron = lattice(size, cells)
    quads = outer_quads(hexahedron)
    vertex, corner = np.unique(quads, return_inverse=True)
    corner = corner.reshape(-1, 4)
    triangle = np.concatenate([corner[:, [0, 1, 2]], corner[:, [0, 2, 3]]]).astype(np.int32)
    surface = Surface(triangle, vertex[:, None].astype(np.int32), np.ones((len(vertex), 1)))
    return model(name, points, hexahedron, position, surface, **options)


def ball(name, radius, spacing, position, rings=24, **options):
    """A ball: its round surface hangs on the corners of the cells that it crosses."""
    import pyvista as pv

    half = int(np.ceil(radius / spacing))
    points, hexahedron = lattice((2 * half * spacing,) * 3, (2 * half,) * 3, lambda p: np.linalg.norm(p, axis=-1) < radius)
    skin = pv.Sphere(radius=radius, theta_resolution=2 * rings, phi_resolution=rings)
    vertices, triangle = np.array(skin.points, float), skin.faces.reshape(-1, 4)[:, 1:].astype(np.int32)
    centre = points[hexahedron].mean(axis=1)
    nearest = np.array([np.abs(centre - v).max(axis=1).argmin() for v in vertices])
    r, s, t = (((vertices - centre[nearest]) / spacing) + 0.5).T
    weight = np.stack(
        [
            (1 - r) * (1 - s) * (1 - t),
            r * (1 - s) * (1 - t),
            r * s * (1 - t),
            (1 - r) * s * (1 - t),
            (1 - r) * (1 - s) * t,
            r * (1 - s) * t,
            r * s * t,
            (1 - r) * s * t,
        ],
        axis=1,
    )
    surface = Surface(triangle, hexahedron[nearest], weight)
    return model(name, points, hexahedron, position, surface, **options)


def solid(m, position, color=None):
    """The scene record of a model; its shape is of no concern to pictures."""
    return records.Solid(m.name, records.Sphere(1.0), position, IDENTITY, records.Young(1e5), mass=1.0, color=color)


def slab_scene(**control):
    """A held slab, a cube and a ball above it, and the ground below."""
    slab = box("slab", (1.6, 1.0, 0.1), (16, 10, 1), (0, 0, 0.25), mass=20.0)
    slab = _all_held(slab)
    models = [
        slab,
        box("cube", (0.3, 0.3, 0.3), (3, 3, 3), (-0.35, 0, 0.9), mass=2.0),
        ball("ball", 0.2, 0.08, (0.35, 0, 1.0), mass=1.0),
    ]
    scene = records.SceneRecord(
        name="slab",
        title="A cube and a ball fall on a slab",
        ground=0.0,
        control=records.Control(time=1.0, frames=10.0, **control),
        solids=tuple(solid(m, tuple(m.position.mean(axis=0))) for m in models),
    )
    return scene, models


def _all_held(m):
    from dataclasses import replace

    return replace(m, held=np.ones(len(m.position), bool))


def falling(models, frames, dt=0.1, floor=0.3, g=9.81):
    """Frames (step, time, position, velocity): what is free and above the floor falls, bounces,
    and is squashed on landing."""
    rest = [m.position for m in models]
    for i in range(frames):
        t, position, velocity = i * dt, [], []
        for m, x in zip(models, rest):
            if m.held.all() or x[:, 2].min() <= floor:
                position.append(x)
                velocity.append(np.zeros_like(x))
                continue
            height = x[:, 2].min() - floor
            period = 2 * np.sqrt(2 * height / g)
            phase = (t + period / 2) % period - period / 2
            fall = 0.5 * g * phase**2
            squash = 1 - 0.25 * np.exp(-(((abs(phase) - period / 2) / 0.05) ** 2))
            y = x.copy()
            low = x[:, 2].min()
            y[:, 2] = low + (x[:, 2] - low) * squash - fall
            centre = x[:, :2].mean(axis=0)
            y[:, :2] = centre + (x[:, :2] - centre) / np.sqrt(squash)
            a = 0.8 * t
            turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
            y[:, :2] = centre + (y[:, :2] - centre) @ turn.T
            position.append(y)
            velocity.append(np.broadcast_to([0, 0, -g * phase], x.shape))
        yield i * 10, t, np.concatenate(position), np.concatenate(velocity)


def pool_scene(models=None, spacing=0.05, color=None, **control):
    """A basin half full of water and, unless others are given, a crate and a ball above it; and the grid."""
    models = models or [box("crate", (0.4, 0.4, 0.3), (4, 4, 3), (-0.35, 0.1, 0.45)), ball("ball", 0.16, 0.08, (0.45, -0.3, 0.2))]
    liquid = Liquid("water", (-1.0, -0.7, 0.0), (1.0, 0.7, 1.0), 1000.0, volume=1.4, color=color)
    scene = records.SceneRecord(
        name="pool",
        title="A crate in a tank of water",
        control=records.Control(time=1.0, frames=10.0, **control),
        solids=tuple(solid(m, tuple(m.position.mean(axis=0))) for m in models),
        liquid=liquid,
    )
    return scene, models, plan_grid(liquid, spacing)


def column_centres(grid):
    """x and y of the columns [m], each of shape (ny, nx)."""
    x, y = (a + (np.arange(n) + 0.5) * e for a, e, n in zip(grid.low, grid.cell, grid.shape[:2]))
    return np.meshgrid(x, y)


def flat(grid, level=0.5):
    """Heights of a level liquid [m], shape (ny, nx)."""
    return np.full(grid.shape[1::-1], level)


def dam(grid, front=0.1):
    """Heights of a dam that breaks: 0.8 m high on the left, sloping to the dry floor on the right."""
    x, _ = column_centres(grid)
    return 0.8 / (1 + np.exp((x - front) / 0.12)) * (x < front + 0.5)


def splash(grid, centre=(0.0, 0.0), level=0.5, height=0.09):
    """Heights of rings around a splash."""
    x, y = column_centres(grid)
    r = np.hypot(x - centre[0], y - centre[1])
    return level + height * np.cos(18 * r) * np.exp(-2.2 * r)


def wet_frames(models, *liquids):
    """Frames of models at rest with these heights; raw ones are whole cells, NaN in the columns of a body."""
    position = np.concatenate([m.position for m in models])
    for i, (smooth, raw) in enumerate(liquids):
        yield i * 10, 0.1 * i, position, np.zeros_like(position), {"liquid_height": smooth, "liquid_raw": raw}


def with_drops(frame, drops):
    """The frame, with drops that fly."""
    *rest, heights = frame
    return *rest, heights | {"liquid_drops": drops}


def raw_of(grid, smooth, models=()):
    """Raw heights that go with smooth ones: whole cells, NaN where a body stands."""
    edge = grid.cell[2]
    raw = np.round((smooth - grid.low[2]) / edge) * edge + grid.low[2]
    x, y = column_centres(grid)
    for m in models:
        low, high = m.position.min(axis=0), m.position.max(axis=0)
        raw[(x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1])] = np.nan
    return raw


def write(path, scene, models, frames, grid=None):
    """Write a whole trajectory; returns its path."""
    frames = list(frames)
    with TrajectoryWriter(path, scene, models, frames=len(frames), dt=0.01, steps_per_frame=10, grid=grid) as out:
        for frame in frames:
            out.write(*frame)
    return path


def read_png(path):
    from PIL import Image

    return np.asarray(Image.open(path))


KILLED = """
import os, signal, sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from picture_samples import falling, slab_scene
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
scene, models = slab_scene()
writer = TrajectoryWriter(Path(sys.argv[2]) / "trajectory.h5", scene, models, frames=1000, dt=0.01, steps_per_frame=10)
flushed = 0
for i, frame in enumerate(falling(models, 1000)):
    writer.write(*frame)
    if i % 3 == 2:
        writer.flush()
        flushed = i + 1
        print(flushed, flush=True)
"""
"""A process that writes a trajectory and says how many frames are flushed: arguments are the folder of this file and its own."""
