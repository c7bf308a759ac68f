# SPDX-License-Identifier: GPL-2.0-only
"""Hands in pictures and exports: a small ball where a hand is, and a line from there to the point that it holds."""

from __future__ import annotations

from functools import partial

import numpy as np

from ...model import shapes
from ...picture.drawn import Drawn
from ...results.files import HANDS
from ...results.trajectory import MOST_TEXT
from ...scene.scene import Sphere
from ...scene.source import UnreadableFile, read_text
from ..joints.patches import ALL, Patch
from ..rigid.words import Rigid
from .strength import GRASP

BALL = 0.2
"""Radius of the ball over that of the object."""
FINE = 0.5
"""Size of its triangles over the radius."""
LEAST = 8
"""Stored particles that tell where a point of what deforms is, at least."""
COLOR = (0.80, 0.10, 0.50)


def drawn(trajectory):
    """A ball and a line for each hand of the scene and of its pages, from its first key to its last."""
    scene = trajectory.scene
    if scene is not None and scene.steerable:
        scene = _with_those_of_pages(trajectory) or scene
    held_by = [] if scene is None else [hand for hand in scene.held_by if hand.object in trajectory.names]
    return tuple(_hand(trajectory, hand, n) for n, hand in enumerate(held_by, 1))


def _with_those_of_pages(trajectory):
    """The scene with the hands that a page has moved, which the run keeps beside its trajectory; None where there are none."""
    try:
        lines = read_text(trajectory.path.parent / HANDS, MOST_TEXT, HANDS)
    except (UnreadableFile, OSError):
        return None
    return trajectory.scene_with("\n".join(line for line in lines.splitlines() if line.strip() != "hands on"))


def _hand(trajectory, hand, n: int) -> Drawn:
    solid = next(solid for solid in trajectory.scene.solids if solid.name == hand.object)
    patch = _patch(trajectory, solid, np.array(hand.at))
    weights, times = patch.of_point(np.array(hand.at)), np.array([key.time for key in hand.keys])
    places = np.array([key.at for key in hand.keys])
    ball, triangle = shapes.surface(Sphere(1.0), FINE)
    radius = BALL * shapes.radius(solid.shape)

    def place(frame: int) -> tuple[np.ndarray, bool]:
        time = float(trajectory.times[frame])
        at = np.array([np.interp(time, times, places[:, k]) for k in range(3)])
        return at, bool(times[0] <= time <= times[-1])

    def points(frame: int) -> np.ndarray:
        at, holds = place(frame)
        if not holds:
            return np.tile(at, (len(ball) + 2, 1))
        return np.concatenate([at + radius * ball, [at, weights @ trajectory.position(frame)[patch.rows]]])

    normals = partial(np.concatenate, [ball, np.tile([0.0, 0.0, 1.0], (2, 1))])
    line = np.array([[len(ball), len(ball) + 1]], np.int32)
    return Drawn(f"hand {n}", points, triangle.astype(np.int32), line, COLOR, lambda _: normals())


def _patch(trajectory, solid, point: np.ndarray) -> Patch:
    """Stored particles that tell where a point of an object is: all of a rigid one, else those around it; as if all had one
    mass."""
    first, m = trajectory.metadata.first, trajectory.names.index(solid.name)
    rows, start, radius = np.arange(first[m], first[m + 1]), trajectory.position(0), ALL
    if not isinstance(solid.elasticity, Rigid):
        away = np.linalg.norm(start[rows] - point, axis=1)
        low, high = shapes.extent(solid.shape)
        radius = max(GRASP * 0.5 * float(np.min(np.subtract(high, low))), float(np.sort(away)[:LEAST][-1]))
        rows = rows[away <= radius]
    centre = start[rows].mean(axis=0)
    return Patch(radius, rows, np.ones(len(rows)), start[rows] - centre, centre)
