# SPDX-License-Identifier: GPL-2.0-only
"""Measures of pictures: where a point is seen, which pixels have a colour."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.picture.lens import FIELD_OF_VIEW
from mdanim_lammps.picture.palette import rgb


def project(view, points, aspect):
    """Where points are in the picture: -1 .. 1 across and up for what is inside, and their depth."""
    forward = (view.look - view.eye) / np.linalg.norm(view.look - view.eye)
    right = np.cross(forward, view.up)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    local = (points - view.eye) @ np.stack([right, up, forward], axis=1)
    half = np.tan(np.radians(FIELD_OF_VIEW / 2))
    return local[:, :2] / local[:, 2:] / [half * aspect, half], local[:, 2]


def hue_mask(image, color):
    """Pixels whose colour has the direction of ``color``, however bright: the object in light and shadow."""
    wanted = rgb(color) - rgb(color).mean()
    found = image - image.mean(axis=2, keepdims=True)
    size = np.linalg.norm(found, axis=2)
    return (size > 0.08) & (found @ wanted > 0.9 * size * np.linalg.norm(wanted))


SIZE = (480, 270)


def dry(grid):
    """Heights of an empty basin [m]."""
    return np.full(grid.shape[1::-1], grid.low[2])


def spot(image, view, point):
    """Median colour of a few pixels around a point of space."""
    (x, y), _ = (a[0] for a in project(view, np.array([point], dtype=float), SIZE[0] / SIZE[1]))
    column, row = round((x + 1) / 2 * SIZE[0]), round((1 - y) / 2 * SIZE[1])
    return np.median(image[row - 2 : row + 3, column - 2 : column + 3].reshape(-1, 3), axis=0)
