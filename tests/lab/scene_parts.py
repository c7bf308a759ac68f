# SPDX-License-Identifier: GPL-2.0-only
"""Pieces of scene texts."""

from __future__ import annotations

from mdanim_lammps.scene import scene as records
from mdanim_lammps.scene.parse import parse_scene

BALL = {"shape": "sphere 10 cm", "position": "(0, 0, 1) m", "mass": "2 kg", "elasticity": "200 kPa"}


CONTROL = "control { time 3 s }\n"


def text(top: str = "", **settings: str | None) -> str:
    """A scene with one ball on lines 2 to 5 (for an empty ``top``); None leaves a setting out."""
    lines = BALL | settings
    return f"{top}object ball {{\n" + "".join(f"  {w} {v}\n" for w, v in lines.items() if v is not None) + "}\n" + CONTROL


def ball(top: str = "", **settings: str | None) -> records.Solid:
    """The ball of such a scene."""
    return parse_scene(text(top, **settings)).solids[0]


def pool(settings: str = "volume 1 l", gravity: str = "gravity (0, 0, -9) m/s^2\n") -> str:
    """A scene with a liquid; its settings stand on line 3 from column 3 on."""
    basin = "basin from (0, 0, 0) m to (1, 1, 1) m" if "basin" not in settings else ""
    return f"{gravity}liquid w {{\n  {settings}\n{basin}\ndensity 1 g/cm^3 }}\n{CONTROL}"
