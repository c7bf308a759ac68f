# SPDX-License-Identifier: GPL-2.0-only
"""Scenes that several benches measure, by a name and a size, and the state from which steps are measured.

``cube N``       a block of N particles along an edge that falls freely
``pool N``       the same block as it falls into waves of 7 N columns along a side
``automaton N``  such a block as it plunges into a deep basin of `model surface`; with 46 there are 2·10^6 cells
``float N``      scenes/float.txt with about N particles, and cells as small: the cuboid is in the liquid
``heap N``       about N objects of scenes/pile.txt, poured into its bin; nine of ten have landed
``boxes N``      about N rigid boxes, poured into a bin; nine of ten have landed
``hail N``       N blocks of 1000 particles that fall and collide, N a square
``FILE``         a file of scenes/, from its own beginning on
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from pathlib import Path

SCENES = Path(__file__).resolve().parents[1] / "scenes"
GRAVITY = "gravity (0, 0, -9.81) m/s^2\n"
CUBE = """gravity (0, 0, -9.81)
object a {{ shape box ({0}, {0}, {0}) cm position (0, 0, 0) density 1000 elasticity 1 MPa drag 1e-3 }}
control {{ time 1 s  resolution 1 cm }}
"""
POOL = """gravity (0, 0, -9.81)
object a {{ shape box ({0}, {0}, {0}) cm position (0, 0, {0}) cm density 500 elasticity 1 MPa velocity (0, 0, -1) }}
liquid w {{ basin from (-{1}, -{1}, 0) cm to ({1}, {1}, {2}) cm density 1000 level {3} cm model waves }}
control {{ time 1 s  resolution 1 cm }}
"""
BASIN = """
gravity (0, 0, -9.81)
liquid water {{
  basin from ({a}, {a}, 0) to ({b}, {b}, {top})
  density 1000
  level {level}
  model {model}
  {more}
}}
object cube {{
  shape box ({edge}, {edge}, {edge})
  position (0, 0, {z})
  orientation axis (1, 2, 3) angle {angle} deg
  density {density}
  elasticity {young} Pa
  velocity (0, 0, {v})
  {damping}
}}
control {{
  time 100 s
  resolution 1
}}
"""
BLOCK = """
  object block[{n}] {{
    shape      box ({edge}, {edge}, {edge}) cm
    position   {place} m
    density    900
    elasticity 300 kPa
    {more}
  }}
"""
END = """
control {
  time       4 s
  frames     50 fps
  resolution 1 cm
}
"""
BOXES = """
gravity (0, 0, -9.81)
ground z 0
walls from (-{wall}, -{wall}, -1) m to ({wall}, {wall}, 100) m
repeat k in 0 .. {layers} - 1 {{ repeat j in 0 .. {side} - 1 {{ repeat i in 0 .. {side} - 1 {{
  object box[(k*{side} + j)*{side} + i] {{
    shape       box (10, 10, 10) cm
    elasticity  rigid
    density     600
    position    (20*(i - {middle}) + rand(0, 2), 20*(j - {middle}) + rand(0, 2), 12 + 18*k) cm
    orientation euler (rand(0, 90), rand(0, 90), rand(0, 90)) deg
    velocity    (0, 0, -{speed}) m/s
  }}
}} }} }}
control {{ time 4 s  friction 0.5 }}
"""
KINDS = 16
"""Objects of a layer of scenes/pile.txt."""
POUR = 3.0
"""Speed with which a heap is poured [m/s]."""
LANDED = 1.0
"""An object of a heap has landed when it is slower than this [m/s]."""


def rows(side: int, place: str, edge: float, more: str = "") -> str:
    """A field of side^2 blocks."""
    block = BLOCK.format(n=f"i*{side} + j", place=place, edge=edge, more=more)
    return f"repeat i in 0 .. {side - 1} {{ repeat j in 0 .. {side - 1} {{{block}}} }}"


def hail(side: int) -> str:
    """Text of a hail of side^2 blocks by 1000 particles."""
    speed = "velocity (rand(-1.5, 1.5), rand(-1.5, 1.5), 0) m/s"
    return GRAVITY + "ground z 0 m\n" + rows(side, "(i*0.3, j*0.3, 0.3 + 0.1*((i + 2*j) mod 5))", 9, speed) + END


def boxes(number: int) -> str:
    """Text of so many rigid boxes, about, in a bin as wide as their heap is high."""
    side = max(2, round((number / 2.5) ** (1 / 3)))
    sizes = {"side": side, "layers": round(number / side**2), "middle": (side - 1) / 2, "wall": 0.1 * side + 0.1}
    return BOXES.format(speed=POUR, **sizes)


def in_basin(
    edge: int, basin: int, top: float, level: float, z: float, model: str, v=0.0, angle=20, density=500, more="", damping=""
) -> str:
    """Text of a cube in or above a basin, cells and spacing of 1 m.

    It is stiff, so that the time step is small against what the liquid has to follow: the usual case.
    """
    young = 1000.0 * 9.81 * edge * 50
    where = dict(edge=edge, a=-basin / 2, b=basin / 2, top=top, level=level, z=z)
    return BASIN.format(**where, model=model, v=v, angle=angle, density=density, more=more, damping=damping, young=young)


def plunging(edge: int, basin: int, top: float, level: float, model: str) -> str:
    """Text of a cube that plunges into a basin."""
    return in_basin(edge, basin, top, level, level + 0.3 * edge, model, v=-((2 * 9.81 * edge) ** 0.5))


def scene_of(name: str):
    """The scene of a name."""
    from mdanim_lammps.scene.parse import load_scene, parse_scene

    kind, _, size = name.partition(" ")
    if kind == "heap":
        scene = load_scene(SCENES / "pile.txt", overrides={"layers": max(1, round(float(size) / KINDS))})
        return replace(scene, solids=tuple(replace(s, velocity=(0.0, 0.0, -POUR)) for s in scene.solids), expects=())
    if kind == "float" and size:
        scene = load_scene(SCENES / "float.txt")
        spacing = (0.4 * 0.4 * 0.2 / float(size)) ** (1 / 3)
        return replace(scene, control=replace(scene.control, resolution=spacing), expects=())
    if not size:
        return load_scene(SCENES / f"{name}.txt")
    n = round(float(size))
    texts = {
        "cube": lambda: CUBE.format(n - 1),
        "pool": lambda: POOL.format(n - 1, 7 * (n - 1) // 2, 2 * (n - 1), (n - 1) // 2),
        "automaton": lambda: plunging(n, side := round(128 * n / 46), side, side / 2, "surface"),
        "boxes": lambda: boxes(n),
        "hail": lambda: hail(round(n**0.5)),
    }
    return parse_scene(texts[kind]())


def warm(name: str, ready):
    """Step and state from which a scene is measured, run up to there by all cores; None where that is its beginning."""
    kind, _, size = name.partition(" ")
    if kind not in ("heap", "boxes", "float") or not size:
        return None
    import numpy as np
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.engine.threads import with_threads
    from mdanim_lammps.processes import cores

    start, dt = time.perf_counter(), ready.certificate.timestep
    with with_threads(cores()), Instance(ready.plan) as instance:
        instance.setup()
        while True:
            instance.run(max(1, round(0.02 / dt)))
            now = instance.step * dt
            fast = np.linalg.norm(ready.system.center_of_mass(instance.array("v")), axis=1)
            landed = float((fast < LANDED).mean())
            # The cuboid of float.txt touches the liquid after 0.2 s.
            if (kind != "float" and now > 0.1 and (landed >= 0.9 or now > 1.2)) or (kind == "float" and now >= 0.3):
                break
        told = f", {100 * landed:.0f} % have landed" if kind != "float" else ""
        print(f"{name}: begun at {now:.2f} s, after {time.perf_counter() - start:.0f} s{told}", file=sys.stderr, flush=True)
        return instance.step, instance.state()
