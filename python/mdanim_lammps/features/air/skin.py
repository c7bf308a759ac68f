# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces that air pushes at: points that are weighted sums of particles, and triangles, cylinders, balls or panels of these."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...model.model import Model
from ...model.triangles import areas, normals
from ...records import dataclass
from ...scene.scene import Sphere
from .coarser import coarser

FINE = 16
"""Edges of triangles along the longest one of an object that does not deform, before they become panels."""
BINS = 6
"""Directions of panels along the edge of a cube around a sphere: a ball of such panels has 0.4 % less drag than the sphere."""
SLACK = 1.3
"""Strain of a link above which it is torn for sure, over ``tear-strain``."""
CORNERS = 8
"""Most particles of an object that does not deform by which its surface is found; others have a lattice."""
WIDE = 0.05
"""Standard deviation of the places in a panel, over the longest edge of the object, above which it is four."""


@dataclass(frozen=True, eq=False)
class AirPart:
    """Things at points, with a number or a vector each."""

    word: str
    at: np.ndarray
    """Numbers of points, shape (n, K)."""
    value: np.ndarray
    """Shape (n, C)."""
    area: np.ndarray
    """Area that air may push at [m^2], shape (n,)."""

    def lines(self) -> list[str]:
        """In the file of the fix."""
        rows = zip((self.at + 1).tolist(), self.value.tolist())
        return [" ".join([self.word, *map(str, at), *map(repr, value)]) for at, value in rows]


@dataclass(frozen=True, eq=False)
class AirSkin:
    """The surface of an object of N particles."""

    index: np.ndarray
    """Particles of which a point is the sum, shape (P, K)."""
    weight: np.ndarray
    """Their weights, shape (P, K)."""
    parts: Sequence[AirPart]
    both: bool = False
    """Whether air pushes at both sides."""

    @property
    def area(self) -> float:
        """All of it [m^2]."""
        return sum(float(part.area.sum()) for part in self.parts)

    def carried(self, particles: int) -> np.ndarray:
        """Area that each particle carries, by the weights of points [m^2], shape (N,)."""
        of_point = np.zeros(len(self.index))
        for part in self.parts:
            for column in part.at.T if part.area.any() else ():
                np.add.at(of_point, column, part.area / part.at.shape[1])
        found = np.zeros(particles)
        np.add.at(found, self.index, np.abs(self.weight) * of_point[:, None])
        return found

    def text(self) -> str:
        """Its lines in the file of ``fix mdanim/air`` (docs/fix_mdanim_air.md)."""
        points = (
            "point " + " ".join(f"{i + 1} {w!r}" for i, w in zip(row, weights) if w)
            for row, weights in zip(self.index.tolist(), self.weight.tolist())
        )
        return "".join(f"{line}\n" for line in [*points, *(line for part in self.parts for line in part.lines())])


def skin_of(model: Model, solid: Any) -> AirSkin:
    """The surface of an object: links of a rope, triangles of a sheet from both sides, of a closed one and of a solid that
    deforms from outside, panels or a ball of what does not deform."""
    surface, n = model.surface, len(model.position)
    if model.frame.dimensions == 1:
        links = np.stack([np.arange(n - 1), np.arange(1, n)], axis=1)
        diameter = solid.shape.thickness
        length = np.linalg.norm(np.diff(model.position, axis=0), axis=1)
        value = np.full((n - 1, 1), diameter)
        if solid.tear_strain is not None:
            value = np.column_stack([value, (1.0 + SLACK * solid.tear_strain) * solid.shape.length / (n - 1) * np.ones(n - 1)])
        cylinders = AirPart("cylinder", links, value, diameter * length)
        return AirSkin(np.arange(n)[:, None], np.ones((n, 1)), (cylinders,), both=True)
    if model.frame.dimensions == 2:
        triangle = model.frame.triangle
        sheet = AirPart("triangle", triangle, np.zeros((len(triangle), 0)), areas(model.position, triangle))
        return AirSkin(np.arange(n)[:, None], np.ones((n, 1)), (sheet,), both=not model.frame.closed)
    corner = np.unique(surface.index)
    if len(corner) <= CORNERS and (model.inertia is not None or model.held.all()):
        return _of_one_piece(model, solid, corner)
    index, weight, triangle = coarser(surface, model.position, float(min(model.cell)))
    place = np.einsum("pk,pkd->pd", weight, model.position[index])
    return AirSkin(index, weight, (AirPart("triangle", triangle, np.zeros((len(triangle), 0)), areas(place, triangle)),))


def _sizes(vectors: np.ndarray) -> np.ndarray:
    return np.linalg.norm(vectors, axis=1)


# --- what does not deform ---------------------------------------------------------------------------------------------


def _of_one_piece(model: Model, solid: Any, corner: np.ndarray) -> AirSkin:
    """The skin of an object that does not deform, by these particles, which show where it is."""
    x, middle = model.position[corner], np.array(solid.position, float)
    # The smallest weights that sum to 1 and give a place.
    inverse = np.linalg.pinv(np.vstack([(x - middle).T, np.ones(len(x))]))

    def point(place: np.ndarray) -> np.ndarray:
        return np.column_stack([place - middle, np.ones(len(place))]) @ inverse.T

    if isinstance(solid.shape, Sphere):
        diameter = 2.0 * solid.shape.radius
        ball = AirPart("ball", np.zeros((1, 1), int), np.array([[diameter]]), np.array([0.25 * np.pi * diameter**2]))
        return AirSkin(corner[None], point(middle[None]), (ball,), both=True)
    frame = _frame(x)
    place, area = _panels(*_refined(model.surface.vertices(model.position), model.surface.triangle), solid)
    edge = x[frame[1:]] - x[frame[0]]
    part = np.linalg.solve(np.cross(edge[[1, 2, 0]], edge[[2, 0, 1]]).T, area.T).T
    weight = np.concatenate([np.eye(len(x))[frame], point(place)])
    none = np.zeros((1, 0))
    panels = AirPart("panel", 4 + np.arange(len(place))[:, None], part, _sizes(area))
    parts = (AirPart("frame", np.arange(4)[None], none, np.zeros(1)), panels)
    return AirSkin(np.broadcast_to(corner, weight.shape), weight, parts)


def _frame(x: np.ndarray) -> np.ndarray:
    """Four places of some [m], shape (K, 3), that are far from one plane."""
    far = ((x - x[0]) ** 2).sum(axis=1)
    first = int(far.argmax())
    across = (np.cross(x - x[0], x[first] - x[0]) ** 2).sum(axis=1)
    second = int(across.argmax())
    out = np.abs((x - x[0]) @ np.cross(x[first] - x[0], x[second] - x[0]))
    return np.array([0, first, second, int(out.argmax())])


def _refined(place: np.ndarray, triangle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles that are halved at their longest edges until none is longer than the longest edge of the object over FINE;
    places [m], shape (V, 3), and triangles, shape (T, 3)."""
    most = float(np.linalg.norm(np.ptp(place, axis=0))) / FINE
    done = []
    while len(triangle):
        edge = np.stack([_sizes(place[triangle[:, (k + 1) % 3]] - place[triangle[:, k]]) for k in range(3)])
        longest, long = edge.argmax(axis=0), edge.max(axis=0) > most
        done.append(triangle[~long])
        # Corners from the longest edge on: a, b its ends, c opposite to it.
        a, b, c = (triangle[long][np.arange(long.sum()), (longest[long] + k) % 3] for k in range(3))
        # Numbers in place of rows: sorted in the same order, in a quarter of the time.
        pair, middle = np.unique(np.minimum(a, b) * np.int64(len(place)) + np.maximum(a, b), return_inverse=True)
        first, second = np.divmod(pair, len(place))
        middle = len(place) + middle
        place = np.concatenate([place, 0.5 * (place[first] + place[second])])
        triangle = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return place, np.concatenate(done)


def _panels(place: np.ndarray, triangle: np.ndarray, solid: Any) -> tuple[np.ndarray, np.ndarray]:
    """Places [m], shape (n, 3), and areas with directions [m^2], shape (n, 3), of panels.

    A panel has the triangles of about one direction in one eighth of the box around the object. A wide one becomes four, a
    standard deviation of its places off its middle: on a rectangle these are the points of Gauss's rule, so that a plate that
    turns about its middle has the torque of the integral.
    """
    turn = np.array(solid.rotation, float)
    area, middle = 0.5 * normals(place, triangle), place[triangle].mean(axis=1)
    keep = _sizes(area) > 0.0
    area, middle = area[keep], middle[keep]
    size = _sizes(area)
    own, normal = (middle - solid.position) @ turn, (area / size[:, None]) @ turn
    box = place @ turn
    half = (own > 0.5 * (box.min(axis=0) + box.max(axis=0)) - np.asarray(solid.position) @ turn).astype(int)
    side = np.abs(normal).argmax(axis=1)
    on_cube = normal / np.take_along_axis(np.abs(normal), side[:, None], axis=1)
    bins = np.floor(0.5 * BINS * (1.0 + on_cube) * (1.0 - 1e-9)).astype(int)
    number = np.unique(_in_one(np.column_stack([half, side, bins])), return_inverse=True)[1]
    count = int(number.max()) + 1

    def summed(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(number, column, count) for column in values.reshape(len(values), -1).T], axis=1)

    whole, total = summed(area), summed(size)[:, 0]
    centre = summed(size[:, None] * middle) / total[:, None]
    off = middle - centre[number]
    # Places within a triangle vary as well: a twelfth of the sum over its corners.
    corners = place[triangle[keep]] - middle[:, None]
    spread = off[:, :, None] * off[:, None, :] + np.einsum("tci,tcj->tij", corners, corners) / 12.0
    variance, axis = np.linalg.eigh((summed(size[:, None, None] * spread) / total[:, None]).reshape(-1, 3, 3))
    long, across = (np.sqrt(np.maximum(variance[:, k], 0.0))[:, None] * axis[:, :, k] for k in (2, 1))
    wide = _sizes(long) > WIDE * float(np.linalg.norm(np.ptp(place, axis=0)))
    four = [centre[wide] + a * long[wide] + b * across[wide] for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    return np.concatenate([centre[~wide], *four]), np.concatenate([whole[~wide], *([0.25 * whole[wide]] * 4)])


def _in_one(rows: np.ndarray) -> np.ndarray:
    """A number for each row of small whole numbers, int64, shape (n,), in the order of rows."""
    number = np.zeros(len(rows), np.int64)
    for column in rows.T:
        number = number * (int(column.max()) + 1) + column
    return number
