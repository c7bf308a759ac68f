# SPDX-License-Identifier: GPL-2.0-only
"""How deep elastic cubes float, and how fast they sink: ``python bench/drafts.py [WORD ...]``.

drafts   share of a cube of 6^3 cells below the surface, after five ways to get there, against its density over the liquid's;
         beside it how far the nearest axis of the cube leans from the vertical (45 = on an edge, 54.7 = on a corner)
cells    the same for one tilted drop and cubes of 3 to 10 cells a side
models   the same for a cube of 6^3 cells set upright onto the surface, by `liquid { model … }`; ten times stiffer
waves    the first table for ``model waves``, with a calm time of 10 sqrt(L/g)
speed    terminal speed under the liquid's drag over (rho_s - rho_l) g / (gamma rho_l)
bobbing  first fall and period of a cube that bobs in ``model waves``, over those of its mass alone; in potential flow
light    how fast the middle of light floating cubes still goes up and down after 13 s, in m and s
drift    what a floating cube moves sideways in 20 s, and the sweeps of the automaton in that time

Without words all of them. Units as in scenes/lab/cube.txt: spacing 1, liquid of density 1000; elasticity 1000 Pa is a wave speed
of about 1.
"""

import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from mdanim_lammps.features.liquid import frames as liquid

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lab"))
import heave
import waves_forms
from timing import markdown

CUBE = Path(__file__).parent.parent / "scenes" / "lab" / "cube.txt"
DENSITIES = (300, 500, 700, 900)
WAYS = {
    "dropped upright": dict(),
    "dropped tilted": dict(roll=20, pitch=35, yaw=10),
    "dropped at 0.8 of the wave speed": dict(fast=0.8, level=20, top=34, z=26),
    "released at the bottom": dict(z=3.2),
    "20 times softer": dict(young=50, g=0.002),
}
SWEEPS = 4  # entry of the fix's vector


class Pool:
    """A cube over a pool, in LAMMPS; a context manager."""

    def __init__(self, fast=0.0, drag=None, model="surface", calm=None, **lets):
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.features.liquid.record import LiquidModel
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import load_scene

        if fast:  # in wave speeds c
            lets["v"] = -fast * (1.2 * 1000 / lets["density"]) ** 0.5
        scene = load_scene(CUBE, overrides=lets)
        self.ready = prepare(replace(scene, liquid=replace(scene.liquid, drag=drag, model=LiquidModel(model), calm=calm)))
        self.instance = Instance(self.ready.plan)
        self.instance.setup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.instance.close()

    def run(self, time: float):
        """Go on for a time."""
        self.instance.run(int(time / self.ready.certificate.timestep))

    def mean(self, name: str) -> np.ndarray:
        """Mean of a property, weighted with mass, shape (3,)."""
        return self.ready.system.center_of_mass(self.instance.array(name))[0]

    def corners(self) -> np.ndarray:
        """Corners of the lattice cells, shape (C, 8, 3)."""
        return self.instance.array("x")[self.ready.system.hexahedron]

    def share(self) -> float:
        """Part of the cube below the surface."""
        from mdanim_lammps.features.liquid.measure import immersed_share

        return immersed_share(self.corners(), self.ready.plan.grid, liquid.heights(self.instance)[0])

    def lean(self) -> float:
        """Angle between the vertical and the nearest axis of the cube [deg]."""
        corner = self.corners().mean(axis=0)
        axes = np.array([corner[1] - corner[0], corner[3] - corner[0], corner[4] - corner[0]])
        upright = np.abs(axes[:, 2]) / np.linalg.norm(axes, axis=1)
        return float(np.degrees(np.arccos(min(1.0, upright.max()))))


def found(g=0.01, **what) -> tuple[float, float]:
    """Share and lean after 160 sqrt(L/g), when drag has damped everything."""
    with Pool(g=g, **what) as pool:
        pool.run(160 * (what.get("side", 6) / g) ** 0.5)
        return pool.share(), pool.lean()


def settled(**what) -> str:
    """Both as words."""
    share, lean = found(**what)
    return f"{share:.4f} {lean:5.1f}"


def in_waves(density: int, **way) -> dict:
    """Settings for a cube that is dropped, in a liquid with momentum."""
    return dict(density=density, model="waves", calm=10 * (6 / way.get("g", 0.01)) ** 0.5, **way)


def drafts() -> None:
    """Print the table of drafts."""
    print("immersed share, and lean in degrees, of cubes of 6^3 cells of density")
    print(f"{'':34}" + "".join(f"{d / 1000:<15}" for d in DENSITIES))
    for name, way in WAYS.items():
        print(f"{name:34}" + "   ".join(settled(density=d, **way) for d in DENSITIES), flush=True)


def cells() -> None:
    """Print how drafts depend on the size of the cube."""
    print("the same for a tilted drop and cubes of … cells a side")
    for side in (3, 4, 6, 8, 10):
        half, level = 1.7 * side, 2.5 * side
        way = dict(side=side, half=half, level=level, top=level + 3 * side, z=level + side, roll=20, pitch=35, yaw=10)
        print(f"{side:<20}" + "   ".join(settled(density=d, **way) for d in DENSITIES), flush=True)


def models() -> None:
    """Print drafts under each model of the liquid."""
    print("the same for stiff ones set onto the surface upright, by model of the liquid")
    for model in ("surface", "paper"):
        print(f"{model:20}" + "   ".join(settled(density=d, z=17.1, young=10000, model=model) for d in DENSITIES), flush=True)


def waves() -> None:
    """Print the table of drafts in a liquid with momentum."""
    print("the first table for model waves")
    for name, way in WAYS.items():
        print(f"{name:34}" + "   ".join(settled(**in_waves(d, **way)) for d in DENSITIES), flush=True)


def drafts_in_waves() -> str:
    """The same as docs/physics-liquid.md has it, without what cubes lean."""
    rows = [(name, *(f"{found(**in_waves(d, **way))[0]:.3f}" for d in DENSITIES)) for name, way in WAYS.items()]
    return markdown(["way there", *(f"{d / 1000}" for d in DENSITIES)], rows)


def bobbing_rows() -> Iterator[tuple[str, ...]]:
    """Draft and basin, fall and period, both in potential flow, one over the other."""
    side, above = 6, 0.9
    for draft, depth, width in ((2, 10, 24), (3, 10, 24), (5, 10, 24), (3, 24, 48)):
        rest = depth + side / 2 - draft
        size = dict(side=side, half=width / 2, level=depth, top=depth + side)
        path = []
        with Pool(model="waves", calm=1e6, drag=1e-9, density=1000 * draft / side, z=rest + above, **size) as pool:
            dt = pool.ready.certificate.timestep
            steps = max(1, int(0.25 / dt))
            for _ in range(int(300.0 / (steps * dt))):
                pool.instance.run(steps)
                path.append((pool.mean("x")[2] - rest) / above)
        own = waves_forms.swings(np.array(path), draft, steps * dt * 0.01**0.5)
        exact = waves_forms.swings(heave.bobbing(side, draft, width, depth, fine=2 if depth < 20 else 1, time=40), draft)
        told = (f"{one.fall:.2f}; {one.period:.2f}" for one in (own, exact))
        ratio = f"{own.fall / exact.fall:.2f}; {own.period / exact.period:.2f}"
        yield f"{draft} of {side}; {depth}, {width}", *told, ratio


def bobbing() -> None:
    """Print how cubes bob in a liquid with momentum."""
    print(bobbing_table(), flush=True)


def bobbing_table() -> str:
    """The same as a table."""
    return markdown(["draft; depth and width of the basin", "fall; period", "in potential flow", "over it"], bobbing_rows())


def speed() -> None:
    """Print terminal speeds."""
    gamma, g = 0.1, 0.01
    print("terminal speed over that of the formula, after 5 times rho_s/(gamma rho_l)")
    for density in (1500, 3000):
        fall, time = (density / 1000 - 1) * g / gamma, 5 * density / 1000 / gamma
        deep = int(26 + 1.2 * fall * time)
        with Pool(density=density, drag=gamma, level=deep, top=deep + 10, z=deep - 4) as pool:
            pool.run(time)
            print(f"{density / 1000:<20}{-pool.mean('v')[2] / fall:.4f}   (1 - exp(-5) = {1 - np.exp(-5):.4f})", flush=True)


def drift() -> None:
    """Print what a floating cube does by itself."""
    with Pool(density=900, z=13, young=1e5, g=9.81) as pool:
        pool.run(10)
        before, swept = pool.mean("x"), pool.instance.fix_value("liquid", SWEEPS)
        pool.run(20)
        aside = np.abs(pool.mean("x") - before)[:2].max()
        print(
            f"cube of density 0.9, afloat for 20 s: {aside:.2e} cells sideways, "
            f"{pool.instance.fix_value('liquid', SWEEPS) - swept:.0f} sweeps"
        )


LIGHT = """gravity (0, 0, -9.81) m/s^2
liquid water {{ basin from (0, 0, 0) m to (1, 1, 1) m  density 1000 kg/m^3  level 0.5 m }}
object cork {{ shape box (20, 20, 20) cm  position (0.5, 0.5, 0.63) m  density {density} kg/m^3  elasticity {stuff} }}
control {{ time 15 s  frames 30 fps  resolution 5 cm }}
"""
LIGHT_ONES = [(110, "100 kPa"), (150, "100 kPa"), (200, "100 kPa"), (150, "1 MPa"), (150, "100 kPa  damping 0.1"), (150, "rigid")]


def light() -> None:
    """Print how light cubes go on."""
    from mdanim_lammps import Scene
    from mdanim_lammps.scene.parse import parse_scene

    print("density, elasticity, and the speed up and down from 13 to 15 s [mm/s]")
    for density, stuff in LIGHT_ONES:
        with tempfile.TemporaryDirectory() as folder:
            track = Scene(parse_scene(LIGHT.format(density=density, stuff=stuff))).run(Path(folder) / "out").trajectory
        speed = np.diff(track.objects["cork"].center_of_mass[-60:, 2]) / np.diff(track.times[-60:])
        print(f"{density:<8}{stuff:24}{1000.0 * speed.std():.2g}", flush=True)


WORDS = {
    "drafts": drafts,
    "cells": cells,
    "models": models,
    "waves": waves,
    "bobbing": bobbing,
    "speed": speed,
    "light": light,
    "drift": drift,
}

if __name__ == "__main__":
    for what in sys.argv[1:] or WORDS:
        WORDS[what]()
