# SPDX-License-Identifier: GPL-2.0-only
"""How long liquid takes to become level: ``python bench/levelling.py``.

sweeps    of the paper's rules alone, until a slope across W columns is down to 1/e of its height
dam       `model surface` in LAMMPS: a dam over a quarter of the basin breaks; time until the surface is within a cell, and until
          all is level to the unit, over the time W / sqrt(g depth) that a shallow-water wave takes to cross the basin
vessels   the same for two vessels, 12 and 4 cells full, joined at the bottom; and what is left of the difference
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

SCENE = """
gravity (0, 0, -9.81)
liquid water {{
  basin from (0, 0, 0) to ({width}, 8, {top})
  density 1000
  {fill}
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


def follow(scene: str, width: int, depth: float, apart) -> str:
    """Run until the liquid sleeps; times at which `apart` of the raw heights is below a cell, and of the sleep."""
    from mdanim_lammps.driver.prepare import prepare
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.scene.parse import parse_scene

    ready = prepare(parse_scene(scene))
    crossing = width / (9.81 * depth) ** 0.5
    near = None
    with Instance(ready.plan) as instance:
        instance.setup()
        while instance.fix_value("liquid", AWAKE):
            instance.run(4)
            if near is None and apart(instance.liquid_heights()[1]) < 1.0:
                near = instance.step
        left = apart(instance.liquid_heights()[1])
    near, level = (step * ready.certificate.timestep / crossing for step in (near, instance.step))
    return f"within a cell after {near:5.2f}, level after {level:5.2f}; {left:.3g} cells left"


def main() -> None:
    """Measure and print."""
    for width in (16, 32, 64, 128):
        print(f"sweeps   W = {width:<4} e-fold {sweeps(width):.4f} W^2 sweeps", flush=True)
    post = WALL.format(high=1, middle=-5, z=0.5)
    for width in (16, 32, 64, 128):
        full = width // 4
        fill = f"fill from (0, 0, 0) to ({full}, 8, {full})\n  level {full}"
        scene = SCENE.format(width=width, top=full + 8, fill=fill, wall=post)
        print(f"dam      W = {width:<4} {follow(scene, width, full / 4, np.ptp)}", flush=True)
    for width in (18, 34, 66):
        side = width // 2 - 1
        fill = f"fill from (0, 0, 0) to ({side}, 8, 16)\n  volume {(12 * side + 4 * side) * 8}"
        wall = WALL.format(high=18, middle=width / 2, z=11)
        apart = lambda raw: abs(raw[:, :side].mean() - raw[:, -side:].mean())
        scene = SCENE.format(width=width, top=20, fill=fill, wall=wall)
        print(f"vessels  W = {width:<4} {follow(scene, width, 8, apart)}", flush=True)


if __name__ == "__main__":
    main()
