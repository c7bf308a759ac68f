# SPDX-License-Identifier: GPL-2.0-only
"""Hard cases of objects that meet: contrasts, impacts, thin ones, towers."""

from __future__ import annotations

import itertools

import numpy as np
from case import CONTROL, C, Case, block, velocity
from trial import Trial

# --- head on ------------------------------------------------------------------------------------------------------


def head_on(speed, cells=5, offset=(0.0, 0.0), left=(1.0, 1.0), right=(1.0, 1.0)) -> str:
    """Two cubes that close in at ``speed`` C, each with (elasticity, density); the right one displaced sideways."""
    half = 0.5 * speed * C
    size = (cells,) * 3
    return (
        block("a", size, (0, 0, 0), *left, velocity(half))
        + block("b", size, (cells + 1.7, *offset), *right, velocity(-half))
        + CONTROL
    )


def collide(text: str, long: bool) -> dict[str, float]:
    """Let a and b meet along x and part again."""
    with Trial(text) as t:
        closing = t.velocity("a")[0] - t.velocity("b")[0]
        left, right = t.face("a", 0, 1), t.face("b", 0, -1)
        gaps = []
        t.run_for((10 if long else 1) * (8.0 / closing + 25.0), 200, lambda: gaps.append(t.gap(left, right, 0)))
        parting = t.velocity("b")[0] - t.velocity("a")[0]
        return {"energy drift": t.drift, "overlap of the surfaces / h": -min(gaps), "speed lost": 1.0 - parting / closing}


def collision(name, why, drift, overlap, lost, **scene) -> Case:
    most = {"energy drift": drift, "overlap of the surfaces / h": overlap, "speed lost": lost}
    return Case(name, head_on(**scene), collide, most, why)


BOUNCES = (
    "a speed lost below 1 means that they separate again; the rest of the energy is vibration inside them. "
    "The overlap is less than the spacing between a surface and the barrier particles below it"
)
HALF = "springs are resolved at half of the bound: the energy of leap-frog holds to 1e-3 (docs/physics-solids.md)"
CONTRASTS = [
    collision(
        "stiffness 1:1000",
        f"{BOUNCES}. The step is that of the stiff one, so the soft one is followed 32 times finer",
        1e-4,
        0.5,
        0.9,
        speed=0.2,
        cells=4,
        left=(1000.0, 1.0),
    ),
    collision(
        "density 1:1000", f"{BOUNCES}. The heavy one hardly slows down", 1e-4, 0.5, 0.9, speed=0.2, cells=4, left=(1.0, 1000.0)
    ),
    collision("stiff and heavy, 1:1000 each", BOUNCES, 1e-4, 0.5, 0.9, speed=0.2, cells=4, left=(1000.0, 1000.0)),
    collision(
        "stiff and light on soft and heavy", BOUNCES, 1e-4, 0.5, 0.9, speed=0.2, cells=4, left=(1000.0, 1.0), right=(1.0, 1000.0)
    ),
]
IMPACTS = [
    collision(
        f"impact at {speed:g} c",
        f"{BOUNCES}. {HALF}; above 0.5 c surface cells fold up, and 1 to 2 % is allowed",
        1e-3 if speed <= 0.5 else 1e-2 if speed < 1.0 else 2e-2,
        overlap,
        0.95,
        speed=speed,
    )
    for speed, overlap in ((0.2, 0.2), (0.5, 0.45), (0.8, 0.6), (1.0, 0.8))
]
PASSES_AT = {2: 0.65, 3: 1.2, 4: 1.4, 5: 1.65}
"""Cells across a cube, and the closing speed over C from which two of them pass through each other (bench/stability.py)."""
WORST = (0.5, 0.5)
"""Sideways displacement at which they do first: every corner on the middle of a face of the lattice."""
TUNNELS = [
    collision(
        f"0.9 of the tunnelling speed, {cells} cells",
        "they must not pass. So hard a blow crushes cells; beyond the wave speed 2 % of the energy is allowed. "
        "The overlap passes the first layer of barrier particles; deeper ones push out",
        2e-2,
        1.5,
        0.9,
        speed=0.9 * fast,
        cells=cells,
        offset=WORST,
    )
    for cells, fast in PASSES_AT.items()
]


def tunnelling_speed(cells: int, offset, model: str = "paper", step: float = 0.05, fastest: float = 3.0) -> float:
    """Lowest closing speed over C, in multiples of ``step``, at which two cubes do not part again (scan upward)."""
    for n in range(1, int(fastest / step) + 1):
        text = head_on(n * step, cells, offset).replace("contact-model paper", f"contact-model {model}")
        if collide(text, False)["speed lost"] >= 1.0:
            return n * step
    return np.inf


def plate_tunnelling_speed(cells: int, offset, model: str = "paper", step: float = 0.05, fastest: float = 3.0) -> float:
    """The same for a block on a clamped plate."""
    for n in range(1, int(fastest / step) + 1):
        text = onto_plate(n * step, cells, offset).replace("contact-model paper", f"contact-model {model}")
        if dropped("plate")(text, False)["passed"]:
            return n * step
    return np.inf


def small_on_large(text: str, long: bool) -> dict[str, float]:
    """A speck against a rock."""
    with Trial(text) as t:
        before = t.velocity("speck")[0]
        momentum = t.system.mass @ t.v
        t.run_for(600 if long else 60, 100)
        a, b = (t.system.names.index(n) for n in ("rock", "speck"))
        ratio = t.system.mass_of[a] / t.system.mass_of[b]
        return {
            "energy drift": t.drift,
            "speed lost": 1.0 + t.velocity("speck")[0] / before,
            "momentum": np.abs(t.system.mass @ t.v - momentum).max() / abs(momentum[0]),
            "masses / 10^4, too small by": 1.0 - ratio / 1e4,
        }


MASSES = Case(
    "mass ratio 1:10^4",
    block("rock", (6, 6, 6), (0, 0, 0), 1.0, 371.0)
    + block("speck", (2, 2, 2), (5.7, 0, 0), 1.0, 1.0, velocity(-0.2 * C))
    + CONTROL,
    small_on_large,
    {"energy drift": 1e-3, "speed lost": 0.2, "momentum": 1e-11, "masses / 10^4, too small by": 0.0},
    f"{HALF}; the speck comes back almost as fast as it came, and pairwise forces keep momentum to rounding",
)

# --- at rest ------------------------------------------------------------------------------------------------------


def rest(text: str, long: bool, seconds: float) -> dict[str, float]:
    """Let the topmost object come to rest; where it is is measured by the caller."""
    with Trial(text) as t:
        t.run_for(10 * seconds if long else seconds)
        return {
            "speed left": np.abs(t.v).max(),
            "cells turned over": t.inverted(),
            "bottom of b": t.x[t.face("b", 2, -1), 2].mean(),
        }


def heavy_on_slab(stress: float, bottom: float) -> Case:
    """4^3 cells 1000 times as dense on a light slab, pressing on it with ``stress`` E."""

    def play(text, long):
        found = rest(text, long, 6000.0)
        return {
            "speed left": found["speed left"],
            "cells turned over": found["cells turned over"],
            "height of its bottom, off by / h": abs(found["bottom of b"] - bottom),
        }

    g = stress / 4000.0
    text = (
        f"gravity (0, 0, {-g!r})\n"
        + block("slab", (8, 8, 4), (0, 0, 2), more="hold face -z drag 12.8")
        + block("b", (4, 4, 4), (0.5, 0.5, 6.5), 1.0, 1000.0, f"drag {0.016 * 64000.0!r}")
        + CONTROL
    )
    return Case(
        f"1000 times as dense, at rest, {stress:g} E",
        text,
        play,
        {"speed left": 1e-4, "cells turned over": 0, "height of its bottom, off by / h": 0.06},
        "the remaining motion is a slow slide into the hollows of the lattice below; the height is that of an independent model "
        "in NumPy with edges as stiff as faces",
    )


def tower(gap=0.3, offset=0.02, cells=4, load=0.01, drag=0.05) -> str:
    """Three cubes on the ground, one on the other; air drag lambda/m, load rho g H / E of the whole tower at its foot."""
    side = [(0.0, 0.0), (1.0, 0.3), (0.4, 1.0)]
    cubes = [
        block(
            f"c{k}",
            (cells,) * 3,
            (offset * side[k][0], offset * side[k][1], cells * (k + 0.5) + gap * k),
            more=f"drag {drag * cells**3!r}",
        )
        for k in range(3)
    ]
    return f"gravity (0, 0, {-load / (3 * cells)!r})\nground z 0\n" + "".join(cubes) + CONTROL


def stand(text: str, long: bool) -> dict[str, float]:
    """30 000 steps to settle, then 10 000 more, or 10^6."""
    with Trial(text) as t:
        names = t.system.names
        height = t.centre("c2")[2]
        at_first = t.ledger.rows[0]["gravity"]
        t.run(30_000)
        settled = np.array([t.centre(n) for n in names])
        t.run(1_000_000 if long else 10_000)
        gaps = [t.gap(t.face(a, 2, 1), t.face(b, 2, -1), 2) for a, b in itertools.pairwise(names)]
        return {
            "creep after 30 000 steps / h": np.abs([t.centre(n) - s for n, s in zip(names, settled)]).max(),
            "kinetic over initial potential energy": abs(t.ledger.rows[-1]["kinetic"]) / at_first,
            "overlap of the surfaces / h": -min(gaps),
            "sunk / height": abs(1.0 - t.centre("c2")[2] / height),
        }


STANDS = {
    "creep after 30 000 steps / h": 1e-3,
    "kinetic over initial potential energy": 1e-12,
    "overlap of the surfaces / h": 0.0,
    "sunk / height": 0.1,
}
TOWERS = [
    Case(
        "tower of 3 at rest",
        tower(),
        stand,
        STANDS,
        "a tower must not creep. It needs air drag: lambda/m = 0.05 of sqrt(E/rho)/h here, 0.01 is the least",
    ),
    Case("tower of 3, weak drag", tower(load=0.002, drag=0.01), stand, STANDS, "the least drag at which it stands"),
    Case(
        "tower of 3, a quarter of a cell askew",
        tower(offset=0.25, cells=6),
        stand,
        STANDS,
        "only the corrugation of the barrier holds it; an offset of 0.25 h needs cubes of 6 cells",
    ),
]


def apart(text: str, long: bool) -> dict[str, float]:
    """Two cubes side by side, left alone."""
    with Trial(text) as t:
        t.run_for(600 if long else 60, 100)
        return {
            "energy drift": t.drift,
            "parting speed / c": t.velocity("b")[0] / C,
            "cells turned over": t.inverted(),
            "sideways / h": np.abs(t.centre("b")[1:]).max(),
            "still within reach / h": 0.6 - t.gap(t.face("a", 0, 1), t.face("b", 0, -1), 0),
        }


TOUCH = [
    Case(
        f"touching at t = 0{where}",
        block("a", (4, 4, 4), (0, 0, 0)) + block("b", (4, 4, 4), (4 + gap, 0, 0)) + CONTROL,
        apart,
        {
            "energy drift": 5e-3,
            "parting speed / c": speed,
            "cells turned over": 0,
            "sideways / h": 1e-9,
            "still within reach / h": 1e-9,
        },
        why,
    )
    for where, gap, speed, why in (
        (
            "",
            0.0,
            0.1,
            "surfaces that touch are 0.6 h inside the reach of the barrier, which drives them apart, softly. All energy "
            "starts in the stiffest pairs, so the drift is larger than after an impact",
        ),
        (", at the reach of the barrier", 0.6, 1e-12, "nothing acts, nothing moves"),
    )
]

# --- thin and pointed ---------------------------------------------------------------------------------------------


def dropped(on: str):
    """A player for b, which falls on ``on`` along -z and must not get below it where they meet."""

    def play(text, long):
        with Trial(text) as t:
            start, height = abs(t.velocity("b")[2]), []
            near = np.linalg.norm(t.system.position[:, :2], axis=1) < 1.5
            upper, lower = (np.flatnonzero(near & (t.system.object == t.system.names.index(n))) for n in ("b", on))
            t.run_for(
                (10 if long else 1) * (6.0 / start + 40.0), 400 if long else 200, lambda: height.append(t.gap(lower, upper, 2))
            )
            return {"energy drift": t.drift, "passed": min(height) < 0.0}

    return play


def struck(kind: str, size, height: float, speeds, why: str) -> list[Case]:
    """A small block comes down on something one cell thick that is clamped at its ends."""
    return [
        Case(
            f"{kind} of one cell, block at {speed:g} c",
            block(kind, size, (0, 0, 0), more="hold faces x")
            + block("b", (3, 3, 3), (0, 0, height), more=velocity(z=-speed * C))
            + CONTROL,
            dropped(kind),
            {"energy drift": 1e-3 if speed <= 0.4 else 1e-2, "passed": 0},
            why,
        )
        for speed in speeds
    ]


PLATES = struck(
    "plate", (12, 6, 1), 3.7, (0.1, 0.4, 0.8),
    "a plate with nothing inside is its own barrier, with a reach of 1.2 h",
)  # fmt: skip
PLATE_PASSES_AT = {1: 0.5, 2: 0.65, 3: 0.8}
"""Cells of a clamped plate, and the speed over C from which a block of 5 cells goes through it (bench/stability.py)."""


def onto_plate(speed: float, cells: int, offset) -> str:
    """A block of 5^3 cells comes down on a clamped plate."""
    return (
        block("plate", (12, 6, cells), (0, 0, 0), more="hold faces x")
        + block("b", (5, 5, 5), (*offset, cells / 2 + 3.2), more=velocity(z=-speed * C))
        + CONTROL
    )


PLATES += [
    Case(
        f"0.9 of the tunnelling speed, plate of {cells} cell{'s'[: cells > 1]}",
        onto_plate(0.9 * fast, cells, WORST),
        dropped("plate"),
        {"energy drift": 1e-2, "passed": 0},
        "a plate bends but cannot move away as a whole, so objects pass it more easily than a cube",
    )
    for cells, fast in PLATE_PASSES_AT.items()
]
NEEDLES = struck("needle", (20, 1, 1), 3, (0.1, 0.75), "it is thin in two directions: every particle is on an edge")


def crossed(speed: float) -> str:
    """Two free needles, one across the other, closing in."""
    return block("a", (20, 1, 1), (0, 0, 0)) + block("b", (1, 20, 1), (0.3, 0, 2), more=velocity(z=-speed * C)) + CONTROL


CROSSED = Case(
    "needle across needle at 0.2 c",
    crossed(0.2),
    dropped("a"),
    {"energy drift": 1e-3, "passed": 0},
    "two edges that meet in a point have few pairs to hold them",
)


def corners(speed: float) -> str:
    """Two cubes on one line through their corners, the upper one coming down."""
    turned = "orientation axis (1, -1, 0) angle acos rad ".replace("acos", repr(float(np.arccos(3**-0.5))))
    return (
        block("a", (4, 4, 4), (0, 0, 0), more=turned)
        + block("b", (4, 4, 4), (0, 0, 4 * 3**0.5 + 0.5), more=turned + velocity(z=-speed * C))
        + CONTROL
    )


def corner_on_corner(text: str, long: bool) -> dict[str, float]:
    """One cube stops, the other goes on."""
    with Trial(text) as t:
        start = t.velocity("b")[2]
        t.run_for((10 if long else 1) * (4.0 / abs(start) + 20.0), 200)
        return {"energy drift": t.drift, "cells turned over": t.inverted(), "not handed over": 1.0 - t.velocity("a")[2] / start}


CORNERS = [
    Case(
        f"corner on corner at {speed:g} c",
        corners(speed),
        corner_on_corner,
        {"energy drift": 1e-4, "cells turned over": 0, "not handed over": 0.05},
        "equal cubes on one line exchange their speeds; braces bring the corners back (docs/physics-solids.md, Braces)",
    )
    for speed in (0.05, 0.2)
]

CASES = [
    *CONTRASTS,
    MASSES,
    *IMPACTS,
    *TUNNELS,
    *(heavy_on_slab(*s) for s in ((0.02, 4.33), (0.1, 4.11), (0.2, 3.85))),
    *TOWERS,
    *TOUCH,
    *PLATES,
    *NEEDLES,
    CROSSED,
    *CORNERS,
]
