# SPDX-License-Identifier: GPL-2.0-only
"""Surroundings of the objects of a trajectory: ground, walls, liquid, for the modules that draw them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from .. import features
from ..features.liquid.kept import Pool
from ..results.trajectory_metadata import TrajectoryMetadata
from ..scene.scene import SceneRecord, Vector


class Scenery(NamedTuple):
    """None for what is not there."""

    ground: float | None
    """Height of the ground plane [m]."""
    walls: tuple[Vector, Vector] | None
    """Lower and upper corner of the box that objects never leave [m]."""
    liquid: Pool | None


def scenery(metadata: TrajectoryMetadata) -> Scenery:
    """The scenery of a trajectory."""
    ground, walls, liquid = (metadata.kept.get(name) for name in ("ground", "walls", "liquid"))
    return Scenery(ground and ground.ground, walls and walls.walls, liquid)


def way_of_walls(scene: SceneRecord | None) -> Callable[[float], Vector] | None:
    """Displacement of the box of the walls at a time [s], in [m]; None where it stands, or where the scene is not known."""
    if scene is None or scene.walls is None:
        return None
    planes = (p for e in features.effects() for p in e.of(scene).planes(scene))
    return next((p.motion.at for p in planes if p.effect == "walls" and p.motion), None)
