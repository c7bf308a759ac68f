# SPDX-License-Identifier: GPL-2.0-only
"""Hard cases with a liquid of density 1000 in cells of 1 m: light and heavy, fast, brimful, nearly dry.

Solids of elasticity 1000 Pa and density 1000 have the wave speed C; g = 0.01 is gentle for them.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from case import CONTROL, C, Case, block, refused, velocity
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.liquid.record import LiquidModel
from trial import START, UNITS, Trial

sys.path.insert(0, str(Path(__file__).parents[1] / "lab"))
import automaton_lab


def pool(density, z=16.0, level=12.0, top=20.0, speed=0.0, young=1000.0, g=0.01, turned=(0, 0, 0), drag=0.0) -> str:
    """A cube of 5^3 cells over, or in, a pool of 16 x 16 cells; ``speed`` in its own wave speeds, downward; air drag lambda/m."""
    fast = speed * C * (young / density) ** 0.5
    return (
        f"gravity (0, 0, {-g!r})\nliquid water {{ basin from (-8, -8, 0) m to (8, 8, {top!r}) m "
        f"density 1000 model surface level {level!r} }}\n"
        + block(
            "cube",
            (5, 5, 5),
            (0.3, -0.2, z),
            young,
            density,
            f"orientation euler {turned} deg drag {drag * density * 125!r} {velocity(z=-fast)}",
        )
        + CONTROL
    )


CALMING = 3.0
"""Waves die to 1/e in 50 sqrt(depth/g): 1700 s in the pool. The automaton has none."""


def come_to_rest(time: float):
    """A player: whatever happens on the way, Archimedes at the end. A liquid with momentum has CALMING times as long."""

    def play(text, long):
        with Trial(text) as t:
            solid, liquid = t.ready.scene.solids[0], t.ready.scene.liquid
            calming = CALMING if liquid.model is LiquidModel.WAVES else 1.0
            t.run_for(calming * (10 * time if long else time), 50)
            return {
                "immersed share": abs(t.immersed("cube") - min(1.0, solid.density / liquid.density)),
                "cells of liquid": t.lost_cells,
                "speed left": np.abs(t.v).max(),
                "cells turned over": t.inverted(),
                "below the floor / h": -t.x[:, 2].min(),
            }

    return play


def floats(name, why="", time=3000.0, below=0.6, **scene) -> Case:
    return Case(
        name,
        pool(**scene),
        come_to_rest(time),
        {"immersed share": 0.02, "cells of liquid": 0, "speed left": 1e-3, "cells turned over": 0, "below the floor / h": below},
        f"{why}Archimedes within 2 % of the side, the resolution of a body of 5 cells; no unit of liquid is lost at any check",
    )


FLOATS = [
    floats("upright", density=500.0),
    floats("tilted", density=500.0, turned=(20, 35, 10)),
    floats("on its corner", density=500.0, turned=(45, 35.264, 0)),
    floats("entry at 0.3 c", density=500.0, speed=0.3),
    floats("entry at 0.82 c", density=500.0, speed=0.82, level=16.0, top=28.0, z=22.0),
    floats("light, released from the bottom", density=300.0, z=2.7),
    floats("density 0.01 of the liquid", "A hundredth displaces less than a cell. ", density=10.0),
    floats("density 0.01, released from the bottom", "It shoots up and jumps. ", density=10.0, z=2.7),
    floats("density 3", "It lies on the floor. ", density=3000.0, young=1e4, g=0.003),
    floats(
        "density 100",
        "It lies on the floor; air drag ends its bouncing, because so light a liquid does not. ",
        density=1e5,
        young=1e6,
        g=0.01,
        drag=0.02,
    ),
    floats("20 times softer", density=500.0, young=50.0, g=0.002, time=7000.0),
]

# --- full and empty -----------------------------------------------------------------------------------------------


def tub(amount: str, solid: str) -> str:
    """A basin of 10^3 cells."""
    return (
        f"gravity (0, 0, -0.01)\nliquid water {{ basin from (0, 0, 0) m to (10, 10, 10) m "
        f"density 1000 model surface {amount} }}\n"
        f"{solid}{CONTROL}"
    )


def standing(size=4, z=5.0) -> str:
    return block("s", (size,) * 3, (5, 5, z), 1000.0, 500.0, "hold all")


def loose(z=12.5) -> str:
    return block("s", (4, 4, 4), (5, 5, z), 1000.0, 500.0)


def keep(units: int):
    """A player: nothing breaks and the liquid is all there."""

    def play(text, long):
        with Trial(text) as t:
            t.run(100_000 if long else 5_000)
            return {
                "cells of liquid": max(t.lost_cells, abs(t.instance.fix_value("liquid", UNITS) - units)),
                "cells at the start": abs(t.instance.fix_value("liquid", START) - units),
                "cells turned over": t.inverted(),
            }

    return play


KEPT = {"cells of liquid": 0, "cells at the start": 0, "cells turned over": 0}
FULL = [
    Case(
        "brimful round a held cube",
        tub("volume 936", standing()),
        keep(936),
        KEPT,
        "no free cell: nothing can move, nothing is lost",
    ),
    Case("one free cell", tub("volume 935", standing()), keep(935), KEPT, "one unit has room to move"),
    Case(
        "brimful by a floating cube",
        tub("volume 968", loose()),
        keep(968),
        KEPT,
        "liquid and the floating cube fill the basin completely",
    ),
    Case(
        "one unit in a dry basin", tub("volume 1", loose(3.0)), keep(1), KEPT, "the cube lands on a floor with one cell of liquid"
    ),
]


def no(name: str, text: str, words: str) -> Case:
    return Case(
        name,
        text,
        lambda text, long: refused(text, SceneError, words),
        {"not refused": 0},
        "refused before the run, with its place in the scene",
    )


REFUSED = [
    no("one unit too much for a floating cube", tub("volume 969", loose()), "displaces up to 32 m^3"),
    no("brimful, and a cube falls in", tub("volume 1000", loose()), "has room for 0 m^3 more"),
    no("one and a half basins of liquid", tub("volume 1500", standing(z=13.0)), "do not fit into the basin"),
    no("a level above the basin", tub("level 15", standing(z=20.0)), "is outside the basin"),
    no("dry", tub("volume 0.4", loose()), "less than half a cell"),
    no("no room", tub("volume 1", standing(10)), "has room for 0 m^3"),
]


def moving_masks(text: str, long: bool) -> dict[str, float]:
    """The automaton alone, with cells that turn solid and open again at random: no scene does this so fast."""
    random, lost, wet = np.random.default_rng(5), 0, 0
    for seed in range(100 if long else 20):
        shape = tuple(random.integers(3, 10, 3))
        a = automaton_lab.Automaton(shape, seed=seed)
        a.fill(int(np.prod(shape) * random.uniform(0.1, 0.5)))
        units = a.total
        for _ in range(100):
            solid = (random.random(shape) < random.uniform(0.0, 0.5)).astype(np.uint8)
            if solid.all():
                continue
            a.displace(solid)
            a.sweep(2)
            lost, wet = (max(lost, abs(int(a.content.sum()) - units)), wet + int((a.content[solid > 0] > 0).sum()))
    return {"cells of liquid": lost, "solid cells with liquid": wet}


MASKS = Case(
    "moving masks",
    "",
    moving_masks,
    {"cells of liquid": 0, "solid cells with liquid": 0},
    "20 runs of 100 random masks with up to half of all cells solid: units are whole numbers, none may get lost",
)

# --- with momentum ------------------------------------------------------------------------------------------------

RESTLESS = ("density 0.01 of the liquid", "density 0.01, released from the bottom")
"""Cases that do not come to rest in waves: a body of up to 0.1 of the liquid's density moves at one to four sqrt(g cell)."""


def in_waves(case: Case) -> Case:
    """The same case with `model waves`, which die in a third of its time or less."""
    scene = case.scene.replace(" model surface ", " model waves calm 1000 s ")
    assert scene != case.scene, f"{case.name} tells no model"
    return replace(case, name=f"{case.name}, waves", scene=scene)


WAVES = [in_waves(case) for case in (*FLOATS, *FULL, *REFUSED) if case.name not in RESTLESS]
RESTLESS_IN_WAVES = [in_waves(case) for case in FLOATS if case.name in RESTLESS]

CASES = [*FLOATS, *FULL, *REFUSED, MASKS, *WAVES]
