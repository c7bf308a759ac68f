# SPDX-License-Identifier: GPL-2.0-only
"""Whether the ends, edges and tips of held things hold a ball that falls on them: ``python bench/narrow.py`` [pegs, cones, fast].

The tables are those of docs/physics-contact.md, "Narrow things".
"""

import itertools
import sys
import tempfile
from collections.abc import Callable
from contextlib import nullcontext
from unittest import mock

from mdanim_lammps import DivergedError, Scene
from mdanim_lammps.features.contact.surface import SurfaceContact
from timing import print_tables

SPEEDS = (0.2, 1.0, 3.0)
"""Speeds of the ball [m/s]; a wave goes at 39 m/s in it."""
SCENE = """gravity (0, 0, -9.81) m/s^2
object held {{ shape {shape}  position (0, 0, {z}) m  {turned}  hold all }}
object ball {{
  shape sphere 10 cm  position ({at}, 0.003, 0.1005) m  mass 1 kg  elasticity 300 kPa  resolution {h} mm
  velocity (0, 0, -{v}) m/s
}}
control {{ time {time} s  frames 100 fps }}
record ball.position.z
"""
ON_EDGE = "orientation axis (0, 1, 0) angle 90 deg"
HELD: dict[str, Callable[[float], tuple[str, float, str]]] = {
    "end of a cylinder": lambda t: (f"cylinder {t / 2} mm 20 cm", -0.1, ""),
    "end of a square rod": lambda t: (f"box ({t}, {t}, 200) mm", -0.1, ""),
    "edge of a board": lambda t: (f"box ({t}, 400, 200) mm", -0.1, ""),
    "rim of a disc": lambda t: (f"cylinder 15 cm {t} mm", -0.15, ON_EDGE),
}
"""Shape, place and attitude by the thickness [mm]."""


def lowest(shape: str, z: float, turned: str, h: float, v: float, at: float = 0.003, time: float = 0.15) -> str:
    """How far the ball came down, over its radius; ``through`` where the run stops because one is in the other, ``stops`` where
    cells of the ball stay inside out."""
    scene = Scene.from_text(SCENE.format(shape=shape, z=z, turned=turned, h=h, v=v, at=at, time=time))
    with tempfile.TemporaryDirectory() as folder:
        try:
            heights = scene.run(f"{folder}/out", movie=False, progress=False).records["ball.position.z"]
        except DivergedError as error:
            return "through" if "is inside" in str(error) else "stops"
        return f"{1.0 - heights.min() / 0.1:.2f}"


def pegs() -> tuple[list[str], list[list]]:
    """Ends and edges, by cells of the ball and those over the thickness."""
    cases = itertools.product(HELD.items(), (50.0, 25.0), (2.5, 1.5, 1.0, 0.5))
    rows = [[name, f"{h:g}", over, *(lowest(*of(h / over), h, v) for v in SPEEDS)] for (name, of), h, over in cases]
    return ["held", "cells [mm]", "cells over thickness", *(f"{v:g} m/s" for v in SPEEDS)], rows


def cones() -> tuple[list[str], list[list]]:
    """Tips of cones of 20 cm, by their radii and the cells of the ball."""
    cases = itertools.product((2.5, 4.0, 6.0, 8.0, 10.0, 15.0), (50.0, 25.0))
    rows = [[f"{r:g}", f"{h:g}", *(lowest(f"cone {r} cm 20 cm", -0.15, "", h, v) for v in SPEEDS)] for r, h in cases]
    return ["radius [cm]", "cells [mm]", *(f"{v:g} m/s" for v in SPEEDS)], rows


def fast() -> tuple[list[str], list[list]]:
    """Particles, and how far a ball came down at a third and at half of the wave speed: with particles inside of what is held, as
    the program has them, and with its surface alone."""
    held = {
        "slab": ("box (60, 60, 20) cm", -0.1, ""),
        "board": ("box (60, 60, 5) cm", -0.025, ""),
        "its edge": ("box (60, 60, 5) cm", -0.3, ON_EDGE),
        "ball": ("sphere 20 cm", -0.2, ""),
    }
    rows = []
    for (name, (shape, z, turned)), v in itertools.product(held.items(), (13.0, 20.0)):
        found = []
        for alone in (False, True):
            with mock.patch.object(SurfaceContact, "needs_inside", return_value=False) if alone else nullcontext():
                scene = Scene.from_text(SCENE.format(shape=shape, z=z, turned=turned, h=50.0, v=v, at=0.013, time=0.05))
                found += [scene.prepared.system.particles, lowest(shape, z, turned, 50.0, v, at=0.013, time=0.05)]
        rows.append([name, f"{v:g}", *found])
    return ["held", "speed [m/s]", "particles", "came down", "surface alone: particles", "came down"], rows


TABLES = {"pegs": pegs, "cones": cones, "fast": fast}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
