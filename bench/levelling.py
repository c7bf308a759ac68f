# SPDX-License-Identifier: GPL-2.0-only
"""How long liquid takes to become level: ``python bench/levelling.py``.

sweeps    of the paper's rules alone, until a slope across W columns is down to 1/e of its height
dam       `model surface` in LAMMPS: a dam over a quarter of the basin breaks; time until all is level to the unit, over the time
          that a shallow-water wave takes to cross the basin at the depth of the end
vessels   the same for two vessels, one H = 16 cells full, one empty, joined by a gap of two cells at the bottom
"""

import sys
from pathlib import Path

import numpy as np
from mdanim_lammps.features.liquid import frames as liquid

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "lab"))

SCENE = """
gravity (0, 0, -9.81)
liquid water {{
  basin from (0, 0, 0) to ({width}, 8, {top})
  density 1000
  {fill}
  model surface
  drag 0
}}
{wall}
control {{
  time 1000 s
  resolution 1
}}
"""
WALL = """object wall {{
  shape box (2, 8, {high})
  position ({middle}, 4, {z})
  density 1000
  elasticity 1 MPa
  hold all
}}"""
AWAKE = 5  # entry of the fix's vector
G, HIGH = 9.81, 16


def sweeps(width: int) -> float:
    """E-fold of a slope in sweeps, over W^2; 1/pi^2 for a diffusion of 1 cell^2 per sweep."""
    import automaton_lab as lab

    mode = np.cos(np.pi * (np.arange(width) + 0.5) / width)
    columns = np.arange(16)[:, None] < np.round(8.0 + 6.0 * mode)
    cells = np.repeat(columns[:, None], 64, axis=1).astype(np.uint8)
    a = lab.Automaton(cells.shape)
    a.content = cells
    count = width**2 // 10
    a.sweep(count)
    return -count / np.log((a.content.sum((0, 1)) @ mode) / (cells.sum((0, 1)) @ mode)) / width**2


def seconds(scene: str) -> float:
    """Time until the liquid sleeps: level, nothing near."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    ready = prepare(parse_scene(scene))
    with Instance(ready.plan) as instance:
        instance.setup()
        while instance.fix_value("liquid", AWAKE):
            instance.run(4)
        raw = liquid.heights(instance)[1]
        assert np.nanmax(raw) == np.nanmin(raw)
        return instance.step * ready.certificate.timestep


def main() -> None:
    """Measure and print."""
    for width in (16, 32, 64, 128):
        print(f"sweeps   W = {width:<4} {sweeps(width):.4f} W^2", flush=True)
    post = WALL.format(high=1, middle=-5, z=0.5)
    for width in (16, 32, 64, 128):
        full = width // 4
        fill = f"fill from (0, 0, 0) to ({full}, 8, {full})\n  level {full}"
        time = seconds(SCENE.format(width=width, top=full + 8, fill=fill, wall=post))
        print(f"dam      W = {width:<4} {time * (G * full / 4) ** 0.5 / width:.2f} W/sqrt(g depth)", flush=True)
    for width in (18, 34, 66):
        side = width // 2 - 1
        fill = f"fill from (0, 0, 0) to ({side}, 8, {HIGH})\n  level {HIGH}"
        wall = WALL.format(high=18, middle=width / 2, z=11)
        time = seconds(SCENE.format(width=width, top=20, fill=fill, wall=wall))
        print(f"vessels  W = {width:<4} {time * (G / HIGH) ** 0.5:.2f} sqrt(H/g)", flush=True)


if __name__ == "__main__":
    main()
