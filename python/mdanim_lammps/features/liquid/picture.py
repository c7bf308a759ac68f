# SPDX-License-Identifier: GPL-2.0-only
"""The liquid in pictures, where it is a medium, and in exports, where it is a sheet over its columns."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...picture.drawn import Drawn, Medium
from ...picture.liquid import LiquidSheet
from ...picture.palette import LIQUID, rgb
from .stream import stream_points, stream_triangles


def drawn(trajectory):
    """The sheet, and streams that fall on it."""
    if (pool := trajectory.liquid) is None:
        return ()
    sheet = LiquidSheet(pool.grid)

    @lru_cache(maxsize=1)
    def mesh(frame):
        vertices, normals = sheet.mesh(trajectory.liquid_height(frame).astype(float))
        return vertices + trajectory.liquid_way(frame), normals

    color = tuple(map(float, rgb(pool.color or LIQUID)))
    return (
        Drawn(
            pool.name, lambda frame: mesh(frame)[0], sheet.triangle, color=color, normals=lambda frame: mesh(frame)[1], clear=True
        ),
        *streams(trajectory),
    )


PALE = 0.65
"""Part of white in the colour of a stream."""


def streams(trajectory) -> tuple[Drawn, ...]:
    """A stream for each inflow of the scene."""
    scene = trajectory.scene
    if scene is None or scene.liquid is None:
        return ()
    gravity = float(np.linalg.norm(scene.gravity))
    color = tuple((1.0 - PALE) * rgb(trajectory.liquid.color or LIQUID) + PALE)
    return tuple(
        Drawn(f"inflow {n}", stream_points(trajectory, one, gravity), stream_triangles(), color=color)
        for n, one in enumerate(scene.liquid.inflow, 1)
    )


def medium(trajectory, render):
    """The tank with its liquid."""
    if trajectory.liquid is None:
        return None

    def make(dark, sky, behind):
        from ...picture.tank import Tank

        return Tank(trajectory, render.liquid, dark, sky, behind)

    return Medium(render.liquid == "smooth", make)
