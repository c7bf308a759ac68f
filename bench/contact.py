# SPDX-License-Identifier: GPL-2.0-only
"""The two laws of contact, measured: ``python bench/contact.py [TABLE ...]``, all of TABLES without a word.

Every row is a short scene of its own; the tables are those of docs/physics-contact.md.
"""

import itertools
import math
import sys
from collections.abc import Callable

import numpy as np
from contact_at_rest import hertz, lattice, rest
from contact_world import MODELS, STUFF, WAVE, World, inertia
from timing import print_tables

G = 9.81


def tilted(tangent: float) -> str:
    """Gravity of a slope that goes down along +x."""
    c = 1.0 / math.hypot(1.0, tangent)
    return f"gravity ({G * tangent * c!r}, 0, {-G * c!r})\nground z 0"


def block(z: float = 10.0, cells: int = 4, more: str = "") -> tuple[str, str]:
    """A cube of 20 cm, and the words of control for its cells."""
    return (
        f"object c {{ shape box (20, 20, 20) cm  position (0.3, 0.2, {z}) cm  {STUFF}  {more} }}",
        f"resolution {20 / cells} cm",
    )


# --- what is measured: rows of a table ------------------------------------------------------------------------------


def slope() -> tuple[list[str], list[list]]:
    """A cube on a slope with mu 0.5: what it moves after it has settled; how fast it slides."""
    rows = []
    for tangent in (0.40, 0.48, 0.60, 0.80):
        text, control = block()
        world = World(f"{tilted(tangent)}\n{text}", f"{control}  friction 0.5")
        world.run(1.0)
        place, speed = world.place[0], world.velocity[0]
        world.run(1.0)
        c = 1.0 / math.hypot(1.0, tangent)
        want = G * c * (tangent - 0.5)
        moved = (world.place[0] - place) / 0.2
        gained = (world.velocity[0] - speed) / want
        rows.append([tangent, f"{moved:.1e}" if tangent < 0.5 else "slides", f"{gained:.4f}" if tangent > 0.5 else "-"])
        world.close()
    return ["tangent of the slope", "moves in the second second [side]", "acceleration over g (sin - mu cos)"], rows


def level() -> tuple[list[str], list[list]]:
    """A cube that slides on the level with mu 0.3 and stops."""
    rows = []
    for speed in (0.5, 1.0, 2.0):
        text, control = block(more=f"velocity ({speed}, 0, 0)")
        world = World(f"gravity (0, 0, {-G})\nground z 0\n{text}", f"{control}  friction 0.3")
        place = world.place[0]
        world.run(2.0 * speed / (0.3 * G))
        rows.append([speed, f"{(world.place[0] - place) / (speed**2 / (2 * 0.3 * G)):.4f}"])
        world.close()
    return ["speed [m/s]", "stopping way over v^2/(2 mu g)"], rows


def roll() -> tuple[list[str], list[list]]:
    """A ball rolls down a slope with a tangent of 0.2, mu 0.5; I is that of its lattice."""
    rows = []
    for cells in (6, 8, 12):
        world = World(
            f"{tilted(0.2)}\nobject c {{ shape sphere 10 cm  position (0.1, 0.07, 10) cm  density 1000  elasticity 4 MPa }}",
            f"resolution {20 / cells} cm  friction 0.5",
        )
        arm = world.instance.array("x")[world.mine] - world.place
        share = inertia(world.mass, arm)[1, 1] / (world.mass.sum() * 0.01)
        want = G * 0.2 / math.hypot(1.0, 0.2) / (1.0 + share)
        place = world.place.copy()
        world.run(0.8)
        way = world.place - place
        rows.append([cells, f"{share:.3f}", f"{way[0] / (0.5 * want * 0.64):.4f}", f"{abs(way[1] / way[0]):.1e}"])
        world.close()
    return ["cells across", "I/(M R^2)", "way over that of g sin/(1 + I/(M R^2))", "aside over way"], rows


SLABS = {"held": f"{STUFF}  hold all", "ten times as stiff": STUFF.replace("1 MPa", "10 MPa"), "as soft": STUFF}
BLOW = 0.01
"""Speed of a blow on a corner [c]."""
CORNER_CELLS = (4, 6, 8, 12)
HALF_TURN = math.radians(30.0), math.radians(60.0)
"""Turn of the cube, about (1, 1, 0) and then about z."""


def turned_cube() -> np.ndarray:
    """Rotation of a cube that falls on one of its corners, shape (3, 3)."""
    tilt, way = HALF_TURN
    c, s, k = math.cos(tilt), math.sin(tilt) / math.sqrt(2.0), 0.5 * (1.0 - math.cos(tilt))
    tilted = np.array([[c + k, k, s], [k, c + k, -s], [-s, s, c]])
    c, s = math.cos(way), math.sin(way)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ tilted


def corner() -> tuple[list[str], list[list]]:
    """A cube falls on its corner at 0.01 c: speeds after the first blow over that before, spin, energy that is missing."""
    rows = [
        [slab, cells, *(value for model in MODELS for value in blow(SLABS[slab], cells, model))]
        for slab in SLABS
        for cells in (2, 3, 4, 6, 8, 12)
    ]
    return ["slab", "cells"] + [f"{m}: {what}" for m in MODELS for what in ("up", "aside", "spin L/v", "energy")], rows


def slow_corner() -> tuple[list[str], list[list]]:
    """A cube falls on its corner onto the held slab: speed upward after the blow over that before, with surfaces."""
    rows = [
        [f"{speed:g} c", *(blow(SLABS["held"], cells, "surface", speed)[0] for cells in CORNER_CELLS)]
        for speed in (0.0006, 0.0025, 0.01, 0.04)
    ]
    return ["speed", *(f"{cells} cells" for cells in CORNER_CELLS), "rigid"], [[*row, f"{rigid_blow():.3f}"] for row in rows]


def rigid_blow() -> float:
    """Speed upward after a blow on the corner of a rigid cube that loses no energy, over that before."""
    arm = min((turned_cube() @ np.array(signs) for signs in itertools.product((-0.5, 0.5), repeat=3)), key=lambda one: one[2])
    return 2.0 / (1.0 + 6.0 * (arm[0] ** 2 + arm[1] ** 2)) - 1.0


def blow(slab: str, cells: int, model: str, speed: float = BLOW) -> list[str]:
    """Rows of a cube of this many cells that comes at a speed [c]; the blow is over when its speed has changed and changes no
    more."""
    turn, h, v = turned_cube(), 100 / cells, speed * WAVE
    rows = " ".join(f"({x!r}, {y!r}, {z!r})" for x, y, z in turn.tolist())
    low = 50.0 * np.abs(turn[2]).sum()
    world = World(
        f"object slab {{ shape box (200, 200, 100) cm  position (0, 0, -50) cm  {slab} }}\n"
        f"object c {{ shape box (100, 100, 100) cm  position (0, 0, {low + h * (0.1 if model == 'surface' else 0.9)}) cm\n"
        f"orientation matrix {rows}\n{STUFF}  velocity (0, 0, {-v}) }}",
        f"resolution {h} cm  contact-model {model}",
    )
    falling, before = 0.5 * world.mass.sum() * v**2, world.velocity
    for _ in range(500):
        world.run(0.002 / v)
        change, before = world.velocity - before, world.velocity
        if before[2] > -0.9 * v and np.abs(change).max() < 1e-4 * v:
            break
    spin = np.linalg.norm(world.spin()) / v
    off = abs(world.energy() - world.start) / falling
    world.close()
    return [f"{before[2] / v:.3f}", f"{math.hypot(before[0], before[1]) / v:.3f}", f"{spin:.3f}", f"{off:.0e}"]


def plate(cells: int, aside: tuple[float, float], width: int = 60) -> tuple[str, str]:
    """A plate of so many cells that is held at its ends, and a block that meets it so many cells off its middle [cm]."""
    x, y = (10 * d for d in aside)
    return (
        f"box (120, {width}, {10 * cells}) cm  position (0, 0, {-5 * cells}) cm  hold faces x",
        f"box (50, 50, 50) cm  position ({x}, {y}, 33) cm",
    )


def cubes(cells: int, aside: tuple[float, float], more: str = "") -> tuple[str, str]:
    """Two cubes of so many cells, face on face."""
    a, x, y = 10 * cells, *(10 * d for d in aside)
    return (
        f"box ({a}, {a}, {a}) cm  position (0, 0, {-a / 2}) cm",
        f"box ({a}, {a}, {a}) cm  position ({x}, {y}, {a / 2 + 8}) cm {more}",
    )


CORNER = "orientation axis (1, -1, 0) angle 54.7356 deg"
LOWER_CORNER = f"box (40, 40, 40) cm  position (0, 0, -34.641) cm  {CORNER}"
LOWER_BALL = "sphere 20 cm  position (0, 0, -20) cm"
MEETINGS = {
    "plate of 1 cell": plate(1, (0, 0)),
    "half a cell aside along x, y": plate(1, (0.5, 0.5)),
    "along y": plate(1, (0, 0.5)),
    "plate of 2 cells": plate(2, (0, 0)),
    "half a cell aside": plate(2, (0.5, 0.5)),
    "needle of 1 x 1 cells": plate(1, (0, 0), 10),
    "half a cell beside it": plate(1, (0.5, 0.5), 10),
    "cubes of 2 cells, aside": cubes(2, (0.5, 0.5)),
    "cubes of 3 cells, aside": cubes(3, (0.5, 0.5)),
    "cubes of 4 cells, turned": cubes(4, (0.3, 0.2), "orientation axis (0, 0, 1) angle 30 deg"),
    "edge on edge": (
        "box (40, 40, 40) cm  position (0, 0, -28.285) cm  orientation axis (1, 0, 0) angle 45 deg",
        "box (40, 40, 40) cm  position (0, 0, 36.285) cm  orientation axis (0, 1, 0) angle 45 deg",
    ),
    "corner on corner": (LOWER_CORNER, f"box (40, 40, 40) cm  position (0, 0, 42.641) cm  {CORNER}"),
    "0.3 cells aside": (LOWER_CORNER, f"box (40, 40, 40) cm  position (3, 0, 42.641) cm  {CORNER}"),
    "balls": (LOWER_BALL, "sphere 20 cm  position (3, 2, 28) cm"),
    "ball on a corner": (LOWER_BALL, f"box (40, 40, 40) cm  position (3, 0, 42.641) cm  {CORNER}"),
    "ball on a plate of 1 cell": (plate(1, (0, 0))[0], "sphere 20 cm  position (3, 2, 28) cm"),
}
"""Shapes, places and what is held of what meets, the upper one from above; spacing 10 cm."""
SPEEDS = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Closing speeds over the wave speed."""


def passing() -> tuple[list[str], list[list]]:
    """The lowest closing speed in c at which something passes, and the most energy that is off up to 0.5 c (10 cm cells)."""
    rows = []
    for name, (lower, upper) in MEETINGS.items():
        row = [name]
        for model in MODELS:
            off, passes = 0.0, ""
            for speed in SPEEDS:
                missing = met(lower, upper, speed * WAVE, model)
                if missing is None:
                    passes = f"{speed}"
                    break
                off = max(off, missing if speed <= 0.5 else 0.0)
            row += [passes or f"> {SPEEDS[-1]}", f"{off:.0e}"]
        rows.append(row)
    return ["what meets"] + [f"{m}: {what}" for m in MODELS for what in ("passes at [c]", "energy")], rows


def met(lower: str, upper: str, speed: float, model: str) -> float | None:
    """The upper body meets the lower one [m/s]: the share of the energy that is off when they have parted, else None."""
    world = World(
        f"object a {{ shape {lower}  {STUFF} }}\nobject b {{ shape {upper}  {STUFF}  velocity (0, 0, {-speed}) }}",
        f"resolution 10 cm  contact-model {model}",
    )
    try:
        world.run(1.5 / speed + 0.3)
        lower_one = slice(0, world.mine.start)
        below, sinking = (
            np.average(world.instance.array(name)[lower_one, 2], weights=world.ready.system.mass[lower_one]) for name in "xv"
        )
        parted = world.place[2] > below + 0.1 and world.velocity[2] > sinking
        return abs(world.energy() / world.start - 1.0) if parted else None
    finally:
        world.close()


TABLES: dict[str, Callable[[], tuple[list[str], list[list]]]] = {
    "rest": rest, "hertz": hertz, "lattice": lattice, "slope": slope, "level": level, "roll": roll, "corner": corner,
    "slow_corner": slow_corner, "pass": passing,
}  # fmt: skip


if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
