# SPDX-License-Identifier: GPL-2.0-only
"""Hard cases of single solids: spin, squashing, slenderness, drag, gravity, the time step, rotations, meshes."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from case import CONTROL, C, Case, block, refused
from mdanim_lammps.errors import RefusedError
from mdanim_lammps.scene.rotation import rotation_about
from trial import Trial

sys.path.insert(0, str(Path(__file__).parents[1] / "lab"))
from twin.lattice import CORNER

# --- large motion -------------------------------------------------------------------------------------------------


def turn(text: str, long: bool) -> dict[str, float]:
    """Twenty turns, or two hundred."""
    with Trial(text) as t:
        s, rate = t.system, t.ready.scene.solids[0].spin[2]

        stretch = []

        def momentum():
            return (s.mass[:, None] * np.cross(t.x - t.centre("a"), t.v)).sum(0)

        start = momentum()
        t.run_for((200 if long else 20) * 2.0 * np.pi / rate, 50, lambda: stretch.append(t.strain()))
        return {
            "energy drift": t.drift,
            "angular momentum": np.linalg.norm(momentum() - start) / np.linalg.norm(start),
            "cells turned over": t.inverted(),
            "stretch": max(stretch),
        }


SPINS = [
    Case(
        f"spin, rim at {rate * 2 * 2**0.5:.2f} c",
        block("a", (4, 4, 4), (0, 0, 0), more=f"spin (0, 0, {rate * C!r})") + CONTROL,
        turn,
        {"energy drift": 3e-3, "angular momentum": 1e-12, "cells turned over": 0, "stretch": 0.4},
        "springs pull along the line of centres, so angular momentum holds to rounding, and the energy of the stretch to 0.3 %",
    )
    for rate in (0.02, 0.1, 0.276)
]


def squash(share: float):
    """A player that squeezes cube a to a share of its height, a little uneven, and lets go."""

    def play(text, long):
        with Trial(text) as t:
            x = t.system.position * (1.0, 1.0, share)
            t.put(x + np.random.default_rng(1).normal(0.0, 0.02, x.shape))
            t.run(100_000 if long else 5_000)
            e = t.ledger.rows
            return {
                "strain left": t.strain(),
                "elastic energy left": e[-1]["elastic"] / e[0]["elastic"],
                "cells turned over": t.inverted(),
            }

    return play


DRAGGED = block("a", (5, 5, 5), (0, 0, 0), more=f"drag {0.5 * 125!r}") + CONTROL
BACK = {"strain left": 1e-9, "elastic energy left": 1e-20, "cells turned over": 0}
SQUASHED = [
    Case(
        f"squeezed to {share:g}",
        DRAGGED,
        squash(share),
        BACK,
        "the shape comes back, with no cell inverted, down to 0.2 of the height",
    )
    for share in (0.6, 0.4, 0.2)
]
TANGLED = Case(
    "squeezed to 0.1",
    DRAGGED,
    squash(0.1),
    {"strain left": 1.0, "elastic energy left": 1.0, "cells turned over": 125},
    "below 0.2 it stays tangled, because springs do not distinguish a cell from its mirror image; it gains no energy",
)

# --- slender ------------------------------------------------------------------------------------------------------


def swing(text: str, long: bool) -> dict[str, float]:
    """A beam falls round its clamped end."""
    with Trial(text) as t:
        tip, low = t.face("a", 0, 1), []
        t.run(200_000 if long else 18_000, 40, lambda: low.append(t.x[tip, 2].mean()))
        length = np.ptp(t.system.position[:, 0])
        return {
            "energy drift": t.drift,
            "cells turned over": t.inverted(),
            "stretch": t.strain(),
            "tip fell, short of 0.8 length by": 0.8 + min(low) / length,
        }


BEAMS = [
    Case(
        f"beam 100:1, {n} cell{'s'[: n > 1]} thick",
        f"gravity (0, 0, {-g!r})\n" + block("a", (100 * n, n, n), (0, 0, 0), more="hold face -x") + CONTROL,
        swing,
        {"energy drift": 1e-3, "cells turned over": 0, "stretch": 0.2, "tip fell, short of 0.8 length by": 0.0},
        "it folds down around its clamp, by up to its length, and stretches no more than this bending requires; "
        "200 000 steps keep the energy to 1e-3",
    )
    for n, g in ((1, 1e-5), (2, 1e-5))
]

# --- drag ---------------------------------------------------------------------------------------------------------

STEP = 0.35
FALL = 1e-4


def dragged(phi: float) -> str:
    """A cube falls in air so thick that lambda dt / 2m is phi."""
    return (
        f"gravity (0, 0, {-FALL!r})\n"
        + block("a", (3, 3, 3), (0, 0, 0), more=f"drag {2.0 * phi / STEP * 27!r} spin (0.05, 0, 0.05)")
        + CONTROL.replace("resolution", f"timestep {STEP!r} resolution")
    )


def settle_to_terminal_speed(phi: float):
    """A player: from rest towards m g / lambda, eq. (3.9)."""

    def play(text, long):
        with Trial(text) as t:
            rate = 2.0 * phi / STEP
            exact = lambda: -FALL / rate * -np.expm1(-rate * t.instance.step * t.timestep)
            off, over = [], []

            def look():
                off.append(abs(t.velocity("a")[2] / exact() - 1.0))
                over.append(t.velocity("a")[2] / (-FALL / rate) - 1.0)

            t.run(20, 20, look)
            t.run(100_000 if long else 4_000, 20, look)
            e = t.ledger.rows[-1]
            return {
                "speed, worst": max(off),
                "speed, at the end": off[-1],
                "beyond the terminal speed": max(over),
                "energy drift at the end": abs(e["residual"]),
            }

    return play


DRAGS = [
    Case(
        f"drag phi = {phi:g}",
        dragged(phi),
        settle_to_terminal_speed(phi),
        {
            "speed, worst": max(4e-3, 0.3 * phi**2) if phi <= 0.5 else 1e-9,
            "speed, at the end": 1e-6,
            "beyond the terminal speed": 1e-12,
            "energy drift at the end": 1e-2,
        },
        "the speed never exceeds the terminal speed. The implicit form, eq. (3.12), is off by about phi^2/4 in the first step; "
        "above phi = 0.5 the exponential one is exact",
    )
    for phi in (1e-6, 1e-3, 0.1, 0.5, 1.0, 1e2, 1e6)
]

# --- gravity ------------------------------------------------------------------------------------------------------


def on_the_ground(load: float) -> str:
    """A cube laid on the ground; its weight presses its foot with ``load`` E."""
    return (
        f"gravity (0, 0, {-load / 4!r})\nground z 0\n" + block("a", (4, 4, 4), (0, 0, 2.01), more=f"drag {0.05 * 64!r}") + CONTROL
    )


def lie(text: str, long: bool) -> dict[str, float]:
    """Let it come to rest."""
    with Trial(text) as t:
        t.run(100_000 if long else 8_000)
        return {"speed left": np.abs(t.v).max(), "below the ground / h": -t.x[:, 2].min(), "cells turned over": t.inverted()}


WEIGHTS = [
    Case(
        f"weight of {load:g} E on its foot",
        on_the_ground(load),
        lie,
        {"speed left": 1e-9, "below the ground / h": deepest, "cells turned over": crushed},
        why,
    )
    for load, deepest, crushed, why in (
        (0.0, 0.0, 0, "no gravity, nothing moves"),
        (0.05, 0.06, 0, "ground gives way by load times h"),
        (0.2, 0.25, 0, "the largest load that a lattice bears (docs/physics-solids.md)"),
        (0.5, 0.6, 64, "beyond 0.2 E it is crushed, and `check` warns. It still comes to rest"),
    )
]


def fall(text: str, long: bool) -> dict[str, float]:
    """Free fall against g t^2 / 2."""
    with Trial(text) as t:
        t.run(10_000 if long else 2_000)
        time, g = t.instance.step * t.timestep, -t.ready.scene.gravity[2]
        return {"height fallen": abs(t.centre("a")[2] / (-g * time**2 / 2.0) - 1.0), "energy drift": t.drift}


FALLS = [
    Case(
        f"free fall, g = {g:g} E/(rho h)",
        f"gravity (0, 0, {-g!r})\n" + block("a", (4, 4, 4), (0, 0, 0)) + CONTROL,
        fall,
        {"height fallen": 1e-10, "energy drift": 1e-10},
        "leap-frog is exact for a constant force; rounding remains, of coordinates up to 10^13 h in the long form",
    )
    for g in (1.0, 1e6)
]

# --- the time step ------------------------------------------------------------------------------------------------


def at_bound(times: float) -> str:
    """A cube in a slow spin, at a time step of so many bounds of a lone cube, which its corners set."""
    step = times * 2.0 / CORNER**0.5
    return (
        block("a", (4, 4, 4), (0, 0, 0), more="spin (0.02, 0, 0.05)")
        + f"control {{ time {20_000 * step!r} frames {1.0 / step!r} fps timestep {step!r} resolution 1 }}\n"
    )


def vibrate(text: str, long: bool) -> dict[str, float]:
    """Run at the step that the scene asks for."""
    with Trial(text) as t:
        t.run(1_000_000 if long else 20_000)
        return {"energy drift": t.drift, "step below the bound": 1.0 - t.ready.certificate.fraction}


STEPS = [
    Case(
        "time step at the bound",
        at_bound(1.0 - 1e-12),
        vibrate,
        {"energy drift": 1e-3, "step below the bound": 1e-9},
        "the bound is rigorous for springs: small motion is stable there",
    ),
    Case(
        "time step 1 % above the bound",
        at_bound(1.01),
        lambda text, long: refused(text, RefusedError, "above the certified bound"),
        {"not refused": 0},
        "refused before step 0",
    ),
]

# --- rotations and meshes -----------------------------------------------------------------------------------------


def meeting(rotation: np.ndarray, orientation: str) -> str:
    """Two cubes under gravity meet askew; all of it rotated."""

    def v(*a):
        return "(" + ", ".join(repr(float(c)) for c in rotation @ np.array(a)) + ")"

    def cube(name, at, speed):
        return f"object {name} {{ shape box (4, 4, 4) position {at} density 1 elasticity 1 Pa {orientation} velocity {speed} }}\n"

    return (
        f"gravity {v(0, 0, -0.002)}\n"
        + cube("a", v(0, 0, 0), v(0.1 * C, 0, 0))
        + cube("b", v(5.7, 0.3, 0.1), v(-0.1 * C, 0, 0))
        + CONTROL
    )


def rotate(text: str, long: bool) -> dict[str, float]:
    """The same scene turned every way gives the same motion, turned."""
    random, off = np.random.default_rng(3), []
    with Trial(text) as t:
        t.run_for(200.0)
        straight = t.x.copy()
    for _ in range(50 if long else 5):
        axis = random.normal(size=3)
        axis, angle = tuple((axis / np.linalg.norm(axis)).tolist()), random.uniform(0.0, 2.0 * np.pi)
        rotation = np.array(rotation_about(axis, angle))
        turned = meeting(rotation, f"orientation axis {axis!r} angle {angle!r} rad")
        with Trial(turned.replace(CONTROL, text[text.index("control") :])) as t:
            t.run_for(200.0)
            off.append(np.abs(t.x @ rotation - straight).max())
    return {"positions / h": max(off)}


ROTATED = Case(
    "rotated by any angle",
    meeting(np.eye(3), ""),
    rotate,
    {"positions / h": 1e-9},
    "no law depends on direction; an impact magnifies the rounding of rotated numbers by a few powers of ten",
)


def like_a_box(text: str, long: bool) -> dict[str, float]:
    """A cube from a mesh with slivers beside one from ``shape box``."""
    with Trial(text) as t, Trial(text.replace('mesh "sliver.obj"', "box (4, 4, 4)")) as box:
        for each in (t, box):
            each.run(100_000 if long else 2_000)
        return {
            "particles": abs(t.system.particles - box.system.particles),
            "time step": abs(t.timestep / box.timestep - 1.0),
            "positions / h": np.abs(t.x - box.x).max(),
            "energy drift": t.drift,
        }


SLIVER = Case(
    "mesh with slivers",
    'object a { shape mesh "sliver.obj" position (0, 0, 0) density 1 elasticity 1 Pa spin (0, 0, 0.05) }\n' + CONTROL,
    like_a_box,
    {"particles": 0, "time step": 1e-9, "positions / h": 1e-9, "energy drift": 1e-3},
    "a body is cut into cells, so triangles 1e-7 and 1e-12 high change nothing, least of all the time step",
)

CASES = [*SPINS, *SQUASHED, TANGLED, *BEAMS, *DRAGS, *WEIGHTS, *FALLS, *STEPS, ROTATED, SLIVER]
