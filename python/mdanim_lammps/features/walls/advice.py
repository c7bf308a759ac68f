# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on walls that move."""

from __future__ import annotations

from ...effects.envelope import Envelope
from ...errors import Problem
from ...scene.formatting import number, vector
from ..drives.shift import motion_of
from ..drives.words import DriveOscillation, DriveVelocity


def notes(envelope: Envelope) -> list[Problem]:
    """Walls that come into a basin that stands: they push objects, and run through the liquid."""
    scene = envelope.scene
    walls, liquid = scene.walls, scene.liquid
    if walls is None or liquid is None or liquid.moves:
        return []
    way = motion_of("walls", scene.walls_drive, scene.walls_keys, scene.control.time)
    if way is None:
        return []
    sides = zip(walls.low, walls.high, liquid.low, liquid.high, way.low, way.high)
    if not any(low + up > bottom or high + down < top for low, high, bottom, top, down, up in sides):
        return []
    cause = f"the walls move, and run through {liquid.name}, whose basin stands"
    if way.low[2] or way.high[2]:
        way_out = "a basin moves along x and y alone: take the motion along z out, or use larger walls"
    else:
        keys = (f"key {number(key.time, 6)} s by {vector(key.by)} m" for key in scene.walls_keys)
        lines = ", ".join([*map(_drive_line, scene.walls_drive), *keys])
        way_out = f"write {lines} in {liquid.name}, too, or use larger walls"
    return [Problem(scene.spans.get("walls"), cause, way_out, severity="warning")]


def _drive_line(drive: DriveVelocity | DriveOscillation) -> str:
    """As it is written in a liquid."""
    if isinstance(drive, DriveVelocity):
        return f"drive velocity {vector(drive.velocity)} m/s"
    phase = f" phase {number(drive.phase, 6)} rad" if drive.phase else ""
    return f"drive oscillation {vector(drive.way)} m frequency {number(drive.frequency, 6)} Hz{phase}"
